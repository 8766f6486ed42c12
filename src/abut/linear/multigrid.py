"""Smoothed aggregation of the stiffness (PyAMG)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut._core import block_product, padded_blocks
from abut.dofs import dofs_at, n_dofs, n_places, place_of
from abut.errors import InputError
from abut.linear.multigrid_cycle import Level, Levels, coarse_matrix, inverse, level
from abut.linear.strength import means, near
from abut.types import Sparse

COARSEST = 100  # aggregates whose equations are solved directly
FEW = 2  # points up to which displacements that move several of them are a part of multigrid: no rigid body has so few
Apply = Callable[[NDArray[np.float64]], NDArray[np.float64]]


@dataclass(frozen=True)
class Hierarchy:
    """cycle: one V-cycle, symmetric positive (semi-)definite; product: with the stiffness; both (n_free,) -> (n_free,);
    summary: for the log."""

    cycle: Apply
    product: Apply
    summary: str


def hierarchy(stiffness: Sparse, free: Sparse, motions: NDArray[np.float64], points: NDArray[np.float64]) -> Hierarchy:
    """Multigrid for ``stiffness`` on the free displacements.

    free: (dim n_points, n_free) change of variables; motions: (n_free, m) rigid motions, each body's own; points:
    (n_points, dim). Points with fewer than ``dim`` free directions are filled up with trivial rows, so that the matrix has
    whole blocks, one a point: cheaper products and aggregates of whole points. Displacements of many points at once are left
    out: ``cycle`` leaves them at zero. Raises InputError where PyAMG is not installed.
    """
    dim, own = points.shape[1], np.flatnonzero(~wide(free, points.shape[1]))
    slot, point = slots(free.tocsc()[:, own], dim)
    order = np.argsort(slot)
    slot, own = slot[order], own[order]
    whole = len(own) == free.shape[1] and (np.diff(own) == 1).all()
    part = stiffness if whole else stiffness[own][:, own].tocsr()
    size, scale = n_dofs(len(point), dim), float(np.median(part.diagonal()))
    fine = _padded(part, slot, size, dim, scale)
    near_null = np.zeros((size, motions.shape[1]))
    near_null[slot] = motions[own]
    levels, entries = _levels(fine, near_null, points[point])
    matrix = fine.indptr, fine.indices, fine.data

    def place(values: NDArray[np.float64]) -> NDArray[np.float64]:
        blocks = np.zeros(size)
        blocks[slot] = values
        return blocks

    def cycle(residual: NDArray[np.float64]) -> NDArray[np.float64]:
        result = np.zeros_like(residual)
        result[own] = levels.cycle(place(residual[own]))[slot] / scale
        return result

    def product(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(block_product(*matrix, place(values))[slot] * scale)

    return Hierarchy(
        cycle=cycle,
        product=product if whole else lambda values: np.asarray(stiffness @ values),
        summary=f"multigrid with {len(levels.levels) + 1} levels, complexity {entries / fine.nnz:.2f}",
    )


def _levels(fine: Sparse, near_null: NDArray[np.float64], centres: NDArray[np.float64]) -> tuple[Levels, int]:
    """All levels of a matrix (BSR, one block a point), and how many entries they have. near_null: (n, m); centres:
    (n_blocks, dim)."""
    try:
        from pyamg.aggregation import fit_candidates, standard_aggregation
    except ImportError:
        raise InputError(
            'solve.linear: "amg" needs PyAMG, which is not installed: pip install pyamg; or choose "direct"'
        ) from None
    matrix, levels = fine, list[Level]()
    entries, stretched = fine.nnz, True
    while matrix.shape[0] // matrix.blocksize[0] > COARSEST:
        strong = near(matrix, centres) if stretched else matrix
        stretched = strong is not matrix
        ones = np.ones(len(strong.indices), dtype=np.int8)
        graph = sp.csr_matrix((ones, strong.indices, strong.indptr))
        aggregates, _ = standard_aggregation(graph)
        if aggregates.shape[1] in (0, graph.shape[0]):
            break
        tentative, near_null = fit_candidates(aggregates, near_null)
        centres = means(aggregates, centres)
        levels.append(level(matrix, strong, tentative))
        matrix = coarse_matrix(matrix, levels[-1])
        entries += matrix.nnz
    return Levels(levels, inverse(matrix)), entries


def _padded(stiffness: Sparse, slot: NDArray[np.int64], size: int, dim: int, scale: float) -> Sparse:
    """The stiffness over ``scale`` with its rows and columns at their slots and ones on the diagonal elsewhere, BSR."""
    rows = stiffness if stiffness.has_sorted_indices else stiffness.sorted_indices()
    indptr, indices, blocks = padded_blocks(
        rows.indptr.astype(np.int32), rows.indices.astype(np.int32, copy=False), rows.data, slot.astype(np.int32), dim,
        n_places(size, dim), 1.0 / scale,
    )  # fmt: skip
    return sp.bsr_matrix((blocks.reshape(-1, dim, dim), indices, indptr), shape=(size, size))


def wide(free: Sparse, dim: int) -> NDArray[np.bool_]:
    """(n_free,) which free displacements move many points, as those of a rigid body do."""
    entries = free.tocoo()
    point = sp.csr_matrix(
        (np.ones(entries.nnz), (entries.col, place_of(entries.row, dim))), shape=(free.shape[1], free.shape[0])
    )
    return np.diff(point.indptr) > FEW


def slots(free: Sparse, dim: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Where each free displacement goes among ``dim`` places a block, in ascending order of points, and the point of each
    block. What moves one point is in that point's block; what moves several is alone in one, at the first of them."""
    columns = free.tocsc()
    sizes = np.diff(columns.indptr)
    of_entries = place_of(columns.indices.astype(np.int64), dim)
    first = np.minimum.reduceat(of_entries, columns.indptr[:-1]) if len(sizes) else of_entries
    last = np.maximum.reduceat(of_entries, columns.indptr[:-1]) if len(sizes) else of_entries
    alone = np.where(first == last, 0, 1 + np.arange(len(sizes)))
    (points, _), number, count = np.unique(np.stack([first, alone]), axis=1, return_inverse=True, return_counts=True)
    number = np.ravel(number)
    order = np.argsort(number, kind="stable")
    local = np.empty(len(number), dtype=np.int64)
    local[order] = np.arange(len(number)) - np.repeat(np.cumsum(count) - count, count)
    return dofs_at(number, dim)[np.arange(len(number)), local], points
