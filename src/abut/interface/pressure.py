"""Pressure spaces: combinations of the facet-wise pressure functions.

Every space is a sparse matrix ``transfer`` from its coefficients to the facet-wise nodal values of
``abut.interface.coupling``; continuity, the non-negative basis, the dual basis, removed and merged multipliers are all
such combinations, so that whatever is linear in the pressure (operator, weighted gap, weight) follows by its transpose:
theory (P1).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.errors import InputError
from abut.interface.coupling import Coupling, surface_degree
from abut.interface.geometry import by_kind, full_moments, function_count
from abut.mesh.surface import Surface

NO_SUPPORT = 1e-9  # covered share, theory (P5), of a multiplier's own support below which there is nothing to integrate
WEAK_SUPPORT = 0.05  # below this share a multiplier follows its neighbour: alone it would be ill-determined


@dataclass(frozen=True)
class PressureSpace:
    """A pressure space on a contactor.

    transfer: (9 n_facets, n) sparse, coefficients -> facet-wise nodal values. The basis functions are non-negative (P2:
              Bernstein-like; the dual basis only in the mean), so that coefficient and weighted gap can be compared.
    weight:   (n,) int of each basis function over the covered part, > 0.
    node:     (n,) point at which the function sits, -1 for functions that belong to a facet alone.
    removed:  how many multipliers were removed or made to follow a neighbour.
    merges:   multipliers that go make a neighbour follow; else they vanish.
    """

    name: str
    degree: int
    transfer: Any
    weight: NDArray[np.float64]
    node: NDArray[np.int64]
    removed: int = 0
    merges: bool = True

    def __len__(self) -> int:
        return int(self.transfer.shape[1])


def resolve(name: str, contactor: Surface) -> tuple[str, int]:
    """The space's name with "auto" resolved (continuous, of the displacement's order), and its degree.

    name: "auto", "P0", "P1", "P1-discontinuous", "P2", "P2-discontinuous" or "dual".
    Raises InputError for quadratic pressure on linear facets.
    """
    highest = surface_degree(contactor)
    if name == "auto":
        name = f"P{highest}"
    degree = 1 if name == "dual" else int(name[1])
    if degree > highest:
        raise InputError(
            f"pressure: {name} needs quadratic facets, but '{contactor.name}' has linear ones; choose P1 or auto"
        )
    return name, degree


def pressure_space(name: str, contactor: Surface, coupling: Coupling) -> PressureSpace:
    """Build the space ``name`` on the covered part of the contactor.

    name: as from ``resolve``; coupling: of that contactor, with the degree from ``resolve``. Multipliers with hardly any
    of their support covered follow a neighbour, theory (P5), (P6); those with none vanish.
    """
    row, node = facet_functions(contactor, coupling.degree)
    rows = 9 * len(contactor)
    if name in ("P1", "P2", "dual"):
        ids, column = np.unique(node, return_inverse=True)
        column = column.ravel()
    else:
        ids, column = np.full(len(row), -1), np.arange(len(row))
    gather = sp.csr_matrix((np.ones(len(row)), (row, column)), shape=(rows, len(ids)))
    if name == "dual":
        transfer = _dual(contactor, coupling) @ gather
    elif coupling.degree == 2:
        transfer = non_negative(contactor) @ gather
    else:
        transfer = gather
    transfer = transfer.tocsr()
    space = PressureSpace(name, coupling.degree, transfer, transfer.T @ coupling.weight, ids.astype(np.int64))
    share = space.weight / np.maximum(transfer.T @ full_moments(contactor, coupling.degree).ravel(), 1e-300)
    return reduce(space, coupling, keep=share >= WEAK_SUPPORT, exists=share > NO_SUPPORT)


def reduce(
    space: PressureSpace, coupling: Coupling, keep: NDArray[np.bool_], exists: NDArray[np.bool_] | None = None
) -> PressureSpace:
    """Take multipliers out. One that shares a facet with a kept one follows the best supported of these (so that a
    constant pressure stays in the space), theory (P6); the others vanish.

    keep: (n,) bool; exists: (n,) bool, which of those that go may follow a neighbour (left out: as ``space.merges``).
    """
    n = len(space)
    if keep.all():
        return space
    exists = np.full(n, space.merges) if exists is None else exists
    kept = np.flatnonzero(keep)
    position = np.full(n, -1)
    position[kept] = np.arange(len(kept))
    pattern = space.transfer.copy()
    pattern.data = np.ones_like(pattern.data)
    facets = sp.csr_matrix(
        (np.ones(pattern.shape[0]), np.arange(pattern.shape[0]) // 9, np.arange(pattern.shape[0] + 1))
    )
    by_facet = facets.T @ pattern
    neighbours = (by_facet.T @ by_facet).tocsr()
    rows, columns = [*kept], [*position[kept]]
    for k in np.flatnonzero(~keep & exists):
        near = neighbours.indices[neighbours.indptr[k] : neighbours.indptr[k + 1]]
        near = near[keep[near]]
        if len(near):
            rows.append(k)
            columns.append(position[near[np.argmax(space.weight[near])]])
    follow = sp.csr_matrix((np.ones(len(rows)), (rows, columns)), shape=(n, len(kept)))
    transfer = (space.transfer @ follow).tocsr()
    return replace(
        space,
        transfer=transfer,
        weight=transfer.T @ coupling.weight,
        node=space.node[kept],
        removed=space.removed + n - len(kept),
    )


def facet_functions(contactor: Surface, degree: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Row (9 facet + function) and point of every facet-wise pressure function, each (n_functions,)."""
    count = np.zeros(len(contactor), dtype=np.int64)
    for kind, facets in by_kind(contactor):
        count[facets] = function_count(kind, degree)
    facet = np.repeat(np.arange(len(contactor)), count)
    local = np.arange(len(facet)) - np.repeat(np.cumsum(count) - count, count)
    return 9 * facet + local, contactor.nodes[facet, local].astype(np.int64)


