"""Small displacements leave the stiffness alone: it is eliminated once, down to the multipliers, and every Newton
iteration of every load step solves dense systems of the size of the interface."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.errors import SingularModelError
from abut.linear import direct
from abut.linear.saddle_point import store_diagonal
from abut.problem.contact_pairs import Pair
from abut.problem.system import Laws, Rows, Solve, System, Unknowns, weight

LARGEST = 8000  # multipliers and kept displacements together up to which dense matrices are worth their memory
REFINEMENTS = 2
REPEATED = 1e-11  # singular value over the largest below which rows count as repeating each other
SINGULAR = 1e-6  # relative residual above which a dense system is taken for singular
RANK = 1e-14  # inverse condition below which it is, unless the residual is small beside the right-hand side
FREE = 1e-10  # gap by a unit motion below which rows do not resist it
UNBALANCED = 1e-6  # work of the forces on a motion that nothing resists, over their sum, from which on they move it
PASSES, EVEN = 20, 0.1  # of equilibration, until the logarithm of the largest entries is below the second
NOT_UNIQUE = "the equations have no unique solution; check supports, contacts and units"
UNBALANCED_LOADS = "the loads move a body that nothing holds; check supports, contacts and units"


@dataclass(frozen=True)
class Condensed:
    """A system on the multipliers and the displacements that had to be kept, and the way back to all of them."""

    system: System
    kept: NDArray[np.int64]
    factorization: direct.PartialFactorization
    load: NDArray[np.float64]  # of free displacements, then multipliers, after forward substitution; by history
    whole: System

    def expand(self, state: Unknowns, weights: NDArray[np.float64], laws: Laws) -> Unknowns:
        """All free displacements. Eliminated stiff parts under soft ones lose digits by cancellation: the equations of the
        whole system are met anew by refinement."""
        n = len(self.whole.load)
        inner, load = self.load @ weights, self.whole.load @ weights
        inner[self.kept], inner[n:] = state.displacement, state.pressure
        state = replace(state, displacement=self.factorization.backward(inner)[:n])
        for _ in range(REFINEMENTS):
            p = state.pressure
            miss = load + self.whole.operator.T @ p - self.whole.stiffness @ state.displacement
            inner = self.factorization.forward(np.concatenate([miss, np.zeros(len(p))]))
            linear = laws(self.whole, state)
            opened = [law.residual for law in linear]
            for i, shift in enumerate(self.whole.split(inner[n:])):
                if not linear[i].at_points:  # what those see has been kept
                    opened[i] = opened[i] + linear[i].by_gap @ shift
            rows = replace(self.system.rows(linear), residual=np.concatenate(opened))
            try:
                inner[self.kept], inner[n:] = self.system.step(rows, -inner[self.kept], p, 0.0)
            except SingularModelError:  # laws that have not been met may be too far off to go on from
                return state
            state = replace(
                state,
                displacement=state.displacement + self.factorization.backward(inner)[:n],
                pressure=p + inner[n:],
            )
        return state


@dataclass(frozen=True)
class Flexibility:
    """What the interface gives way under the multipliers.

    factor: Cholesky factor of the condensed stiffness, made regular by ``motions``; motions: (n, m) orthonormal basis of
    the rigid motions that supports leave free; response: (n, n_multipliers) displacement by unit pressures;
    weight: (n_multipliers,) gap of each by a displacement of one; force: sum of the loads;
    redundant: constraints may repeat each other, then the smallest pressure that serves is taken.
    """

    factor: tuple[NDArray[np.float64], bool]
    motions: NDArray[np.float64]
    response: NDArray[np.float64]
    operator: NDArray[np.float64]
    weight: NDArray[np.float64]
    force: float
    redundant: bool

    def step(
        self, rows: Rows, residual: NDArray[np.float64], pressure: NDArray[np.float64], accuracy: float = 0.0
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Solve [K, -B^T; r_u, r_p] (du, dp) = -(residual, r): du = K^-1 (B^T dp - residual) + R a, with R^T of the
        bracket zero, theory (V5), put into the rows of the laws. Motions that the rows leave free stay where they are.

        Raises SingularModelError, also where ``residual`` does work on such motions."""
        known, wanted = rows.decoupled, -rows.residual
        free = np.flatnonzero(~known)
        dp = np.zeros(len(pressure))
        dp[known] = wanted[known] / np.diagonal(rows.by_pressure)[known]
        push = self.operator.T @ dp - residual
        du = scipy.linalg.cho_solve(self.factor, push)
        law = rows.by_displacement[free]
        sizes = np.abs(pressure) + np.abs(dp)
        motions = self._resisted(free, law, push, sizes)
        opened, held = let_go(np.asarray(law @ motions), self.weight[free])
        opened, motions = motions @ opened, motions @ held  # where smooth laws are open, which take no notice of gaps
        n, m = len(free), motions.shape[1]
        matrix = np.zeros((n + m, n + m))
        matrix[:n, :n] = law @ self.response[:, free] + rows.by_pressure[np.ix_(free, free)]
        matrix[:n, n:] = law @ motions
        matrix[n:, :n] = (self.operator[free] @ motions).T
        rhs = np.concatenate([(wanted - rows.by_pressure @ dp)[free] - law @ du, -motions.T @ push])
        solved = solve_dense(matrix, rhs, self.redundant)
        dp[free] = solved[:n]
        self._balance(opened, push + self.operator[free].T @ solved[:n], sizes)
        return du + self.response[:, free] @ solved[:n] + motions @ solved[n:], dp

    def _resisted(
        self, free: NDArray[np.int64], law: Any, push: NDArray[np.float64], pressure: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """A basis of the motions that the rows ``free`` resist, (n, k). push: (n,) forces that they have to balance;
        pressure: (n_multipliers,) sizes, beside which what is left of forces in balance is rounding."""
        if not self.motions.shape[1]:
            return self.motions
        rows = np.concatenate([np.asarray(law @ self.motions), self.operator[free] @ self.motions])
        loose, held = let_go(rows, np.concatenate([self.weight[free]] * 2))
        self._balance(self.motions @ loose, push, pressure)
        return self.motions @ held if loose.shape[1] else self.motions

    def _balance(self, loose: NDArray[np.float64], push: NDArray[np.float64], pressure: NDArray[np.float64]) -> None:
        """Raises SingularModelError where forces do work on motions (n, k) that nothing resists."""
        work = np.abs(loose.T @ push).max(initial=0.0)
        if work > UNBALANCED * (np.abs(push).sum() + self.weight @ pressure + self.force):
            raise SingularModelError(UNBALANCED_LOADS)

    def factorise(self, rows: Rows) -> Solve:
        """The same for rows that are minus the operator's and none of them decoupled: the compliance with what the rows
        add is definite, and the rigid motions are a small Schur complement of it."""
        n, m = len(rows.residual), self.motions.shape[1]
        stiff = -(rows.by_displacement @ self.response + rows.by_pressure)
        moved = self.operator @ self.motions
        size = np.sqrt(np.maximum(np.diagonal(stiff), 1e-300))
        try:
            factor = scipy.linalg.cho_factor(stiff / size[:, None] / size, lower=True, check_finite=False)
        except np.linalg.LinAlgError:  # rows that repeat each other
            return lambda residual, of_law: self.step(replace(rows, residual=of_law), residual, np.zeros(n))

        def inverse(gap: NDArray[np.float64]) -> NDArray[np.float64]:
            scale = size if gap.ndim == 1 else size[:, None]
            x = scipy.linalg.cho_solve(factor, gap / scale, check_finite=False) / scale
            return np.asarray(x + scipy.linalg.cho_solve(factor, (gap - stiff @ x) / scale, check_finite=False) / scale)

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


def condense(system: System, motions: NDArray[np.float64]) -> Condensed | None:
    """The system with all displacements eliminated but those that pairs with a law at the integration points look at, and
    as many as hold the bodies that supports leave free. None where what is left is too large for dense matrices, or no
    solver for it is installed.

    motions: (n_free, m) the rigid motions of bodies that supports leave free.
    """
    n, n_p = len(system.load), system.operator.shape[0]
    kept = _kept(system, motions)
    if not 0 < n_p + len(kept) <= LARGEST or n_p == 0:
        return None
    matrix = sp.bmat([[sp.triu(system.stiffness), -system.operator.T], [None, sp.csr_matrix((n_p, n_p))]], format="csr")
    factorization = direct.partial_factorization(store_diagonal(matrix), np.concatenate([kept, n + np.arange(n_p)]))
    if factorization is None:
        return None
    none = np.zeros(n_p)
    load = np.column_stack([factorization.forward(np.concatenate([own, none])) for own in system.load.T])
    n_u = len(kept)
    schur = factorization.schur
    stiffness, operator, compliance = schur[:n_u, :n_u], -schur[n_u:, :n_u], -schur[n_u:, n_u:]  # theory (V3)
    redundant = any(pair.redundant for pair in system.pairs)
    unit = float(np.median(system.stiffness.diagonal()))
    sizes = system.join([weight(pair) for pair in system.pairs])
    force = float(np.abs(system.load).sum())
    flexibility = _flexibility(stiffness, motions[kept], operator, unit, sizes, force, redundant)
    if flexibility is None:
        return None
    small = replace(
        system,
        stiffness=stiffness,
        load=load[kept],
        pairs=[_restricted(pair, kept) for pair in system.pairs],
        operator=operator,
        step=flexibility.step,
        motions=motions[kept],
        factorise=flexibility.factorise,
        compliance=compliance,
        opening=load[n:],
    )
    return Condensed(small, kept, factorization, load, system)


def _kept(system: System, motions: NDArray[np.float64]) -> NDArray[np.int64]:
    """Numbers of the displacements that stay."""
    m = motions.shape[1]
    holding = scipy.linalg.qr(motions.T, mode="r", pivoting=True)[1][:m] if m else np.zeros(0, dtype=int)
    points = [p.points.operator for p in system.pairs if p.points is not None]
    looked_at = np.flatnonzero(np.diff(sp.vstack(points).tocsc().indptr)) if points else np.zeros(0, dtype=int)
    return np.union1d(holding, looked_at).astype(np.int64)


def _flexibility(
    stiffness: NDArray[np.float64],
    motions: NDArray[np.float64],
    operator: NDArray[np.float64],
    unit: float,
    sizes: NDArray[np.float64],
    force: float,
    redundant: bool,
) -> Flexibility | None:
    basis = np.linalg.svd(motions, full_matrices=False)[0] if motions.size else motions
    try:
        factor = scipy.linalg.cho_factor(stiffness + unit * (basis @ basis.T), lower=True)
    except np.linalg.LinAlgError:
        return None  # a zero-energy motion that is not rigid, as of bodies joined in a hinge
    response = scipy.linalg.cho_solve(factor, operator.T)
    return Flexibility(factor, basis, response, operator, sizes, force, redundant)


def _restricted(pair: Pair, kept: NDArray[np.int64]) -> Pair:
    if pair.points is None:
        return pair
    return replace(pair, points=replace(pair.points, operator=pair.points.operator[:, kept].tocsr()))


def let_go(rows: NDArray[np.float64], weight: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Motions that rows do not resist and those that they do, (m, k) and (m, m - k) orthonormal.

    rows: (n, m) what each gives for unit motions; weight: (n,) for a displacement of one."""
    m = rows.shape[1]
    _, size, basis = np.linalg.svd(np.concatenate([rows / weight[:, None], np.zeros((m, m))]), full_matrices=False)
    none = size <= FREE * max(size.max(initial=0.0), 1.0)
    return basis[none].T, basis[~none].T


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
    own = np.diagonal(size) > 0.0
    rows = np.where(own, 1.0 / np.sqrt(np.where(own, np.diagonal(size), 1.0)), 1.0)
    columns = rows.copy()
    if own.any() and not own.all():
        rows[~own] = 1.0 / _positive((size[~own] * columns)[:, own].max(axis=1))
        columns[~own] = 1.0 / _positive((size[:, ~own] * rows[:, None])[own].max(axis=0))
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
