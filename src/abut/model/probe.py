"""Probes: results at points, along lines and on sets; a record that checks itself, and the names of its results."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

from abut import checks
from abut.axes import Axes
from abut.errors import InputError, nearest
from abut.mesh.mesh import Mesh
from abut.model.consistency import check_axes
from abut.model.step_choice import StepChoice, check_steps

YIELDED = ("plastic-strain", "equivalent-plastic-strain")  # where a body may yield
PRINCIPAL, MAX_SHEAR, REACTION = "principal-stress", "max-shear", "reaction"
NAMED_ONLY = (PRINCIPAL, MAX_SHEAR, REACTION)  # read where they are asked for by name
IN_BODIES = ("displacement", "stress", "von-mises", *NAMED_ONLY, *YIELDED)
ON_CONTACTS = ("pressure", "gap")
QUANTITIES = (*IN_BODIES, *ON_CONTACTS)
POINTS = 50  # along a line, where the user does not say
MOST_POINTS = 10_000

Vector = tuple[float, ...]


@dataclass(frozen=True)
class Probe:
    """Results at a place, for every step: at a point, along a line, or at nodes.

    Parameters
    ----------
    name : str
        Of the probe, and of its file.
    at : (dim,) of float, optional
        A point of the undeformed mesh [length].
    line : ((dim,), (dim,)) of float, optional
        Start and end of a line [length].
    on : str, optional
        A node set, surface or body.
    points : int, optional
        Of a line: in equal distances, both ends among them; 50 where left out.
    of : sequence of str, optional
        "displacement", "stress", "von-mises", "principal-stress", "max-shear" (half the difference of the largest and the
        smallest principal stress), "reaction", "plastic-strain", "equivalent-plastic-strain", "pressure", "gap"; left out:
        all that exist there, plastic strains only where a body of the model may yield, pressure and gap only where the
        place lies on a surface of a contact, principal stresses, largest shear and reactions not at all.
        "reaction", with ``on``: the force of supports and links on each node.
    contact : str, optional
        Whose pressure and gap, where more than one is there.
    body : str, optional
        Whose displacement, stress and side of a contact, where points lie on several; the first in the order of the mesh
        where left out.
    steps : str, int or sequence of int
        Of the load steps in its table: "all", "last", n for every n-th, or a list of numbers; the last step is always
        among them.
    axes : Axes, optional
        Local axes at each point, undeformed: x, y and z of displacement, stress, reaction and plastic strain are then
        along their first, second and third direction.

    Raises
    ------
    InputError
        For no place or several, and for what does not exist.

    Examples
    --------
    >>> import abut
    >>> tip = abut.Probe("tip", at=(10.0, 0.0), of=("displacement",))
    >>> abut.Probe("through the wall", line=((1.0, 0.0), (2.0, 0.0)), points=11, of=("stress", "von-mises")).place
    '11 points from (1, 0) to (2, 0)'
    """

    name: str
    at: Vector | None = None
    line: tuple[Vector, Vector] | None = None
    on: str | None = None
    points: int | None = None
    of: tuple[str, ...] | None = None
    contact: str | None = None
    body: str | None = None
    steps: StepChoice = "all"
    axes: Axes | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name.strip():
            raise InputError(f"probe: name: expected a text that is not empty, got {self.name!r}")
        where = f"probe '{self.name}'"
        given = [name for name in ("at", "line", "on") if getattr(self, name) is not None]
        if len(given) != 1:
            got = " and ".join(given) or "none of them"
            raise InputError(f"{where}: give one of at (a point), line, on (a node set or surface); got {got}")
        if self.at is not None:
            object.__setattr__(self, "at", _point(self.at, f"{where}: at"))
        if self.line is not None:
            object.__setattr__(self, "line", _line(self.line, f"{where}: line"))
        self._check_points(where)
        if self.of is not None:
            object.__setattr__(self, "of", _quantities(self.of, f"{where}: of"))
            if self.contact is not None and not set(self.of) & set(ON_CONTACTS):
                raise InputError(f"{where}: contact is for pressure and gap; leave it out, or add them to 'of'")
        check_steps(self.steps, f"{where}: steps")
        if self.axes is not None:
            checks.instance(self.axes, Axes, f"{where}: axes", "local axes (abut.Axes)")
        if self.of is not None and REACTION in self.of and self.on is None:
            raise InputError(
                f"{where}: {REACTION} is the force on nodes; give on (a node set, surface or body), or take it out of 'of'"
            )
        if self.on is not None and self.body is not None:
            raise InputError(f"{where}: body is for points and lines; the nodes of '{self.on}' are read; leave it out")

    def _check_points(self, where: str) -> None:
        if self.points is None:
            return
        if self.line is None:
            raise InputError(f"{where}: points is for lines; leave it out")
        if isinstance(self.points, bool) or not isinstance(self.points, int) or not 2 <= self.points <= MOST_POINTS:
            raise InputError(
                f"{where}: points: expected a whole number from 2 (both ends) to {MOST_POINTS}, got {self.points!r}"
            )

    @property
    def place(self) -> str:
        """Where it is, in words."""
        along = "" if self.axes is None else f", in {self.axes.kind} axes"
        if self.at is not None:
            return f"at {_words(self.at)}{along}"
        if self.line is not None:
            return f"{self.points or POINTS} points from {_words(self.line[0])} to {_words(self.line[1])}{along}"
        return f"nodes of {self.on}{along}"


def check_probes(probes: Sequence[Probe], mesh: Mesh, contacts: Collection[str]) -> None:
    """Names and dimensions of probes against the mesh and the names of the contacts. Raises InputError."""
    for i, probe in enumerate(probes):
        where = f"probes[{i}]"
        if any(probe.name == before.name for before in probes[:i]):
            raise InputError(f"{where}.name: '{probe.name}' is used twice; give each probe its own name")
        for key, points in (("at", [probe.at]), ("line", probe.line or ())):
            for point in points:
                if point is not None and len(point) != mesh.dim:
                    raise InputError(f"{where}.{key}: expected {mesh.dim} numbers for a point, got {len(point)}")
        check_axes(mesh, probe.axes, where)
        _known(probe.on, [*mesh.surfaces, *mesh.node_sets, *mesh.bodies], f"{where}.on", "surface, node set or body")
        _known(probe.body, mesh.bodies, f"{where}.body", "body")
        _known(probe.contact, contacts, f"{where}.contact", "contact")
        wanted = [name for name in probe.of or () if name in ON_CONTACTS]
        if wanted and not contacts:
            raise InputError(f"{where}.of: the model has no contacts, and so no {wanted[0]}; take it out")
        if probe.on is not None and not len(mesh.nodes_of(probe.on)):
            raise InputError(f"{where}.on: '{probe.on}' is empty")


def _known(name: str | None, known: Collection[str], where: str, what: str) -> None:
    if name is not None and (not isinstance(name, str) or name not in known):
        raise InputError(f"{where}: no {what} named {name!r}{nearest(str(name), known)}")


def _point(values: Any, name: str) -> Vector:
    if isinstance(values, str) or not hasattr(values, "__iter__"):
        raise InputError(f"{name}: expected 2 or 3 numbers, got {values!r}")
    result = tuple(checks.finite(value, name) for value in values)
    if len(result) not in (2, 3):
        raise InputError(f"{name}: expected 2 or 3 numbers, got {len(result)}")
    return result


def _line(values: Any, name: str) -> tuple[Vector, Vector]:
    if isinstance(values, str) or not hasattr(values, "__iter__"):
        raise InputError(f"{name}: expected two points, got {values!r}")
    ends = tuple(values)
    if len(ends) != 2:
        raise InputError(f"{name}: expected two points, its start and its end, got {len(ends)}")
    start, end = _point(ends[0], name), _point(ends[1], name)
    if start == end:
        raise InputError(f"{name}: starts where it ends, at {_words(start)}; give two points, or a point (at)")
    return start, end


def _quantities(values: Any, name: str) -> tuple[str, ...]:
    if isinstance(values, str) or not hasattr(values, "__iter__"):
        raise InputError(f"{name}: expected a list of names, got {values!r}")
    result = tuple(checks.choice(value, name, QUANTITIES) for value in values)
    if not result:
        raise InputError(f"{name}: the list is empty; leave it out for all, or name some of {', '.join(QUANTITIES)}")
    return tuple(quantity for quantity in QUANTITIES if quantity in result)


def _words(point: Vector) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in point) + ")"
