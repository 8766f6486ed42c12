"""Pressure spaces: combinations of the facet-wise pressure functions.

Every space is a sparse matrix ``transfer`` from its coefficients to the facet-wise nodal values of
``abut.contact.coupling``; continuity, the non-negative basis, the dual basis, removed and merged multipliers are all
such combinations, so that whatever is linear in the pressure (operator, weighted gap, weight) follows by its transpose:
theory (P1).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.cells import MAX_FACET_NODES
from abut.contact.bases import dual, non_negative
from abut.contact.coupling import Coupling, surface_degree
from abut.contact.geometry import by_kind, full_moments, function_count, split_at_creases
from abut.contact.turned_images import used_sides
from abut.errors import InputError
from abut.mesh.surface import Surface
from abut.types import Sparse

NO_SUPPORT = 1e-9  # covered share, theory (P5), of a multiplier's own support below which there is nothing to integrate
WEAK_SUPPORT = 0.05  # below this share a multiplier follows its neighbour: alone it would be ill-determined
WEAK_DUAL = 0.2  # the same for dual functions, whose pieces on slivers swing more
BAND = 2  # layers of closed facets with dual functions along the edge of contact
EVEN = 1e-9  # of the largest weight: neighbours with less difference are equals, and the first of them is followed
DUAL, DUAL_P1 = "dual", "dual-P1"


@dataclass(frozen=True)
class PressureSpace:
    """A pressure space on a contactor.

    transfer: (9 n_facets, n) sparse, coefficients -> facet-wise nodal values. The basis functions are non-negative (P2:
              Bernstein-like; the dual basis only in the mean), so that coefficient and weighted gap can be compared.
    plain:    (9 n_facets, n) the same with the ordinary functions in place of the dual ones; else ``transfer``.
    weight:   (n,) int of each basis function over the covered part, > 0.
    node:     (n,) point at which the function sits, -1 for functions that belong to a facet alone.
    side:     (n,) the same on the contactor split at its creases (``split_at_creases``): a point on a crease has a function
              for each smooth side.
    removed:  how many multipliers were removed or made to follow a neighbour.
    merges:   multipliers that go make a neighbour follow; else they vanish.
    seams:    (m, 2) points of the contactor split at its creases: one at a seam of glued bodies that follows, theory (P29),
              and one that it follows; None for none.
    """

    name: str
    degree: int
    transfer: Sparse
    plain: Sparse
    weight: NDArray[np.float64]
    node: NDArray[np.int64]
    side: NDArray[np.int64]
    removed: int = 0
    merges: bool = True
    seams: NDArray[np.int64] | None = None

    def __len__(self) -> int:
        return int(self.transfer.shape[1])

    @property
    def continuous(self) -> bool:
        """Whether coefficients belong to points, so that their ordinary functions make a continuous field."""
        return bool((self.node >= 0).all())

    @property
    def ordinary(self) -> bool:
        """Whether no function is a dual one."""
        return self.transfer is self.plain


def resolve(name: str, contactor: Surface, free_edge: bool = True) -> tuple[str, int]:
    """The space's name with "auto" resolved, and the degree of its facet-wise functions.

    name: "auto", "P0", "P1", "P1-discontinuous", "P2", "P2-discontinuous", "dual" or "dual-P1".
    free_edge: whether contact may open, and its law looks at weighted gaps (complementarity). Then "auto" is "dual-P1",
    docs/theory/pressure-spaces.md; else the continuous space of the displacement's order, and "dual-P1", which is dual at
    the edge of contact only, is "P1".
    Raises InputError for quadratic pressure on linear facets.
    """
    highest = surface_degree(contactor)
    if name == "auto":
        name = DUAL_P1 if free_edge else f"P{highest}"
    if name == DUAL_P1 and not free_edge:
        name = "P1"
    degree = 2 if name.startswith("P2") else 1
    if degree > highest:
        raise InputError(
            f"pressure: {name} needs quadratic facets, but '{contactor.name}' has linear ones; choose P1 or auto"
        )
    return name, degree


def pressure_space(name: str, contactor: Surface, coupling: Coupling, tied: bool = False) -> PressureSpace:
    """Build the space ``name`` on the covered part of the contactor.

    name: as from ``resolve``; coupling: of that contactor, with the degree from ``resolve``. Multipliers with hardly any
    of their support covered follow a neighbour, theory (P5), (P6); those with none vanish. "dual-P1" begins as "dual":
    ``with_plain_facets``. Continuous spaces end at creases, where the pressure jumps with the normal, theory (P13); not
    those of ties, which have as many components there as the point has displacements.
    """
    split, owner = (contactor, np.arange(len(contactor.points))) if tied else split_at_creases(contactor)
    row, side = facet_functions(split, coupling.degree)
    rows = MAX_FACET_NODES * len(contactor)
    if name == "P0":
        ids, column = np.full(len(contactor), -1), row // MAX_FACET_NODES
    elif name.endswith("discontinuous"):
        ids, column = np.full(len(row), -1), np.arange(len(row))
    else:
        ids, column = np.unique(side if tied else _at_partner(split, side), return_inverse=True)
    gather = sp.csr_matrix((np.ones(len(row)), (row, column.ravel())), shape=(rows, len(ids)))
    plain = (non_negative(contactor) @ gather).tocsr() if coupling.degree == 2 else gather
    is_dual = name in (DUAL, DUAL_P1)
    transfer = (dual(contactor, coupling) @ gather).tocsr() if is_dual else plain
    ids = ids.astype(np.int64)
    node = np.where(ids >= 0, owner[ids], -1)
    space = PressureSpace(name, coupling.degree, transfer, plain, transfer.T @ coupling.weight, node, ids)
    share = covered_share(space, contactor, coupling)
    return reduce(space, coupling, keep=share >= (WEAK_DUAL if is_dual else WEAK_SUPPORT), exists=share > NO_SUPPORT)


def _at_partner(split: Surface, side: NDArray[np.int64]) -> NDArray[np.int64]:
    """Points (n,); those on one side of a sector as their partners on the other, where one function stands: theory (P27)."""
    sides = used_sides(split)
    if sides is None:
        return side
    to = np.arange(len(split.points))
    to[sides.nodes] = sides.partners
    return to[side]


def covered_share(space: PressureSpace, contactor: Surface, coupling: Coupling) -> NDArray[np.float64]:
    """Of theory (P5), (n,): by the ordinary functions, since dual ones know nothing of the part that is not covered."""
    full = space.plain.T @ full_moments(contactor, coupling.degree).ravel()
    return np.asarray(space.plain.T @ coupling.weight / np.maximum(full, 1e-300))


def inner_facets(
    space: PressureSpace, contactor: Surface, covered: NDArray[np.bool_], active: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Facets (n_facets,) far enough inside closed contact for ordinary functions, theory (P9): with ``BAND`` layers of
    closed facets between them and the next one that is open or not all covered. On linear facets, where that gains nothing
    once a part is open, all or none.

    covered: (n_facets,) bool, facets with the target opposite all of them; active: (n,) bool."""
    uses = abs(space.plain)
    inner = _within(uses, active) & covered
    if surface_degree(contactor) == 1:
        return np.full(len(inner), inner.all())
    for _ in range(BAND):
        inner = _within(uses, ~_touched(uses, ~inner)) & inner
    return inner


