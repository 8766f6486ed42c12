"""The block system of one Newton iteration: displacements and the pressures of all pairs."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.linear import direct
from abut.linear.schur_preconditioner import Predict
from abut.linear.solver import ACCURATE, Solve, Vector
from abut.problem.linearised import Linearised, Rows
from abut.types import Sparse


@dataclass(frozen=True)
class Saddle:
    """[K, -coupled^T; lower, corner] (du, q) = (rhs_u, rhs_p), theory (V1), scaled so that all blocks have entries of one
    size, theory (V2). ``symmetric``: lower is -coupled, and corner diagonal. Pressures that nothing couples are known at
    once: their rows and columns hold nothing but the diagonal."""

    coupled: Sparse
    lower: Sparse
    corner: Sparse
    rhs_u: NDArray[np.float64]
    rhs_p: NDArray[np.float64]
    symmetric: bool
    fixed: NDArray[np.float64]
    known: NDArray[np.bool_]
    scale: NDArray[np.float64]

    def pressure(self, q: NDArray[np.float64]) -> NDArray[np.float64]:
        """Change of the pressures by the scaled unknowns."""
        return np.where(self.known, self.fixed, self.scale * q)


def saddle(unit: float, operator: Sparse, rows: Rows, residual: NDArray[np.float64]) -> Saddle:
    """What stands beside the stiffness. unit: size of its entries; operator B: (n, n_u), all pairs stacked, whose
    transpose gives forces; residual: K u - B^T p - f."""
    known, fixed = rows.decoupled, rows.fixed
    s = unit / _row_max(operator)
    soft = np.where(known, 0.0, -rows.by_pressure.diagonal()) if rows.symmetric else np.zeros(len(s))
    s = np.where(soft > 0.0, 1.0 / np.sqrt(s**-2 + soft / unit), s)
    rhs_u = -residual + operator.T @ fixed
    ones = sp.diags(np.where(known, -unit, 0.0))
    free = sp.diags((~known).astype(float))
    coupled = (sp.diags(s) @ free @ operator).tocsr()
    if rows.symmetric:
        rhs_p = np.where(known, 0.0, -rows.residual * s)
        return Saddle(coupled, -coupled, ones - sp.diags(soft * s * s), rhs_u, rhs_p, True, fixed, known, s)
    by_displacement, by_pressure = free @ rows.by_displacement, free @ rows.by_pressure @ free @ sp.diags(s)
    t = unit / np.maximum(_row_max(by_displacement), _row_max(by_pressure, 0.0))
    rhs_p = np.where(known, 0.0, t * (-rows.residual - rows.by_pressure @ fixed))
    lower, corner = sp.diags(t) @ by_displacement, sp.diags(t) @ by_pressure + ones
    return Saddle(coupled, lower, corner, rhs_u, rhs_p, False, fixed, known, s)


def newton_step(
    stiffness: Sparse,
    operator: Sparse,
    rows: Rows,
    residual: NDArray[np.float64],
    pressure: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Solve [K, -B^T; r_u, r_p] (du, dp) = -(residual, r), theory (V1), and return (du, dp).

    stiffness: (n_u, n_u) sparse, symmetric if the rows are; operator and residual as in ``saddle``."""
    if len(pressure) == 0:
        matrix = sp.triu(stiffness, format="csr") if rows.symmetric else store_diagonal(stiffness)
        return direct.solve(matrix, -residual, symmetric=rows.symmetric), pressure
    s = saddle(np.median(stiffness.diagonal()), operator, rows, residual)
    matrix = _whole(stiffness, s)
    solution = direct.solve(matrix, np.concatenate([s.rhs_u, s.rhs_p]), symmetric=s.symmetric)
    return solution[: len(residual)], s.pressure(solution[len(residual) :])


def factorise(stiffness: Sparse, operator: Sparse, rows: Rows) -> Solve:
    """The same for several right-hand sides (residual of equilibrium, residual of the law) with one factorisation; of
    symmetric rows."""
    unit, n = np.median(stiffness.diagonal()), stiffness.shape[0]
    factors = direct.Factorization(_whole(stiffness, saddle(unit, operator, rows, np.zeros(n))))

    def solve(
        residual: NDArray[np.float64], of_law: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        s = saddle(unit, operator, replace(rows, residual=of_law), residual)
        solution = factors.solve(np.concatenate([s.rhs_u, s.rhs_p]))
        return solution[:n], s.pressure(solution[n:])

    return solve


@dataclass(frozen=True)
class SaddlePoint:
    """As ``abut.linear.solver.Prepared``: the whole system factorised anew for every set of rows. predict: as
    ``foresee``; repeated: where a finite deformation changes the values of the stiffness only."""

    system: Linearised
    predict: Predict
    exact: bool = True
    accurate: float = ACCURATE
    repeated: direct.Repeated = field(default_factory=direct.Repeated)

    def solve(self, rows: Rows, residual: Vector, pressure: Vector, accuracy: float) -> tuple[Vector, Vector]:
        """As in ``Prepared``."""
        if self.system.about is not None and len(pressure) == 0:
            symmetric, matrix = self.system.symmetric, self.system.stiffness
            matrix = store_diagonal(sp.triu(matrix, format="csr") if symmetric else matrix)
            return self.repeated.solve(matrix, -residual, symmetric=symmetric), pressure
        return newton_step(self.system.stiffness, self.system.columns, rows, residual, pressure)

    def factorise(self, rows: Rows) -> Solve:
        """As in ``Prepared``."""
        return factorise(self.system.stiffness, self.system.operator, rows)

    def respond(self, force: Vector, springs: Vector) -> Vector:
        """As in ``Prepared``."""
        sprung = self.system.stiffness + sp.diags(springs)
        return direct.Factorization(store_diagonal(sp.triu(sprung, format="csr"))).solve(force)

    def foresee(
        self, gap: Vector, pressure: Vector, active: NDArray[np.bool_], tied: NDArray[np.bool_]
    ) -> NDArray[np.bool_]:
        """As in ``Prepared``."""
        return self.predict(gap, pressure, active, tied)


def _whole(stiffness: Sparse, s: Saddle) -> Sparse:
    """The matrix, only its upper triangle where it is symmetric."""
    if s.symmetric:
        upper = sp.triu(stiffness, format="csr")
        return store_diagonal(sp.bmat([[upper, -s.coupled.T], [None, s.corner]], format="csr"))
    return store_diagonal(sp.bmat([[stiffness, -s.coupled.T], [s.lower, s.corner]], format="csr"))


def _row_max(matrix: Sparse, empty: float = 1.0) -> NDArray[np.float64]:
    size = np.asarray(abs(matrix).max(axis=1).todense()).ravel()
    return np.where(size > 0.0, size, empty)


def store_diagonal(matrix: Sparse) -> Sparse:
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
