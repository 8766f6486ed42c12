"""What is shown of a contact that goes on beyond the sides of a sector: recovered with the facets there."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut.cells import MAX_FACET_NODES
from abut.contact.geometry import split_at_creases
from abut.contact.point_values import Recovery
from abut.contact.symmetry_planes import Planes
from abut.contact.turned_images import Extended, extended, used_sides
from abut.mesh.surface import Surface
from abut.problem.pair import Pair
from abut.solution import Check
from abut.types import Array

RINGS = 6  # of facets, beyond which nothing changes what is shown: fits to neighbours of neighbours, edges beside them

BESIDE = 2  # facets from a side, to which what is not continued reaches


@dataclass(frozen=True)
class Shown:
    """A pressure that was recovered on a contactor, or on one with the facets beyond the sides of a sector, whose first
    facets and points are its own. nodal: (n_facets, 9), average: (n_points,), as of ``Recovery``, its own;
    loaded: (n_functions,) how much of the area of each of the pair's functions is."""

    recovery: Recovery
    more: Extended | None
    own: Surface
    loaded: NDArray[np.float64]

    @property
    def fits(self) -> bool:
        """Whether there are polynomials."""
        return self.recovery.fits is not None

    @property
    def nodal(self) -> NDArray[np.float64]:
        return self.recovery.nodal[: len(self.own)]

    @property
    def average(self) -> NDArray[np.float64]:
        return self.recovery.average[: len(self.own.points)]

    def field(self, values: Array) -> NDArray[np.float64]:
        """As of ``Recovery``."""
        every = values if self.more is None else facet_wise(self.more, values)
        return self.recovery.field(every)[: len(self.own)]

    def vectors(self, values: Array) -> NDArray[np.float64]:
        """Vectors (9 n_facets, dim) at the facets' nodes, (n_facets, 9, dim), component by component."""
        if self.more is not None:
            every = facet_wise(self.more, values)
            values = self.more.turned(every, np.repeat(self.more.power, MAX_FACET_NODES))
        fields = [self.recovery.field(component)[: len(self.own)] for component in values.T]
        return np.stack(fields, axis=-1)


@dataclass(frozen=True)
class Beyond:
    """A pair with the facets beyond the sides of a sector, to recover from; ``of`` where there are some."""

    pair: Pair
    more: Extended
    own: Surface

    @classmethod
    def of(cls, pair: Pair) -> Beyond | None:
        if used_sides(pair.contactor) is None:
            return None
        split, owner = split_at_creases(pair.contactor)
        more = extended(split, RINGS)
        wide = replace(
            pair, contactor=more.surface, coupling=replace(pair.coupling, mass=pair.coupling.mass[more.source]),
            planes=None if pair.planes is None else _turned_planes(pair.planes, owner, more),
            interior=None if pair.interior is None else pair.interior[more.source],
        )  # fmt: skip
        return cls(wide, more, split)


def sides_line(pair: Pair, values: Array, note: str) -> Iterator[Check]:
    """What to know of a contact that reaches the sides of a sector, beyond which something of it is not continued: its
    ``note``, empty for nothing. values: (9 n_facets, ...) facet-wise coefficients of pressure or traction."""
    if not note:
        return
    forces = np.abs(values * pair.coupling.weight.reshape(-1, *[1] * (values.ndim - 1)))
    by_facet = forces.reshape(len(pair.contactor), -1).sum(axis=1)
    if by_facet.any():
        near = beside_sides(pair.contactor)
        share = float(by_facet[near].sum() / by_facet.sum())
        yield Check(pair.contact.name, "sides of the sector", share, 1.0,
            f"share of the force within {BESIDE} facets of the sides, where {note}", notice=0.0)  # fmt: skip


def beside_sides(contactor: Surface) -> NDArray[np.bool_]:
    """Facets (n_facets,) within ``BESIDE`` of the sides of a sector."""
    sides, used = used_sides(contactor), contactor.nodes >= 0
    near = np.zeros(len(contactor.points), dtype=bool)
    if sides is not None:
        near[np.concatenate([sides.nodes, sides.partners])] = True
    for _ in range(BESIDE):
        facets = np.asarray((near[np.maximum(contactor.nodes, 0)] & used).any(axis=1))
        near[contactor.nodes[facets][used[facets]]] = True
    return facets


def facet_wise(more: Extended, values: Array) -> NDArray[np.float64]:
    """Facet-wise coefficients (9 n_facets, ...) of all facets."""
    table = values.reshape(-1, MAX_FACET_NODES, *values.shape[1:])
    return np.asarray(table[more.source].reshape(-1, *values.shape[1:]))


def _turned_planes(planes: Planes, owner: NDArray[np.int64], more: Extended) -> Planes:
    """owner: of the points that ``more`` has its own from, those of ``planes``."""
    source, power = owner[more.point], more.point_power
    return Planes(
        planes.count[source], more.turned(planes.along[source], power), more.turned(planes.across[source], power),
        planes.uneven[more.source],
    )  # fmt: skip
