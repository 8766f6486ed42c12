"""The block system of one Newton iteration: displacements and the pressures of all pairs."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.solvers import direct
from abut.solvers.newton import Rows


def newton_step(
    stiffness: Any,
    operator: Any,
    rows: Rows,
    residual: NDArray[np.float64],
    pressure: NDArray[np.float64],
    accuracy: float = 0.0,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Solve [K, -B^T; r_u, r_p] (du, dp) = -(residual, r), theory (V1), and return (du, dp).

    stiffness: (n_u, n_u) sparse symmetric; operator B: (n, n_u), all pairs stacked; residual: K u - B^T p - f.
    accuracy: not needed, the solution is direct.
    """
    n = len(pressure)
    if n == 0:
        return direct.solve(sp.triu(stiffness, format="csr"), -residual, symmetric=True), pressure
    # Pressures are scaled so that both blocks have entries of one size: dp = s q, law rows times t; theory (V2).
    unit = np.median(stiffness.diagonal())
    s = unit / _row_max(operator)
    # Decoupled pressures take their value at once.
    known = rows.decoupled
    fixed = np.where(known, -rows.residual / np.where(known, rows.by_pressure.diagonal(), 1.0), 0.0)
    rhs_u = -residual + operator.T @ fixed
    ones = sp.diags(np.where(known, -unit, 0.0))
    free = sp.diags((~known).astype(float))
    coupled = (sp.diags(s) @ free @ operator).tocsr()
    if rows.symmetric:
        upper = sp.triu(stiffness, format="csr")
        matrix = sp.bmat([[upper, -coupled.T], [None, ones]], format="csr")
        rhs_p = np.where(known, 0.0, -rows.residual * s)
    else:
        by_displacement, by_pressure = free @ rows.by_displacement, free @ rows.by_pressure @ free @ sp.diags(s)
        t = unit / np.maximum(_row_max(by_displacement), _row_max(by_pressure, 0.0))
        matrix = sp.bmat(
            [[stiffness, -coupled.T], [sp.diags(t) @ by_displacement, sp.diags(t) @ by_pressure + ones]], format="csr"
        )
        rhs_p = np.where(known, 0.0, t * (-rows.residual - rows.by_pressure @ fixed))
    solution = direct.solve(store_diagonal(matrix), np.concatenate([rhs_u, rhs_p]), symmetric=rows.symmetric)
    return solution[: len(residual)], np.where(known, fixed, s * solution[len(residual) :])


def _row_max(matrix: Any, empty: float = 1.0) -> NDArray[np.float64]:
    size = np.asarray(abs(matrix).max(axis=1).todense()).ravel()
    return np.where(size > 0.0, size, empty)


def store_diagonal(matrix: Any) -> Any:
    """The same matrix with every diagonal entry stored (PARDISO wants zeros on the diagonal to be present)."""
    n = matrix.shape[0]
    rows = np.repeat(np.arange(n), np.diff(matrix.indptr))
    present = np.zeros(n, dtype=bool)
    present[rows[matrix.indices == rows]] = True
    missing = np.flatnonzero(~present)
    if len(missing):
        coo = matrix.tocoo()
        matrix = sp.csr_matrix(
            (
                np.concatenate([coo.data, np.zeros(len(missing))]),
                (np.concatenate([coo.row, missing]), np.concatenate([coo.col, missing])),
            ),
            shape=matrix.shape,
        )
    matrix.sort_indices()
    return matrix
