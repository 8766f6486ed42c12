"""Cyclic symmetry: one of alike sectors is modelled, and equations join its two sides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from abut import checks
from abut.errors import InputError
from abut.mesh.mesh import Mesh
from abut.mesh.record import MeshRecord
from abut.model.conditions import COMPONENTS, Equation, Term, vector
from abut.sectors import matched
from abut.types import Array

TINY = 1e-12  # of a coefficient: one that rounding leaves


@dataclass(frozen=True)
class Sector:
    """What is modelled is one of alike sectors around an axis: every node of one side moves as its partner on the other
    side does, turned by one sector. Both sides are meshed alike.

    Parameters
    ----------
    side : str
        A surface or node set: the side whose nodes follow.
    other : str
        The other side.
    sectors : int
        How many make up the whole turn.
    axis : (3,) of float, optional
        Direction of the axis in 3D, of any length; z where left out. None in 2D.
    origin : (dim,) of float, optional
        A point of the axis [length]; zero where left out.

    Raises
    ------
    InputError
        For values that are no such things.

    Examples
    --------
    >>> import abut
    >>> blade = abut.Sector("disc.start", "disc.end", sectors=12)
    """

    side: str
    other: str
    sectors: int
    axis: tuple[float, ...] | None = None
    origin: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        checks.text(self.side, "sector: side")
        checks.text(self.other, "sector: other")
        where = f"sector between '{self.side}' and '{self.other}'"
        if isinstance(self.sectors, bool) or not isinstance(self.sectors, int) or self.sectors < 2:
            raise InputError(f"{where}: sectors: expected a whole number of 2 or more, got {self.sectors!r}")
        for name in ("axis", "origin"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, vector(getattr(self, name), f"{where}: {name}"))
        if self.axis is not None and not any(self.axis):
            raise InputError(f"{where}: axis: it has no length; give a direction")


@dataclass(frozen=True)
class Sectors:
    """What sectors add to a model.

    Parameters
    ----------
    mesh : Mesh
        With a node set ``SIDE nodes`` for each side that follows and is a surface, which frequencies of nodal diameters ask
        for.
    equations : tuple of Equation
        Between the nodes of both sides.
    """

    mesh: Mesh
    equations: tuple[Equation, ...]


def add_sectors(mesh: Mesh, sectors: Sequence[Sector]) -> Sectors:
    """The equations of cyclic symmetry, for ``Model``, small displacements and large.

    Nodes on the axis, which both sides have, stay on it.

    Parameters
    ----------
    mesh : Mesh
        Of one sector.
    sectors : sequence of Sector
        Its sides; several where bodies have their own.

    Returns
    -------
    Sectors
        Mesh and equations.

    Raises
    ------
    InputError
        For sides that do not exist, and nodes without a partner.

    Examples
    --------
    >>> import abut
    >>> from abut.mesh import make
    >>> mesh = make.join({"disc": make.ring((1.0, 2.0), (0.0, 30.0), cells=(2, 3))})
    >>> len(abut.add_sectors(mesh, [abut.Sector("disc.start", "disc.end", 12)]).equations)
    10
    """
    checks.instance(mesh, MeshRecord, "add_sectors: mesh", "a mesh (abut.Mesh)")
    equations: list[Equation] = []
    sets = dict(mesh.node_sets)
    for i, sector in enumerate(checks.records(sectors, "sectors", (Sector,))):
        where = f"sectors[{i}]"
        for key in ("side", "other"):
            checks.known(
                getattr(sector, key), [*mesh.surfaces, *mesh.node_sets], f"{where}.{key}", "surface or node set"
            )
        for key, count in (("origin", mesh.dim), ("axis", 3 if mesh.dim == 3 else 0)):
            given = getattr(sector, key)
            if given is not None and len(given) != count:
                said = f"expected {count} numbers, got {len(given)}" if count else "the model is 2D; leave axis out"
                raise InputError(f"{where}.{key}: {said}")
        if mesh.axisymmetric:
            raise InputError(f"{where}: an axisymmetric model is a whole turn; leave sectors out")
        nodes, partners, turn = _pairs(mesh, sector, where)
        equations += [row for a, b in zip(nodes, partners) for row in _rows(int(a), int(b), turn)]
        if sector.side not in mesh.node_sets:
            sets[f"{sector.side} nodes"] = nodes
    return Sectors(replace(mesh, node_sets=sets), tuple(equations))


def _pairs(mesh: Mesh, sector: Sector, where: str) -> tuple[Array, Array, Array]:
    """Nodes of the side that follows, their partners, and the turn (dim, dim) from these to the former."""
    nodes, others = (np.unique(mesh.nodes_of(name)) for name in (sector.side, sector.other))
    origin = np.array(sector.origin or (0.0,) * mesh.dim)
    axis = np.array(sector.axis or (0.0, 0.0, 1.0)) if mesh.dim == 3 else None
    found = matched(mesh.points[nodes], mesh.points[others], sector.sectors, origin, axis)
    if not found.fits or len(nodes) != len(others):
        worst = int(found.distance.argmax())
        at = ", ".join(f"{value:.6g}" for value in mesh.points[nodes[worst]])
        raise InputError(
            f"{where}: no node of '{sector.other}' is where ({at}) of '{sector.side}' is one of {sector.sectors} sectors "
            f"on (off by {found.distance[worst]:.3g}, {len(nodes)} and {len(others)} nodes); mesh both sides alike, or "
            "correct sectors, axis and origin"
        )
    return nodes, others[found.match], found.turn


def _rows(node: int, partner: int, turn: Array) -> list[Equation]:
    """u = R v of a node and its partner; of a node on the axis, (1 - R) u = 0."""
    result = []
    for k, row in enumerate(turn):
        own = np.eye(len(turn))[k]
        if node == partner:
            terms = [(node, j, own[j] - row[j]) for j in range(len(turn))]
        else:
            terms = [(node, k, 1.0), *((partner, j, -row[j]) for j in range(len(turn)))]
        kept = tuple(Term(at, COMPONENTS[j], float(c)) for at, j, c in terms if abs(c) > TINY)
        if kept:
            result.append(Equation(kept))
    return result
