"""What the user says of surface and line meshes: their sections, and what holds and loads them."""

from __future__ import annotations

from dataclasses import dataclass

from abut import checks
from abut.errors import InputError
from abut.fields import Field, number_or_field
from abut.mesh.mesh import Mesh
from abut.model import Coupling, Equation, Load, Support
from abut.model.conditions import COMPONENTS, TURNS, History, check_amplitude, vector

MOTIONS = (*COMPONENTS, *TURNS)


@dataclass(frozen=True)
class Shell:
    """Thickness of a surface mesh, which makes it solid.

    Parameters
    ----------
    thickness : float
        Its thickness [length].
    offset : float
        Of the mesh from the middle of the shell along the normal, over the thickness: 0.5 makes the mesh its positive side,
        -0.5 its negative one. The normal is the one about which the nodes of a cell turn counterclockwise.
    layers : sequence of float
        Of a laminate, how thick its layers are beside each other, from the negative side: each becomes a body of its own,
        NAME-layer1 and so on, with a material of its own. One body where left out.
    membrane : bool
        Whether its cells are hinged at their nodes: it carries forces in its surface, and no moments from cell to cell. Flat
        ones need large displacements to carry forces across. Give the body ``integration="full"``.

    Raises
    ------
    InputError
        For a thickness, or layers, that are not above 0, for what is no number, and for a membrane of layers.

    Examples
    --------
    >>> import abut
    >>> sheet = abut.Shell(1.5, offset=0.5)  # the mesh is the side that its normals point away from
    >>> plies = abut.Shell(1.0, layers=(1, 2, 1))  # 0.25, 0.5 and 0.25 thick
    """

    thickness: float
    offset: float = 0.0
    layers: tuple[float, ...] = ()
    membrane: bool = False

    def __post_init__(self) -> None:
        checks.positive(self.thickness, "thickness")
        checks.finite(self.offset, "offset")
        layers = checks.listed(self.layers, "layers", "numbers")
        object.__setattr__(self, "layers", tuple(checks.positive(layer, "layers") for layer in layers))
        if not isinstance(self.membrane, bool):
            raise InputError(f"membrane: expected true or false, got {self.membrane!r}")
        if self.membrane and self.layers:
            raise InputError("membrane: a membrane has no layers; leave one of the two out")


@dataclass(frozen=True)
class Beam:
    """Section of a line mesh, which makes it solid: a rectangle (``widths``) or a circle (``radius``), with ``wall`` a box
    or a pipe.

    Parameters
    ----------
    widths : (2,) of float, optional
        Of a rectangle, along the first direction of the section and along the second, tangent x first [length].
    direction : (3,) of float
        Near which the first direction lies; its part across the line counts.
    offsets : (2,) of float
        Of the mesh from the middle of the section along both, over the widths (of a circle its diameter).
    radius : float, optional
        Of a circle, outside [length].
    wall : float, optional
        Thickness of the wall of a box or a pipe, which are solid where left out [length].

    Raises
    ------
    InputError
        For both or neither of them, for such as are not above 0, and for what are no such numbers.

    Examples
    --------
    >>> import abut
    >>> rib = abut.Beam((2.0, 10.0), direction=(0.0, 1.0, 0.0))  # of a line along x: 2 along y, 10 along z
    >>> bar = abut.Beam(radius=4.0)
    """

    widths: tuple[float, ...] | None = None
    direction: tuple[float, ...] = (0.0, 0.0, -1.0)
    offsets: tuple[float, ...] = (0.0, 0.0)
    radius: float | None = None
    wall: float | None = None

    def __post_init__(self) -> None:
        if (self.widths is None) == (self.radius is None):
            raise InputError("widths: give either widths, of a rectangle, or radius, of a circle")
        for name, count in (*((("widths", 2),) if self.radius is None else ()), ("direction", 3), ("offsets", 2)):
            values = vector(getattr(self, name), name)
            if len(values) != count:
                raise InputError(f"{name}: expected {count} numbers, got {len(values)}")
            object.__setattr__(self, name, values)
        for value in self.widths or ():
            checks.positive(value, "widths")
        if self.radius is not None:
            checks.positive(self.radius, "radius")
        if self.wall is not None:
            most = min(self.widths) / 2.0 if self.widths else self.radius or 0.0
            if checks.positive(self.wall, "wall") >= most:
                raise InputError(
                    f"wall: expected less than {most:g}, half the section, got {self.wall:g}; leave it out"
                )
        if not any(self.direction):
            raise InputError("direction: it has no length; give a vector across the line")


