"""The block system of one Newton iteration: displacements and the pressures of all pairs."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.bordered import widened, with_border
from abut.linear import direct
from abut.linear.foresight import Predict
from abut.linear.repeated import Repeated
from abut.linear.solver import ACCURATE, Solve, Vector
from abut.linear.transposed import by_factors
from abut.problem.linearised import Linearised, Rows
from abut.types import Operator, Sparse


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
    free = (~known).astype(float)
    if rows.symmetric:
        coupled = (sp.diags(s) @ sp.diags(free) @ operator).tocsr()
        rhs_p = np.where(known, 0.0, -rows.residual * s)
        corner = sp.diags(np.where(known, -unit, 0.0)) - sp.diags(soft * s * s)
        return Saddle(coupled, -coupled, corner, rhs_u, rhs_p, True, fixed, known, s)
    by_displacement = scaled(rows.by_displacement.tocsr(), free)
    by_pressure = scaled(rows.by_pressure.tocsr(), free, s * free)
    t = unit / np.maximum(_row_max(by_displacement), _row_max(by_pressure, 0.0))
    rhs_p = np.where(known, 0.0, t * (-rows.residual - rows.by_pressure @ fixed))
    corner = scaled(by_pressure, t) + sp.diags(np.where(known, -unit, 0.0))
    coupled = scaled(operator, s * free)
    return Saddle(coupled, scaled(by_displacement, t), corner, rhs_u, rhs_p, False, fixed, known, s)


def scaled(matrix: Sparse, rows: NDArray[np.float64], columns: NDArray[np.float64] | None = None) -> Sparse:
    """A CSR matrix with its rows and columns multiplied; what becomes zero is kept, so that its pattern lasts."""
    data = matrix.data * np.repeat(rows, np.diff(matrix.indptr))
    if columns is not None:
        data *= columns[matrix.indices]
    return sp.csr_matrix((data, matrix.indices, matrix.indptr), shape=matrix.shape)


def newton_step(
    stiffness: Sparse,
    operator: Sparse,
    rows: Rows,
    residual: NDArray[np.float64],
    pressure: NDArray[np.float64],
    repeated: Repeated | None = None,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Solve [K, -B^T; r_u, r_p] (du, dp) = -(residual, r), theory (V1), and return (du, dp).

    stiffness: (n_u, n_u) sparse, symmetric if the rows are; operator and residual as in ``saddle``; repeated: of the
    systems before it, None where there is none like it."""
    if len(pressure) == 0:
        matrix = direct.upper(stiffness) if rows.symmetric else direct.store_diagonal(stiffness)
        return direct.solve(matrix, -residual, symmetric=rows.symmetric), pressure
    s = saddle(np.median(stiffness.diagonal()), operator, rows, residual)
    matrix, rhs = _whole(stiffness, s), np.concatenate([s.rhs_u, s.rhs_p])
    if repeated is None:
        solution = direct.solve(direct.store_diagonal(matrix), rhs, symmetric=s.symmetric)
    else:
        solution = repeated.solve(matrix, rhs, symmetric=s.symmetric)
    return solution[: len(residual)], s.pressure(solution[len(residual) :])


