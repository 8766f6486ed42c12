"""Smoothed aggregation of the stiffness (PyAMG): one hierarchy for all iterations and load steps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.errors import InputError

COARSEST = 600  # unknowns that are solved directly
Apply = Callable[[NDArray[np.float64]], NDArray[np.float64]]


@dataclass(frozen=True)
class Hierarchy:
    """cycle: one V-cycle, symmetric positive (semi-)definite, (n_free,) -> (n_free,); summary: for the log."""

    cycle: Apply
    summary: str


def hierarchy(stiffness: Any, free: Any, motions: NDArray[np.float64], dim: int) -> Hierarchy:
    """Multigrid for ``stiffness`` on the free displacements.

    free: (dim n_points, n_free) change of variables, every column at one point; motions: (dim n_points, m) rigid motions,
    each body's own. Points with fewer than ``dim`` free directions are filled up with trivial rows, so that the matrix
    has whole blocks, one a point: cheaper smoothing and aggregates of whole points. Raises InputError where PyAMG is not
    installed.
    """
    try:
        import pyamg
    except ImportError:
        raise InputError(
            'solve.linear: "amg" needs PyAMG, which is not installed: pip install pyamg; or choose "direct"'
        ) from None
    slot, size = _slots(free, dim)
    diagonal = stiffness.diagonal()
    filler = np.full(size, float(np.median(diagonal)))
    filler[slot] = 0.0
    entries = stiffness.tocoo()
    padded = sp.csr_matrix((entries.data, (slot[entries.row], slot[entries.col])), shape=(size, size))
    padded = (padded + sp.diags(filler)).tobsr((dim, dim))
    near_null = np.zeros((size, motions.shape[1]))
    near_null[slot] = free.T @ motions
    smoother = ("chebyshev", {"degree": 2})  # products with the matrix only: faster than Gauss-Seidel
    levels = pyamg.smoothed_aggregation_solver(
        padded,
        B=near_null,
        strength=("symmetric", {"theta": 0.0}),
        presmoother=smoother,
        postsmoother=smoother,
        improve_candidates=None,  # rigid motions need no improving
        max_coarse=COARSEST,
    )
    apply = levels.aspreconditioner(cycle="V")

    def cycle(residual: NDArray[np.float64]) -> NDArray[np.float64]:
        whole = np.zeros(size)
        whole[slot] = residual
        return np.asarray(apply @ whole)[slot]

    return Hierarchy(
        cycle, f"multigrid with {len(levels.levels)} levels, complexity {levels.operator_complexity():.2f}"
    )


def _slots(free: Any, dim: int) -> tuple[NDArray[np.int64], int]:
    """Where each free displacement goes among ``dim`` places a point, points without any left out; and how many places."""
    columns = free.tocsc()
    point = columns.indices[columns.indptr[:-1]].astype(np.int64) // dim
    _, number = np.unique(point, return_inverse=True)
    order = np.argsort(number, kind="stable")
    count = np.bincount(number)
    local = np.arange(len(number)) - np.repeat(np.cumsum(count) - count, count)
    slot = np.empty(len(number), dtype=np.int64)
    slot[order] = dim * number[order] + local
    return slot, dim * len(count)