def _within(uses: Sparse, closed: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Facets that have multipliers, all of them closed."""
    some, others = (
        (uses @ chosen.astype(float)).reshape(-1, MAX_FACET_NODES).sum(axis=1) > 0.0 for chosen in (closed, ~closed)
    )
    return np.asarray(some & ~others)


def _touched(uses: Sparse, facets: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Multipliers with a part on given facets."""
    return np.asarray(uses.T @ np.repeat(facets, MAX_FACET_NODES).astype(float) > 0.0)


def with_plain_facets(
    space: PressureSpace, contactor: Surface, coupling: Coupling, plain: NDArray[np.bool_]
) -> PressureSpace:
    """A dual space with the ordinary functions on some facets, theory (P9): continuous, and exact for linear pressures,
    where contact is closed. Coefficients keep their meaning and weights, since int phi_k = int N_k on every facet.

    plain: (n_facets,) bool."""
    transfer = space.plain if plain.all() else (dual(contactor, coupling, plain) @ space.plain).tocsr()
    return replace(space, transfer=transfer)


def partly_dual(space: PressureSpace, share: NDArray[np.float64]) -> PressureSpace:
    """A space with dual functions and ordinary ones mixed on each facet: constants are in it as they were, and integrals of
    the functions over whole facets stay. share: (n_facets,) of the dual ones, 0 to 1."""
    if space.ordinary:
        return space
    rows = np.repeat(share, MAX_FACET_NODES)
    if not rows.any():
        return replace(space, transfer=space.plain)
    return replace(space, transfer=(sp.diags(rows) @ space.transfer + sp.diags(1.0 - rows) @ space.plain).tocsr())


def reduce(
    space: PressureSpace,
    coupling: Coupling,
    keep: NDArray[np.bool_],
    exists: NDArray[np.bool_] | None = None,
    onto: NDArray[np.int64] | None = None,
) -> PressureSpace:
    """Take multipliers out. One that shares a facet with a kept one follows the best supported of these (so that a
    constant pressure stays in the space), theory (P6); the others vanish.

    keep: (n,) bool; exists: (n,) bool, which of those that go may follow a neighbour (left out: as ``space.merges``);
    onto: (n,) a kept multiplier to follow instead of a neighbour, -1 for none.
    """
    n = len(space)
    if keep.all():
        return space
    exists = np.full(n, space.merges) if exists is None else exists
    kept = np.flatnonzero(keep)
    to = np.full(n, -1) if onto is None else np.where(keep, -1, onto)
    to = np.where(to >= 0, to, leaders(space, keep, ~keep & exists & (to < 0)))
    followers = np.flatnonzero(to >= 0)
    rows, columns = np.concatenate([kept, followers]), np.concatenate([kept, to[followers]])
    return following(space, coupling, sp.csr_matrix((np.ones(len(rows)), (rows, columns)), shape=(n, n)))


def following(space: PressureSpace, coupling: Coupling, follow: Sparse) -> PressureSpace:
    """Coefficients (n,) as ``follow`` (n, n) times those that stay, which are the ones that have themselves."""
    kept = np.flatnonzero(follow.diagonal() == 1.0)
    follow = follow.tocsc()[:, kept]
    plain = (space.plain @ follow).tocsr()
    transfer = plain if space.ordinary else (space.transfer @ follow).tocsr()
    return replace(
        space,
        transfer=transfer,
        plain=plain,
        weight=transfer.T @ coupling.weight,
        node=space.node[kept],
        side=space.side[kept],
        removed=space.removed + len(space) - len(kept),
    )


def leaders(space: PressureSpace, keep: NDArray[np.bool_], goes: NDArray[np.bool_]) -> NDArray[np.int64]:
    """The best supported one of ``keep`` that shares a facet with each of ``goes``, theory (P6), (n,); -1 where there is
    none, and for all others. keep, goes: (n,) bool."""
    pattern = space.plain.copy()
    pattern.data = np.ones_like(pattern.data)
    facets = sp.csr_matrix(
        (np.ones(pattern.shape[0]), np.arange(pattern.shape[0]) // MAX_FACET_NODES, np.arange(pattern.shape[0] + 1))
    )
    by_facet = facets.T @ pattern
    near = (by_facet.T @ by_facet).tocoo()
    use = goes[near.row] & keep[near.col]
    row, column = near.row[use], near.col[use]
    most = np.zeros(len(space))
    np.maximum.at(most, row, space.weight[column])
    best = space.weight[column] >= (1.0 - EVEN) * most[row]  # not by rounding
    result = np.full(len(space), len(space))
    np.minimum.at(result, row[best], column[best])
    return np.where(result < len(space), result, -1)


def beside(space: PressureSpace, some: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Some functions and those that share a facet with one, (n,). some: (n,) bool."""
    uses = abs(space.plain)
    return _touched(uses, (uses @ some.astype(float)).reshape(-1, MAX_FACET_NODES).sum(axis=1) > 0.0)


def only(space: PressureSpace, keep: NDArray[np.bool_]) -> PressureSpace:
    """The space without some functions, which vanish. keep: (n,) bool."""
    transfer = space.transfer.tocsc()[:, keep]
    plain = transfer if space.ordinary else space.plain.tocsc()[:, keep]
    return replace(
        space, transfer=transfer, plain=plain, weight=space.weight[keep], node=space.node[keep], side=space.side[keep]
    )


def facet_functions(contactor: Surface, degree: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Row (9 facet + function) and point of every facet-wise pressure function, each (n_functions,)."""
    count = np.zeros(len(contactor), dtype=np.int64)
    for kind, facets in by_kind(contactor):
        count[facets] = function_count(kind, degree)
    facet = np.repeat(np.arange(len(contactor)), count)
    local = np.arange(len(facet)) - np.repeat(np.cumsum(count) - count, count)
    return MAX_FACET_NODES * facet + local, contactor.nodes[facet, local].astype(np.int64)
