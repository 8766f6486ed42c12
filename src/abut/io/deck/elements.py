"""Element types of Abaqus and CalculiX: the cell each becomes, its section, how it integrates, the faces S1, S2, ...

Nodes run in the same order as in ``abut.cells`` for all of them (Abaqus Analysis User's Guide, "Solid elements";
CalculiX CrunchiX manual, section 6.2)."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ElementType:
    """kind: the cell (``abut.cells``); plane: "strain", "stress", "axisymmetric", or None in 3D; integration as in
    ``abut.Solid``, measured on single and few elements of CalculiX 2.20: its C3D8, CPE4 and CAX4 are fully integrated,
    its C3D10, C3D15 and triangles with 6 nodes have 4, 9 and 3 points. instead: what abut takes in place of the
    element's own formulation, "" where it is the same. thin: "shell", "membrane", "beam" or "truss", a cell of a surface
    or line that its section makes solid, or ""."""

    kind: str
    plane: str | None
    integration: str
    instead: str = ""
    thin: str = ""

    @property
    def solid(self) -> str:
        """The cell that is solved, of a thin element that which its thickness makes of it."""
        if self.thin == "membrane":
            return LAYER[self.kind]
        return _EXPANDED[self.kind] if self.thin else self.kind


LAYER = {"tri3": "wedge6", "tri6": "wedge15", "quad4": "hex8", "quad8": "hex20"}  # of one solid
_EXPANDED = {
    "line2": "hex20",
    "line3": "hex20",
    "tri3": "wedge15",
    "tri6": "wedge15",
    "quad4": "hex20",
    "quad8": "hex20",
}


_HOURGLASS = "instead of one point with hourglass control; stiffer in bending"
_MODES = "mean dilatation (b-bar) instead of incompatible modes; stiffer in bending"
_MEAN = ("b-bar", "mean dilatation (b-bar) instead of a pressure unknown; for Poisson's ratios up to about 0.49")
_POINTS = (
    "reduced",
    "reduced integration instead of a pressure unknown or of the modified element; for Poisson's ratios up to about 0.49",
)


def _types() -> dict[str, ElementType]:
    result = {
        "C3D4": ElementType("tet4", None, "full"),
        "C3D10": ElementType("tet10", None, "reduced"),
        "C3D6": ElementType("wedge6", None, "full", "full integration (6 points) instead of 2 points"),
        "C3D15": ElementType("wedge15", None, "reduced"),
        "C3D8": ElementType("hex8", None, "full"),
        "C3D8I": ElementType("hex8", None, "b-bar", _MODES),
        "C3D8R": ElementType("hex8", None, "b-bar", f"mean dilatation (b-bar) {_HOURGLASS}"),
        "C3D20": ElementType("hex20", None, "full"),
        "C3D20R": ElementType("hex20", None, "reduced"),
    }
    result |= {code: ElementType("hex8", None, *_MEAN) for code in ("C3D8H", "C3D8RH", "C3D8IH")}
    result |= {code: ElementType("hex20", None, *_POINTS) for code in ("C3D20H", "C3D20RH")}
    result |= {code: ElementType("tet10", None, *_POINTS) for code in ("C3D10H", "C3D10M", "C3D10MH")}
    for prefix, plane in (("CPE", "strain"), ("CPS", "stress"), ("CAX", "axisymmetric")):
        stress = plane == "stress"
        replaced = (
            ("full", f"full integration {_HOURGLASS}") if stress else ("b-bar", f"mean dilatation (b-bar) {_HOURGLASS}")
        )
        result |= {
            f"{prefix}3": ElementType("tri3", plane, "full"),
            f"{prefix}6": ElementType("tri6", plane, "reduced"),
            f"{prefix}4": ElementType("quad4", plane, "full"),
            f"{prefix}4R": ElementType("quad4", plane, *replaced),
            f"{prefix}8": ElementType("quad8", plane, "full"),
            f"{prefix}8R": ElementType("quad8", plane, "reduced"),
            f"{prefix}6M": ElementType("tri6", plane, *_POINTS),
        }
        if stress:
            result["CPS4I"] = ElementType("quad4", plane, "full", "full integration" + _MODES.partition(")")[2])
            continue
        result[f"{prefix}4I"] = ElementType("quad4", plane, "b-bar", _MODES)
        result |= {f"{prefix}{code}": ElementType("quad4", plane, *_MEAN) for code in ("4H", "4RH", "4IH")}
        result |= {f"{prefix}{code}": ElementType("quad8", plane, *_POINTS) for code in ("8H", "8RH")}
        result |= {f"{prefix}{code}": ElementType("tri6", plane, *_POINTS) for code in ("6H", "6MH")}
    return result | _shells() | _membranes() | _beams()


def _shells() -> dict[str, ElementType]:
    """As CalculiX expands them: S8 to C3D20, S8R to C3D20R, S6 to C3D15; linear ones get nodes in the middle of their edges,
    as one linear solid through the thickness would lock in bending."""
    middles = "nodes in the middle of its edges, expanded to {} instead of {}; less stiff in bending"
    return {
        "S3": ElementType("tri3", None, "reduced", middles.format("C3D15", "C3D6"), "shell"),
        "S4": ElementType("quad4", None, "reduced", middles.format("C3D20R", "C3D8I"), "shell"),
        "S4R": ElementType("quad4", None, "reduced", middles.format("C3D20R", "C3D8R"), "shell"),
        "US3": ElementType("tri3", None, "reduced", middles.format("C3D15", "a flat shell").partition(";")[0], "shell"),
        "S6": ElementType("tri6", None, "reduced", "", "shell"),
        "S8": ElementType("quad8", None, "full", "", "shell"),
        "S8R": ElementType("quad8", None, "reduced", "", "shell"),
    }


def _membranes() -> dict[str, ElementType]:
    """As CalculiX expands them, into one solid each that is hinged at its nodes; linear ones stay linear. With reduced
    integration hinges would leave modes without energy."""
    whole = "full integration instead of {}; hinged elements would have motions without stiffness"
    return {
        "M3D3": ElementType("tri3", None, "full", "", "membrane"),
        "M3D4": ElementType("quad4", None, "full", "", "membrane"),
        "M3D4R": ElementType("quad4", None, "b-bar", f"mean dilatation (b-bar) {_HOURGLASS}", "membrane"),
        "M3D6": ElementType("tri6", None, "full", whole.format("9 points"), "membrane"),
        "M3D8": ElementType("quad8", None, "full", "", "membrane"),
        "M3D8R": ElementType("quad8", None, "full", whole.format("8 points"), "membrane"),
    }


def _beams() -> dict[str, ElementType]:
    """B32 becomes C3D20, B32R C3D20R; linear ones likewise get a node in their middle. Trusses become C3D20: with reduced
    integration hinges would leave modes without energy."""
    middle = "a node in its middle, expanded to C3D20R instead of {}; less stiff in bending"
    return {
        "B21": ElementType("line2", None, "reduced", middle.format("C3D8I"), "beam"),
        "B31": ElementType("line2", None, "reduced", middle.format("C3D8I"), "beam"),
        "B31R": ElementType("line2", None, "reduced", middle.format("C3D8R"), "beam"),
        "B32": ElementType("line3", None, "full", "", "beam"),
        "B32R": ElementType("line3", None, "reduced", "", "beam"),
        "T2D2": ElementType("line2", None, "full", "", "truss"),
        "T3D2": ElementType("line2", None, "full", "", "truss"),
        "T3D3": ElementType("line3", None, "full", "", "truss"),
    }


ELEMENTS = _types()
DASHPOTS = "DASHPOTELEMENTS"  # key of *ELEMENT cards with them
SHELLS, BEAMS = frozenset({*_shells(), "M3D6", "M3D8", "M3D8R"}), frozenset(_beams())  # solids of second order

# Local facet of ``abut.cells`` for S1, S2, ...
_TETRAHEDRON = (0, 1, 2, 3)
_WEDGE = (0, 1, 2, 3, 4)
_HEXAHEDRON = (4, 5, 2, 1, 3, 0)
FACES: dict[str, tuple[int, ...]] = {
    "tri3": (0, 1, 2),
    "tri6": (0, 1, 2),
    "quad4": (0, 1, 2, 3),
    "quad8": (0, 1, 2, 3),
    "tet4": _TETRAHEDRON,
    "tet10": _TETRAHEDRON,
    "wedge6": _WEDGE,
    "wedge15": _WEDGE,
    "hex8": _HEXAHEDRON,
    "hex20": _HEXAHEDRON,
}

_FAMILIES = (  # prefixes of what is refused, longest first
    ("SPRING", "springs"),
    ("DCOUP", "distributing couplings"),
    ("CONN", "connectors"),
    ("MASS", "point masses"),
    ("ROTARYI", "rotary inertia"),
    ("GAP", "gap elements"),
    ("COH", "cohesive elements"),
    ("PIPE", "pipes"),
    ("ELBOW", "elbows"),
    ("STRI", "shells"),
    ("SAX", "shells"),
    ("MAX", "membranes"),
    ("SC", "continuum shells"),
    ("CIN", "infinite elements"),
    ("DC", "heat transfer elements"),
    ("AC", "acoustic elements"),
    ("C3D", "solid elements of this kind (hybrid, modified, thermal)"),
    ("CP", "plane elements of this kind (hybrid, modified, thermal)"),
    ("CAX", "axisymmetric elements of this kind (hybrid, twisted, thermal)"),
    ("R3D", "rigid surfaces"),
    ("R2D", "rigid surfaces"),
    ("RAX", "rigid surfaces"),
    ("T2D", "trusses"),
    ("T3D", "trusses"),
    ("S", "shells"),
    ("B", "beams"),
    ("F", "fluid elements"),
    ("D", "network and fluid elements"),
    ("U", "user elements"),
    ("M", "membranes"),
)


def refusal(code: str) -> str:
    """Why an element type is refused, and what to do."""
    family = next((words for prefix, words in _FAMILIES if code.startswith(prefix)), "elements of this type")
    return (
        f"element type {code}: {family} are not supported; model the part with solid, plane or axisymmetric elements "
        "(C3D4 to C3D20R, CPE, CPS, CAX)"
    )