def _block_diagonal(contactor: Surface, blocks: dict[str, NDArray[np.float64]]) -> Any:
    """Sparse (9 n, 9 n) matrix from one dense block (or one per facet) for each facet type."""
    rows, columns, values = [], [], []
    for kind, facets in by_kind(contactor):
        block = np.broadcast_to(blocks[kind], (len(facets), *blocks[kind].shape[-2:]))
        i, j = np.meshgrid(np.arange(block.shape[1]), np.arange(block.shape[2]), indexing="ij")
        rows.append((9 * facets[:, None] + i.ravel()).ravel())
        columns.append((9 * facets[:, None] + j.ravel()).ravel())
        values.append(block.reshape(len(facets), -1).ravel())
    size = 9 * len(contactor)
    matrix = sp.csr_matrix(
        (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(size, size)
    )
    matrix.eliminate_zeros()
    return matrix


def non_negative_block(kind: str, c: float) -> NDArray[np.float64]:
    """Nodal values (nodes, nodes) of a non-negative basis of a quadratic facet's space, one column a function.

    On an edge the functions are (1 -+ s)/2 - c (1 - s^2) at the ends and 2 c (1 - s^2) in the middle: a
    partition of unity for every c, theory (P2), (P3), the Bernstein polynomials for c = 1/4. With c = 1/8 the
    serendipity functions of quad8 are non-negative as well (with 1/4 those at the corners are not).
    """
    cell = CELLS[kind]
    block = np.eye(cell.nodes)
    if cell.degree == 1:
        return block
    middle, end = 2.0 * c, 0.5 - c
    if cell.dim == 1:
        block[2] = [end, end, middle]
        return block
    n = cell.corners
    for e in range(n):
        block[n + e] = 0.0
        block[n + e, [e, (e + 1) % n]] = end
        block[n + e, n + e] = middle
    if cell.nodes == 9:
        block[8, :4], block[8, 4:8], block[8, 8] = end * end, end * middle, middle * middle
    return block


def non_negative(contactor: Surface) -> Any:
    """Sparse (9 n, 9 n): facet-wise nodal values of the non-negative basis of every facet's quadratic functions."""
    kinds = [kind for kind, _ in by_kind(contactor)]
    c = 0.125 if "quad8" in kinds else 0.25  # one value on the whole surface keeps edges between types continuous
    return _block_diagonal(contactor, {kind: non_negative_block(kind, c) for kind in kinds})


def _dual(contactor: Surface, coupling: Coupling) -> Any:
    """Biorthogonal functions phi_k = sum_l A_kl N_l with int phi_k N_l = delta_kl int N_l on each covered facet,
    theory (P4)."""
    blocks = {}
    for kind, facets in by_kind(contactor):
        n = function_count(kind, 1)
        mass = coupling.mass[facets][:, :n, :n]
        weight = coupling.weight.reshape(-1, 9)[facets, :n]
        block = np.tile(np.eye(n), (len(facets), 1, 1))
        # A sliver of a facet has no well-determined dual basis: it keeps the plain functions.
        sound = np.array([np.linalg.cond(m) < 1e4 if m.any() else False for m in mass], dtype=bool)
        if sound.any():
            solved = np.linalg.solve(mass[sound], np.eye(n) * weight[sound][:, None, :])
            block[sound] = solved  # column k: nodal values of phi_k
        blocks[kind] = block
    return _block_diagonal(contactor, blocks)
