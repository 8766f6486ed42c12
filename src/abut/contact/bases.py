"""Bases of the pressure on each facet: non-negative ones of degree 2, and dual ones."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.cells import CELLS, MAX_FACET_NODES
from abut.contact.coupling import Coupling
from abut.contact.geometry import by_kind, function_count
from abut.mesh.surface import Surface
from abut.types import Sparse

SLIVER = 1e4  # condition of a facet's mass matrix above which it has no well-determined dual basis


def block_diagonal(contactor: Surface, blocks: dict[str, NDArray[np.float64]]) -> Sparse:
    """Sparse (9 n, 9 n) matrix from one dense block (or one per facet) for each facet type."""
    rows, columns, values = [], [], []
    for kind, facets in by_kind(contactor):
        block = np.broadcast_to(blocks[kind], (len(facets), *blocks[kind].shape[-2:]))
        i, j = np.meshgrid(np.arange(block.shape[1]), np.arange(block.shape[2]), indexing="ij")
        rows.append((MAX_FACET_NODES * facets[:, None] + i.ravel()).ravel())
        columns.append((MAX_FACET_NODES * facets[:, None] + j.ravel()).ravel())
        values.append(block.reshape(len(facets), -1).ravel())
    size = MAX_FACET_NODES * len(contactor)
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


def non_negative(contactor: Surface) -> Sparse:
    """Sparse (9 n, 9 n): facet-wise nodal values of the non-negative basis of every facet's quadratic functions."""
    kinds = [kind for kind, _ in by_kind(contactor)]
    c = 0.125 if "quad8" in kinds else 0.25  # one value on the whole surface keeps edges between types continuous
    return block_diagonal(contactor, {kind: non_negative_block(kind, c) for kind in kinds})


def sound_facets(mass: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Facets (n,) whose mass matrices (n, k, k) can be inverted safely: a sliver has no well-determined dual basis."""
    if not len(mass):
        return np.zeros(0, dtype=bool)
    values = np.linalg.eigvalsh(mass)
    return np.asarray((values[:, 0] > 0.0) & (values[:, -1] < SLIVER * values[:, 0]))


def dual(contactor: Surface, coupling: Coupling, plain: NDArray[np.bool_] | None = None) -> Sparse:
    """Sparse (9 n, 9 n): nodal values of the biorthogonal functions phi_k = sum_l A_kl N_l with int phi_k N_l = delta_kl
    int N_l on each covered facet, theory (P4); slivers of facets keep the functions N_l.

    coupling: of degree 1; plain: (n_facets,) facets that keep the functions N_l too."""
    plain = np.zeros(len(contactor), dtype=bool) if plain is None else plain
    blocks = {}
    for kind, facets in by_kind(contactor):
        n = function_count(kind, 1)
        mass = coupling.mass[facets][:, :n, :n]
        weight = coupling.weight.reshape(-1, MAX_FACET_NODES)[facets, :n]
        block = np.tile(np.eye(n), (len(facets), 1, 1))
        sound = sound_facets(mass) & ~plain[facets]
        if sound.any():
            block[sound] = np.linalg.solve(mass[sound], np.eye(n) * weight[sound][:, None, :])  # column k: phi_k
        blocks[kind] = block
    return block_diagonal(contactor, blocks)
