"""The block system of one Newton iteration: displacements and the pressures of all pairs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.interface.laws import Linearisation
from abut.solvers import direct


def newton_step(
    stiffness: Any,
    operator: Any,
    laws: Sequence[Linearisation],
    residual: NDArray[np.float64],
    pressure: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Solve [K, -B^T; r_u, r_p] (du, dp) = -(residual, r) and return (du, dp).

    stiffness: (n_u, n_u) sparse symmetric; operator B: (n, n_u), all pairs stacked; residual: K u - B^T p - f.
    """
    law_residual = np.concatenate([law.residual for law in laws]) if laws else np.zeros(0)
    if all(law.symmetric for law in laws):
        return _symmetric_step(stiffness, operator, laws, residual, law_residual, pressure)
    # Rows and pressures are scaled so that all blocks have entries of one size: dp = s q, law rows times t.
    unit = np.median(stiffness.diagonal())
    by_displacement = sp.vstack([law.by_displacement for law in laws]).tocsr()
    by_pressure = sp.block_diag([law.by_pressure for law in laws]).tocsr()
    s = unit / _row_max(operator)
    rows = np.maximum(_row_max(by_displacement), _row_max(by_pressure @ sp.diags(s)))
    t = sp.diags(unit / rows)
    matrix = sp.bmat(
        [[stiffness, -(operator.T @ sp.diags(s))], [t @ by_displacement, t @ by_pressure @ sp.diags(s)]], format="csr"
    )
    rhs = -np.concatenate([residual, t @ law_residual])
    solution = direct.solve(_store_diagonal(matrix), rhs, symmetric=False)
    return solution[: len(residual)], s * solution[len(residual) :]


def _symmetric_step(
    stiffness: Any,
    operator: Any,
    laws: Sequence[Linearisation],
    residual: NDArray[np.float64],
    law_residual: NDArray[np.float64],
    pressure: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Inactive pressures drop to zero at once; what is left is symmetric indefinite."""
    n = len(pressure)
    active = np.concatenate([law.active for law in laws]) if laws else np.zeros(0, dtype=bool)
    drop = np.where(active, 0.0, -pressure)
    rhs_u = -residual + operator.T @ drop
    upper = sp.triu(stiffness, format="csr")
    if n == 0:
        return direct.solve(upper, rhs_u, symmetric=True), np.zeros(0)
    couple = operator.copy()
    couple.data = couple.data * np.repeat(-active.astype(float), np.diff(couple.indptr))
    # Pressures are scaled so that both blocks have entries of one size: dp = s q.
    unit = np.median(stiffness.diagonal())
    s = unit / _row_max(operator)
    couple = (sp.diags(s) @ couple).tocsr()
    diagonal = sp.csr_matrix((np.where(active, 0.0, -unit), np.arange(n), np.arange(n + 1)), shape=(n, n))
    matrix = sp.bmat([[upper, couple.T], [None, diagonal]], format="csr")
    matrix = _store_diagonal(matrix)
    rhs_p = np.where(active, -law_residual * s, 0.0)
    solution = direct.solve(matrix, np.concatenate([rhs_u, rhs_p]), symmetric=True)
    step, q = solution[: len(residual)], solution[len(residual) :]
    return step, np.where(active, s * q, drop)


def _row_max(matrix: Any) -> NDArray[np.float64]:
    size = np.asarray(abs(matrix).max(axis=1).todense()).ravel()
    return np.where(size > 0.0, size, 1.0)


def _store_diagonal(matrix: Any) -> Any:
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