def factorise(stiffness: Sparse, operator: Sparse, rows: Rows) -> Solve:
    """The same for several right-hand sides (residual of equilibrium, residual of the law) with one factorisation; of
    symmetric rows."""
    unit, n = np.median(stiffness.diagonal()), stiffness.shape[0]
    factors = direct.Factorization(direct.store_diagonal(_whole(stiffness, saddle(unit, operator, rows, np.zeros(n)))))

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
    repeated: Repeated = field(default_factory=Repeated)

    def solve(self, rows: Rows, residual: Vector, pressure: Vector, accuracy: float) -> tuple[Vector, Vector]:
        """One Newton system solved, as in ``Prepared``."""
        stiffness, operator, rows, more = _with_border(self.system.stiffness, self.system.columns, rows)
        residual, n = np.concatenate([residual, np.zeros(more)]), len(residual)
        if self.system.about is not None and len(pressure) == 0:
            symmetric = self.system.symmetric
            matrix = direct.upper(stiffness) if symmetric else stiffness
            return self.repeated.solve(matrix, -residual, symmetric=symmetric)[:n], pressure
        repeated = None if self.system.about is None else self.repeated
        du, dp = newton_step(stiffness, operator, rows, residual, pressure, repeated)
        return du[:n], dp

    def transposed(self, rows: Rows, force: Vector, gap: Vector, accuracy: float) -> tuple[Vector, Vector]:
        """The transposed system solved, as in ``Transposable``."""
        return by_factors(self.system, rows, force, gap)

    def factorise(self, rows: Rows) -> Solve:
        """Factors of the rows, for several right-hand sides, as in ``Prepared``."""
        stiffness, operator, rows, more = _with_border(self.system.stiffness, self.system.operator, rows)
        factors = factorise(stiffness, operator, rows)

        def solve(residual: Vector, of_law: Vector) -> tuple[Vector, Vector]:
            du, dp = factors(np.concatenate([residual, np.zeros(more)]), of_law)
            return du[: len(residual)], dp

        return solve if more else factors

    def respond(self, force: Vector, springs: Vector) -> Vector:
        """Displacements by forces, without contact, as in ``Prepared``."""
        sprung, more = with_border(self.system.stiffness + sp.diags(springs))
        factors = direct.Factorization(direct.store_diagonal(direct.upper(sprung)))
        return factors.solve(np.concatenate([force, np.zeros(more)]))[: len(force)]

    def foresee(
        self, gap: Vector, pressure: Vector, active: NDArray[np.bool_], tied: NDArray[np.bool_]
    ) -> NDArray[np.bool_]:
        """The next active set, predicted, as in ``Prepared``."""
        return self.predict(gap, pressure, active, tied)


def _with_border(stiffness: Operator, operator: Sparse, rows: Rows) -> tuple[Sparse, Sparse, Rows, int]:
    """With the unknowns that border the stiffness among those of displacements, and how many they are."""
    whole, more = with_border(stiffness)
    if not more:
        return whole, operator, rows, 0
    by_displacement = widened(sp.csr_matrix(rows.by_displacement), more)
    return whole, widened(operator, more), replace(rows, by_displacement=by_displacement), more


def _whole(stiffness: Sparse, s: Saddle) -> Sparse:
    """The matrix, only its upper triangle where it is symmetric."""
    if s.symmetric:
        upper = direct.upper(stiffness)
        return sp.bmat([[upper, -s.coupled.T], [None, s.corner]], format="csr")
    columns = s.coupled.T.tocsr()
    above = _beside(stiffness, scaled(columns, np.full(columns.shape[0], -1.0)))
    return sp.vstack([above, _beside(s.lower, s.corner.tocsr())], format="csr")


def _beside(left: Sparse, right: Sparse) -> Sparse:
    """Two CSR matrices side by side, entries that are zero included."""
    count, more = np.diff(left.indptr), np.diff(right.indptr)
    of_left = np.arange(left.nnz) + np.repeat(right.indptr[:-1], count)
    of_right = np.arange(right.nnz) + np.repeat(left.indptr[1:], more)
    data, indices = np.empty(left.nnz + right.nnz), np.empty(left.nnz + right.nnz, dtype=np.int32)
    data[of_left], data[of_right] = left.data, right.data
    indices[of_left], indices[of_right] = left.indices, right.indices + left.shape[1]
    shape = left.shape[0], left.shape[1] + right.shape[1]
    return sp.csr_matrix((data, indices, left.indptr + right.indptr), shape=shape)


def _row_max(matrix: Sparse, empty: float = 1.0) -> NDArray[np.float64]:
    """Largest size of an entry of each row; ``empty`` where all are zero."""
    size, filled = np.zeros(matrix.shape[0]), np.diff(matrix.indptr) > 0
    if matrix.nnz:
        size[filled] = np.maximum.reduceat(np.abs(matrix.data), matrix.indptr[:-1][filled])
    return np.where(size > 0.0, size, empty)
