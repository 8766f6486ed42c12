"""Scripts for Gmsh: what solids and faces a file has, and the mesh."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from abut import checks
from abut.errors import InputError
from abut.parts.geometry import MARK

UNITS = {"mm": "MM", "m": "M", "in": "INCH"}
ROUND = 16  # edges around a full circle
SMALLEST = 0.05  # of the smaller size: no edge of the mesh is made smaller
REACH = 2.0  # sizes away from contact over which cells grow to full size
CELLS = {"tet4": 1, "tet10": 2}  # order


@dataclass(frozen=True)
class Sizes:
    """How fine a mesh is.

    Parameters
    ----------
    size : float
        Edges of cells away from contact [length].
    contact : float, optional
        At touching faces [length]; left out: half of that.
    cell : str
        "tet10" (curved) or "tet4".
    unit : str
        Of the mesh: "mm", "m" or "in"; a STEP file says what its own is.

    Raises
    ------
    InputError
        For sizes that are no positive numbers, cells and units that do not exist.
    """

    size: float
    contact: float | None = None
    cell: str = "tet10"
    unit: str = "mm"

    def __post_init__(self) -> None:
        checks.positive(self.size, "--size")
        if self.contact is not None:
            checks.positive(self.contact, "--contact-size")
            if self.contact > self.size:
                raise InputError(f"--contact-size: {self.contact:g} is larger than --size {self.size:g}")
        checks.choice(self.cell, "--cell", tuple(CELLS))
        checks.choice(self.unit, "--unit", tuple(UNITS))

    @property
    def at_contact(self) -> float:
        return 0.5 * self.size if self.contact is None else self.contact


def listing(source: str, sizes: Sizes) -> str:
    """A script that prints solids and faces with their boxes, and makes a mesh with straight edges in which each face of
    each solid is a surface "v1 f2", by their numbers. source: the file's name beside the script."""
    return f"""{_head(source, sizes)}
For i In {{0:#v()-1}}
  c() = BoundingBox Volume{{v(i)}};
  Printf("{MARK} volume %.0f %.16g %.16g %.16g %.16g %.16g %.16g", v(i), c(0), c(1), c(2), c(3), c(4), c(5));
  Physical Volume(Sprintf("v%.0f", v(i))) = {{v(i)}};
  b() = Boundary{{ Volume{{v(i)}}; }};
  For j In {{0:#b()-1}}
    s = Fabs(b(j));
    c() = BoundingBox Surface{{s}};
    Printf("{MARK} face %.0f %.0f %.16g %.16g %.16g %.16g %.16g %.16g", v(i), s, c(0), c(1), c(2), c(3), c(4), c(5));
    Physical Surface(Sprintf("v%.0f f%.0f", v(i), s)) = {{s}};
  EndFor
EndFor
"""


def meshing(
    source: str, sizes: Sizes, bodies: Mapping[str, int], surfaces: Mapping[str, Sequence[int]], fine: Sequence[int]
) -> str:
    """A script that makes the mesh: bodies and surfaces by name, with the numbers of solids and faces; ``fine``: the faces
    that cells become smaller toward."""
    lines = [_head(source, sizes)]
    lines += [f'Physical Volume("{name}") = {{{tag}}};' for name, tag in bodies.items()]
    lines += [f'Physical Surface("{name}") = {{{_list(tags)}}};' for name, tags in surfaces.items()]
    if fine:
        lines.append(_graded(sizes, fine))
    if CELLS[sizes.cell] > 1:  # midside nodes on the faces, moved where cells would turn inside out
        lines.append("Mesh.ElementOrder = 2;\nMesh.SecondOrderLinear = 0;\nMesh.HighOrderOptimize = 1;")
    return "\n".join(lines) + "\n"


def _head(source: str, sizes: Sizes) -> str:
    return f"""SetFactory("OpenCASCADE");
General.Terminal = 1;
Geometry.OCCTargetUnit = "{UNITS[sizes.unit]}";
Merge "{source}";
v() = Volume{{:}};
Mesh.MeshSizeMax = {sizes.size!r};
Mesh.MeshSizeMin = {SMALLEST * sizes.at_contact!r};
Mesh.MeshSizeFromCurvature = {ROUND};"""


def _graded(sizes: Sizes, fine: Sequence[int]) -> str:
    """The size on the faces themselves, whose samples for the distance may lie far apart, and by the distance from them."""
    return f"""Field[1] = MathEval;
Field[1].F = "{sizes.at_contact!r}";
Field[2] = Restrict;
Field[2].InField = 1;
Field[2].SurfacesList = {{{_list(fine)}}};
Field[3] = Distance;
Field[3].SurfacesList = {{{_list(fine)}}};
Field[4] = Threshold;
Field[4].InField = 3;
Field[4].SizeMin = {sizes.at_contact!r};
Field[4].SizeMax = {sizes.size!r};
Field[4].DistMin = {sizes.at_contact!r};
Field[4].DistMax = {sizes.at_contact + REACH * sizes.size!r};
Field[5] = Min;
Field[5].FieldsList = {{2, 4}};
Background Field = 5;"""


def _list(tags: Sequence[int]) -> str:
    return ", ".join(map(str, tags))
