"""Dense systems of the size of the interface, which every Newton iteration solves after static condensation."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from abut.errors import SingularModelError
from abut.linear.foresight import Predict, foresight
from abut.linear.schur_preconditioner import half_spaces, interfaces
from abut.linear.solver import ACCURATE, Solve, Vector
from abut.linear.transposed import coupled, dense_matrix
from abut.problem.linearised import Linearised, Rows
from abut.types import Array

REPEATED = 1e-11  # singular value over the largest below which rows count as repeating each other
SINGULAR = 1e-6  # relative residual above which a dense system is taken for singular
RANK = 1e-14  # inverse condition below which it is, unless the residual is small beside the right-hand side
FREE = 1e-10  # gap by a unit motion below which rows do not resist it
UNBALANCED = 1e-6  # work of the forces on a motion that nothing resists, over their sum, from which on they move it
PASSES, EVEN = 20, 0.1  # of equilibration, until the logarithm of the largest entries is below the second
NOT_UNIQUE = "the equations have no unique solution; check supports, contacts and units"
UNBALANCED_LOADS = "the loads act on an unconstrained rigid-body mode; check supports, contacts and units"


@dataclass(frozen=True)
class Dense:
    """As ``abut.linear.solver.Prepared``, of a condensed problem. predict: as ``foresee``."""

    system: Linearised
    flexibility: Flexibility
    predict: Predict
    exact: bool = True
    accurate: float = ACCURATE

    def solve(self, rows: Rows, residual: Vector, pressure: Vector, accuracy: float) -> tuple[Vector, Vector]:
        """One Newton system solved, as in ``Prepared``."""
        return self.flexibility.step(rows, residual, pressure, float(np.abs(self.system.forces).sum()))

    def transposed(self, rows: Rows, force: Vector, gap: Vector, accuracy: float) -> tuple[Vector, Vector]:
        """The transposed system solved, as in ``Transposable``, in the unknowns of the condensed problem."""
        part, n = coupled(self.system, rows), len(force)
        rhs = np.concatenate([force, gap[part.chosen]])
        x = solve_dense(dense_matrix(self.system, part), rhs, self.flexibility.redundant)
        return x[:n], part.complete(self.system, rows, x[:n], x[n:], gap)

    def factorise(self, rows: Rows) -> Solve:
        """Factors of the rows, for several right-hand sides, as in ``Prepared``."""
        return self.flexibility.factorise(rows, float(np.abs(self.system.forces).sum()))

    def respond(self, force: Vector, springs: Vector) -> Vector:
        """Displacements by forces, without contact, as in ``Prepared``."""
        return np.asarray(np.linalg.solve(self.system.stiffness + np.diag(springs), force)) if len(force) else force

    def foresee(
        self, gap: Vector, pressure: Vector, active: NDArray[np.bool_], tied: NDArray[np.bool_]
    ) -> NDArray[np.bool_]:
        """The next active set, predicted, as in ``Prepared``."""
        return self.predict(gap, pressure, active, tied)


def dense(system: Linearised) -> Dense:
    """A solver for the linearised problem of a ``CondensedProblem``."""
    pairs = system.pairs
    predict = foresight(lambda: half_spaces(interfaces(pairs)), np.asarray(system.operator @ system.motions))
    return Dense(system, _flexibility(system), predict)


@dataclass(frozen=True)
class Flexibility:
    """Displacements of the interface under the multipliers.

    factor: Cholesky factor of the condensed stiffness, made regular by ``motions``; motions: (n, m) orthonormal basis of
    the rigid motions that supports leave free; response: (n, n_multipliers) displacement by unit pressures;
    weight: (n_multipliers,) gap of each by a displacement of one;
    redundant: constraints may repeat each other, then the smallest pressure that serves is taken.
    """

    factor: tuple[NDArray[np.float64], bool]
    motions: NDArray[np.float64]
    response: NDArray[np.float64]
    operator: NDArray[np.float64]
    weight: NDArray[np.float64]
    redundant: bool

    def step(
        self, rows: Rows, residual: NDArray[np.float64], pressure: NDArray[np.float64], force: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Solve [K, -B^T; r_u, r_p] (du, dp) = -(residual, r): du = K^-1 (B^T dp - residual) + R a, with R^T of the
        bracket zero, theory (V5), put into the rows of the laws. Motions that the rows leave free stay where they are.
        force: sum of the loads, beside which what is left of forces in balance is rounding.

        Raises SingularModelError, also where ``residual`` does work on such motions."""
        known, wanted = rows.decoupled, -rows.residual
        free = np.flatnonzero(~known)
        dp = np.zeros(len(pressure))
        dp[known] = wanted[known] / np.diagonal(rows.by_pressure)[known]
        push = self.operator.T @ dp - residual
        du = scipy.linalg.cho_solve(self.factor, push)
        law = rows.by_displacement[free]
        size = self.weight @ (np.abs(pressure) + np.abs(dp)) + force
        motions = self._resisted(free, law, push, size)
        opened, resisted = let_go(np.asarray(law @ motions), self.weight[free])
        opened, motions = (
            motions @ opened,
            motions @ resisted,
        )  # where smooth laws are open, which take no notice of gaps
        n, m = len(free), motions.shape[1]
        matrix = np.zeros((n + m, n + m))
        matrix[:n, :n] = law @ self.response[:, free] + rows.by_pressure[np.ix_(free, free)]
        matrix[:n, n:] = law @ motions
        matrix[n:, :n] = (self.operator[free] @ motions).T
        rhs = np.concatenate([(wanted - rows.by_pressure @ dp)[free] - law @ du, -motions.T @ push])
        solved = solve_dense(matrix, rhs, self.redundant)
        dp[free] = solved[:n]
        _balance(opened, push + self.operator[free].T @ solved[:n], size)
        return du + self.response[:, free] @ solved[:n] + motions @ solved[n:], dp

    def _resisted(
        self, free: NDArray[np.int64], law: Array, push: NDArray[np.float64], force: float
    ) -> NDArray[np.float64]:
        """A basis of the motions that the rows ``free`` resist, (n, k). push: (n,) forces that they have to balance;
        force: sum of all others, beside which what is left of forces in balance is rounding."""
        if not self.motions.shape[1]:
            return self.motions
        rows = np.concatenate([np.asarray(law @ self.motions), self.operator[free] @ self.motions])
        unconstrained, resisted = let_go(rows, np.concatenate([self.weight[free]] * 2))
        _balance(self.motions @ unconstrained, push, force)
        return self.motions @ resisted if unconstrained.shape[1] else self.motions

    def factorise(self, rows: Rows, force: float) -> Solve:
        """The same for rows that are minus the operator's and none of them decoupled: the compliance with what the rows
        add is definite, and the rigid motions are a small Schur complement of it."""
        n, m = len(rows.residual), self.motions.shape[1]
        stiff = -(rows.by_displacement @ self.response + rows.by_pressure)
        moved = self.operator @ self.motions
        size = np.sqrt(np.maximum(np.diagonal(stiff), 1e-300))
        try:
            factor = scipy.linalg.cho_factor(stiff / size[:, None] / size, lower=True, check_finite=False)
        except np.linalg.LinAlgError:  # rows that repeat each other
            return lambda residual, of_law: self.step(replace(rows, residual=of_law), residual, np.zeros(n), force)

        def inverse(gap: NDArray[np.float64]) -> NDArray[np.float64]:
            scale = size if gap.ndim == 1 else size[:, None]
            return np.asarray(scipy.linalg.cho_solve(factor, gap / scale, check_finite=False) / scale)

        by_motions = inverse(moved)
        small = moved.T @ by_motions
        root = np.sqrt(
            np.maximum(np.diagonal(small), 1e-300)
        )  # a loose body's rows yield much more than a pressed one's
        small = small / root[:, None] / root

        def solve(
            residual: NDArray[np.float64], of_law: NDArray[np.float64]
        ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
            du = scipy.linalg.cho_solve(self.factor, -residual)
            dp = inverse(of_law + rows.by_displacement @ du)
            if m:
                force = (moved.T @ dp - self.motions.T @ residual) / root
                shift = np.linalg.lstsq(small, force, rcond=REPEATED)[0] / root
                dp, du = dp - by_motions @ shift, du + self.motions @ shift
            return du + self.response @ dp, dp

        return solve


def _flexibility(system: Linearised) -> Flexibility:
    factor, basis = cholesky(system.stiffness, system.motions, system.unit)
    response = scipy.linalg.cho_solve(factor, system.operator.T)
    redundant = any(pair.redundant for pair in system.pairs)
    return Flexibility(factor, basis, response, system.operator, system.weight, redundant)


def cholesky(
    stiffness: NDArray[np.float64], motions: NDArray[np.float64], unit: float
) -> tuple[tuple[NDArray[np.float64], bool], NDArray[np.float64]]:
    """Cholesky factor of the condensed stiffness with rigid motions held, and an orthonormal basis of these. Raises
    LinAlgError."""
    basis = np.linalg.svd(motions, full_matrices=False)[0] if motions.size else motions
    return scipy.linalg.cho_factor(stiffness + unit * (basis @ basis.T), lower=True), basis


def let_go(rows: NDArray[np.float64], weight: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Motions that rows do not resist and those that they do, (m, k) and (m, m - k) orthonormal.

    rows: (n, m) what each gives for unit motions; weight: (n,) for a displacement of one."""
    m = rows.shape[1]
    _, size, basis = np.linalg.svd(np.concatenate([rows / weight[:, None], np.zeros((m, m))]), full_matrices=False)
    none = size <= FREE * max(size.max(initial=0.0), 1.0)
    return basis[none].T, basis[~none].T


def _balance(unconstrained: NDArray[np.float64], push: NDArray[np.float64], force: float) -> None:
    """Raises SingularModelError where forces (n,) do work on motions (n, k) that nothing resists. force: sum of all others,
    beside which what is left of forces in balance is rounding."""
    work = np.abs(unconstrained.T @ push).max(initial=0.0)
    if work > UNBALANCED * (np.abs(push).sum() + force):
        raise SingularModelError(UNBALANCED_LOADS)


def solve_dense(matrix: NDArray[np.float64], rhs: NDArray[np.float64], redundant: bool) -> NDArray[np.float64]:
    """LU of the equilibrated matrix, refined; least squares where rows may repeat each other.

    matrix: (n, n); rhs: (n,). The solution is that of a system that differs from this one by rounding (residuals beside
    |A| |x| + |b|) and whose matrix is regular; else the smallest one. Raises SingularModelError where that misses b."""
    if not len(rhs):
        return rhs
    rows, columns = _equilibrate(matrix)
    scaled, b = rows[:, None] * matrix * columns, rows * rhs
    if not np.isfinite(scaled).all():
        raise SingularModelError(NOT_UNIQUE)
    if redundant:
        return np.asarray(columns * np.linalg.lstsq(scaled, b, rcond=REPEATED)[0])
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore", scipy.linalg.LinAlgWarning)  # what follows tells
        factor = scipy.linalg.lu_factor(scaled, check_finite=False)
        x = scipy.linalg.lu_solve(factor, b, check_finite=False)
        x = x + scipy.linalg.lu_solve(factor, b - scaled @ x, check_finite=False)
        miss = np.abs(scaled @ x - b)
        if miss.max() <= SINGULAR * np.abs(b).max():
            return np.asarray(columns * x)
        backward = (miss / np.maximum(np.abs(scaled) @ np.abs(x) + np.abs(b), 1e-300)).max()
        regular = scipy.linalg.lapack.dgecon(factor[0], np.abs(scaled).sum(axis=0).max())[0] > RANK
    if not (backward <= SINGULAR and regular):
        # What nothing resists, and nothing moves, stays where it is; by QR, an SVD of a large matrix takes for ever.
        x = scipy.linalg.lstsq(scaled, b, cond=RANK, lapack_driver="gelsy", check_finite=False)[0]
        if not np.abs(scaled @ x - b).max() <= SINGULAR * np.abs(b).max():
            raise SingularModelError(NOT_UNIQUE)
    return np.asarray(columns * x)


def _equilibrate(matrix: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Factors of rows and columns, (n,) each, with which the largest entry of each is one, but for ``EVEN`` (Ruiz 2001).

    First of all diagonal entries become one, and rows and columns without (motions) follow: else entries of one block
    (gaps by motions) may be even by themselves and leave another (gaps by pressures) as far below as the units put it."""
    size = np.abs(matrix)
    used = np.diagonal(size) > 0.0
    rows = np.where(used, 1.0 / np.sqrt(np.where(used, np.diagonal(size), 1.0)), 1.0)
    columns = rows.copy()
    if used.any() and not used.all():
        rows[~used] = 1.0 / _positive((size[~used] * columns)[:, used].max(axis=1))
        columns[~used] = 1.0 / _positive((size[:, ~used] * rows[:, None])[used].max(axis=0))
    size *= rows[:, None]
    size *= columns
    for _ in range(PASSES):
        of_rows, of_columns = _positive(size.max(axis=1)), _positive(size.max(axis=0))
        if max(np.abs(np.log(of_rows)).max(), np.abs(np.log(of_columns)).max()) < EVEN:
            break
        by_rows, by_columns = 1.0 / np.sqrt(of_rows), 1.0 / np.sqrt(of_columns)
        size *= by_rows[:, None]
        size *= by_columns
        rows *= by_rows
        columns *= by_columns
    return rows, columns


def _positive(sizes: NDArray[np.float64]) -> NDArray[np.float64]:
    """One for zero."""
    return np.where(sizes > 0.0, sizes, 1.0)