Thin = Shell | Beam


def bodies_of(name: str, section: Thin) -> tuple[str, ...]:
    """The bodies that a section's group becomes."""
    if isinstance(section, Beam) or not section.layers:
        return (name,)
    return tuple(f"{name}-layer{i}" for i in range(1, len(section.layers) + 1))


@dataclass(frozen=True)
class MidSupport:
    """Prescribed displacement and turns of nodes of surface and line meshes.

    Parameters
    ----------
    on : str
        A shell or beam, or a group of its nodes, lines or cells.
    x, y, z : float, str or function, optional
        Displacement [length]; free where left out.
    rx, ry, rz : float, str or function, optional
        Turn about the global axes [radian]; free where left out. That about the normal of a shell is free.
    amplitude : Amplitude, optional
        Factor over time; the ramp where left out.

    Raises
    ------
    InputError
        For values that are no such things, and where nothing is prescribed.
    """

    on: str
    x: float | Field | None = None
    y: float | Field | None = None
    z: float | Field | None = None
    rx: float | Field | None = None
    ry: float | Field | None = None
    rz: float | Field | None = None
    amplitude: History = None

    def __post_init__(self) -> None:
        checks.text(self.on, "support: on")
        where = f"support on '{self.on}'"
        for name, value in self.given.items():
            object.__setattr__(self, name, number_or_field(value, f"{where}: {name}"))
        if not self.given:
            raise InputError(f"{where}: nothing is prescribed; give at least one of {', '.join(MOTIONS)}")
        check_amplitude(self.amplitude, where)

    @property
    def given(self) -> dict[str, float | Field]:
        """What is prescribed, by component."""
        return {name: getattr(self, name) for name in MOTIONS if getattr(self, name) is not None}


@dataclass(frozen=True)
class MidForce:
    """Force and moment at each node of a group of a surface or line mesh.

    Parameters
    ----------
    on : str
        A group of nodes of shells and beams.
    value : (3,) of float
        Force at each.
    moment : (3,) of float
        Moment at each. Nothing resists one about the normal of a shell.
    amplitude : Amplitude, optional
        Factor over time; the ramp where left out.

    Raises
    ------
    InputError
        For values that are no such things.
    """

    on: str
    value: tuple[float, ...]
    moment: tuple[float, ...] = (0.0, 0.0, 0.0)
    amplitude: History = None

    def __post_init__(self) -> None:
        checks.text(self.on, "nodal force: on")
        where = f"nodal force on '{self.on}'"
        for name in ("value", "moment"):
            values = vector(getattr(self, name), f"{where}: {name}")
            if len(values) != 3:
                raise InputError(f"{where}: {name}: expected 3 numbers, got {len(values)}")
            object.__setattr__(self, name, values)
        check_amplitude(self.amplitude, where)


@dataclass(frozen=True)
class Thick:
    """Shells and beams made solid, for ``Model``.

    Parameters
    ----------
    mesh : Mesh
        With a body for each shell and beam, quadratic cells. Surfaces ``NAME.spos`` and ``NAME.sneg`` of a shell or of a
        group of its cells, ``NAME.edge`` of the faces across the thickness: of a shell where it ends, of a group of lines
        where these are ends of shells; ``NAME.side`` all round a beam. Groups of lines and points are sets of all nodes
        through the thickness.
    supports, equations, loads, couplings : tuple
        What was said of the nodes of shells and beams, and what keeps folds and ends together.
    """

    mesh: Mesh
    supports: tuple[Support, ...] = ()
    equations: tuple[Equation, ...] = ()
    loads: tuple[Load, ...] = ()
    couplings: tuple[Coupling, ...] = ()
