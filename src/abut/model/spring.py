"""Springs and dashpots: to the ground, between two points, and foundations under a surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from abut import checks
from abut.errors import InputError
from abut.mesh.mesh import Mesh
from abut.model.conditions import vector
from abut.model.response import Wanted

ALONG = ("x", "y", "z", "normal", "along")
Table = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Spring:
    """Springs that resist the displacement of a surface or node set, as a whole or by area.

    ``x`` to ``along`` are each a stiffness [force/length], or a table of (displacement, force), linear between its points
    and on beyond them; they are of the whole place, spread evenly over the area of a surface or the nodes of a set, unless
    ``per_area`` is true. A dashpot resists speeds in the same way, over the time of the run.

    Parameters
    ----------
    name : str
        Of the spring.
    on : str
        A surface or node set.
    to : str, optional
        A node set of as many nodes, in the order of their numbers, at the other end; left out: the ground.
    x, y, z : float or table, optional
        Along the global axes.
    normal : float or table, optional
        Along the outward normal of a surface at the outset: a bed that is pressed by positive displacements.
    along : float or table, optional
        With ``to`` or ``point``: along the line between both ends at the outset, of the lengthening.
    per_area : bool
        Of a surface: stiffness per area [force/length^3], tables of (displacement, force per area).
    weak : bool
        Only there to keep loose parts in place: the certificate fails where it carries more than a thousandth of the forces.
    point : (dim,) of float, optional
        Of a node set, in place of ``to``: a point fixed in space that all its nodes are tied to.
    dashpot : bool
        A dashpot: ``x`` to ``along`` are damping constants [force time/length], or tables of (speed, force). Beside a spring
        of the same place both are in parallel.

    Raises
    ------
    InputError
        For values that are no such things, or do not go together.

    Examples
    --------
    >>> import abut
    >>> bed = abut.Spring("bed", "plate.bottom", normal=0.05, per_area=True)
    >>> stop = abut.Spring("stop", "arm.tip", y=[(-1.0, -500.0), (0.0, 0.0), (1.0, 0.0)])  # carries downward only
    >>> damper = abut.Spring("damper", "arm.tip", y=20.0, dashpot=True)
    """

    name: str
    on: str
    to: str = ""
    x: Any = None
    y: Any = None
    z: Any = None
    normal: Any = None
    along: Any = None
    per_area: bool = False
    weak: bool = False
    point: tuple[float, ...] | None = None
    dashpot: bool = False

    def __post_init__(self) -> None:
        where = f"spring '{self.name}'"
        checks.text(self.name, f"{where}: name")
        for key in ALONG:
            value = getattr(self, key)
            if value is not None:
                object.__setattr__(self, key, _law(value, f"{where}: {key}"))
        if not self.laws:
            raise InputError(f"{where}: it has no stiffness; give {', '.join(ALONG)}")
        if self.point is not None:
            object.__setattr__(self, "point", vector(self.point, f"{where}: point"))
            if self.to or set(self.laws) != {"along"}:
                raise InputError(f"{where}: point goes with along alone, and not with to; take the others out")
        if self.along is not None and not self.to and self.point is None:
            raise InputError(
                f"{where}: along goes with to, the node set at the other end, or with point, a fixed point there"
            )
        if (self.to or self.point is not None) and (self.per_area or self.normal is not None):
            raise InputError(f"{where}: normal and per_area are for beds on the ground; leave to out")

    @property
    def laws(self) -> dict[str, float | Table]:
        """Those that are given, by name."""
        return {key: getattr(self, key) for key in ALONG if getattr(self, key) is not None}

    @property
    def linear(self) -> bool:
        """Whether every law is a stiffness."""
        return all(isinstance(law, float) for law in self.laws.values())


def _law(value: Any, where: str) -> float | Table:
    if isinstance(value, (list, tuple)):
        try:
            table = tuple((checks.finite(u, where), checks.finite(f, where)) for u, f in value)
        except (TypeError, ValueError):
            raise InputError(
                f"{where}: expected a stiffness, or pairs of displacement and force, got {value!r}"
            ) from None
        if len(table) < 2:
            raise InputError(f"{where}: a table needs two points or more")
        for (u, f), (v, g) in pairwise(table):
            if not u < v or f > g:
                raise InputError(
                    f"{where}: displacements must increase and forces must not decrease, from ({u:g}, {f:g})"
                )
        return table
    return checks.positive(value, where)


def check_springs(mesh: Mesh, springs: Sequence[Spring], modes: Sequence[Wanted]) -> None:
    """Raise InputError for places that do not exist or do not fit, directions that plane models lack, and dashpots beside
    modes, which would not have them."""
    names: set[str] = set()
    for i, spring in enumerate(springs):
        where = f"springs[{i}]"
        if spring.name in names:
            raise InputError(f"{where}.name: '{spring.name}' is used twice; give each spring its own name")
        names.add(spring.name)
        if spring.dashpot and modes:
            raise InputError(
                f"{where}.dashpot: frequencies, buckling and vibrations have no dashpots; take it out, and give vibrations "
                "their damping or rayleigh"
            )
        surfaces_only = spring.normal is not None or spring.per_area
        known = [*mesh.surfaces] if surfaces_only else [*mesh.surfaces, *mesh.node_sets]
        checks.known(spring.on, known, f"{where}.on", "surface" if surfaces_only else "surface or node set")
        if spring.to:
            checks.known(spring.to, mesh.node_sets, f"{where}.to", "node set")
            checks.known(spring.on, mesh.node_sets, f"{where}.on", "node set (to needs one)")
            counts = len(mesh.nodes_of(spring.on)), len(mesh.nodes_of(spring.to))
            if counts[0] != counts[1]:
                raise InputError(
                    f"{where}.to: '{spring.on}' has {counts[0]} nodes, '{spring.to}' {counts[1]}: give as many"
                )
        if spring.point is not None:
            checks.known(spring.on, mesh.node_sets, f"{where}.on", "node set (point needs one)")
            if len(spring.point) != mesh.dim:
                raise InputError(f"{where}.point: expected {mesh.dim} numbers, got {len(spring.point)}")
        if mesh.dim == 2 and spring.z is not None:
            raise InputError(f"{where}.z: the model is 2D; leave z out")
        if mesh.axisymmetric and spring.x is not None and spring.to:
            raise InputError(f"{where}.x: radial springs between two rings are not known; leave x out")
