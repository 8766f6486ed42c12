"""Smoothed aggregation of the stiffness (PyAMG): one hierarchy for all iterations and load steps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut._core import block_product
from abut.errors import InputError
from abut.solvers.cycle import single_precision

COARSEST = 100  # aggregates whose equations are solved directly
Apply = Callable[[NDArray[np.float64]], NDArray[np.float64]]


@dataclass(frozen=True)
class Hierarchy:
    """cycle: one V-cycle, symmetric positive (semi-)definite; product: with the stiffness; both (n_free,) -> (n_free,);
    summary: for the log."""

    cycle: Apply
    product: Apply
    summary: str


def hierarchy(stiffness: Any, free: Any, motions: NDArray[np.float64], dim: int) -> Hierarchy:
    """Multigrid for ``stiffness`` on the free displacements.

    free: (dim n_points, n_free) change of variables, every column at one point; motions: (dim n_points, m) rigid motions,
    each body's own. Points with fewer than ``dim`` free directions are filled up with trivial rows, so that the matrix
    has whole blocks, one a point: cheaper products and aggregates of whole points. Raises InputError where PyAMG is not
    installed.
    """
    try:
        import pyamg
    except ImportError:
        raise InputError(
            'solve.linear: "amg" needs PyAMG, which is not installed: pip install pyamg; or choose "direct"'
        ) from None
    slot, size = _slots(free, dim)
    scale = float(np.median(stiffness.diagonal()))
    padded = _padded(stiffness, slot, size, dim, scale)
    near_null = np.zeros((size, motions.shape[1]))
    near_null[slot] = free.T @ motions
    levels = pyamg.smoothed_aggregation_solver(
        padded,
        B=near_null,
        strength=("symmetric", {"theta": 0.0}),
        presmoother=None,  # ours: see cycle.py
        postsmoother=None,
        smooth=("jacobi", {"weighting": "local"}),  # by row sums: needs no random vector
        improve_candidates=None,  # rigid motions need no improving
        max_coarse=COARSEST,
    )
    ours = single_precision(levels.levels)
    matrix = padded.indptr, padded.indices, padded.data

    def place(values: NDArray[np.float64]) -> NDArray[np.float64]:
        whole = np.zeros(size)
        whole[slot] = values
        return whole

    return Hierarchy(
        cycle=lambda residual: ours.cycle(place(residual))[slot] / scale,
        product=lambda values: block_product(*matrix, place(values))[slot] * scale,
        summary=f"multigrid with {len(levels.levels)} levels, complexity {levels.operator_complexity():.2f}",
    )


def _padded(stiffness: Any, slot: NDArray[np.int64], size: int, dim: int, scale: float) -> Any:
    """The stiffness over ``scale`` with its rows and columns at their slots and ones on the diagonal elsewhere, BSR."""
    counts = np.zeros(size + 1, dtype=np.int64)
    counts[slot + 1] = np.diff(stiffness.indptr)
    entries = stiffness.data / scale, slot.astype(np.int32)[stiffness.indices], np.cumsum(counts).astype(np.int32)
    padded = sp.csr_matrix(entries, shape=(size, size)).tobsr((dim, dim))
    empty = np.ones(size)
    empty[slot] = 0.0
    row = np.repeat(np.arange(size // dim), np.diff(padded.indptr))
    on_diagonal = np.flatnonzero(padded.indices == row)
    padded.data[on_diagonal[:, None], np.arange(dim), np.arange(dim)] += empty.reshape(-1, dim)
    return padded


def _slots(free: Any, dim: int) -> tuple[NDArray[np.int64], int]:
    """Where each free displacement goes among ``dim`` places a point, in ascending order, points without any left out; and
    how many places."""
    columns = free.tocsc()
    point = columns.indices[columns.indptr[:-1]].astype(np.int64) // dim
    _, number, count = np.unique(point, return_inverse=True, return_counts=True)
    local = np.arange(len(number)) - np.repeat(np.cumsum(count) - count, count)
    return dim * number + local, dim * len(count)
