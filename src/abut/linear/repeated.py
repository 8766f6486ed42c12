"""Direct solution of systems that resemble each other, as those of Newton's method do, one after the other."""

from __future__ import annotations

import weakref

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut._core import joined_pattern, values_in
from abut.linear import direct
from abut.linear.krylov import fgmres
from abut.types import Foreign, Sparse

EXACT = 1e-12  # reduction of the residual that stands for an exact solution
# Entries of the factors by row, for every iteration with old factors that half a factorisation would pay for.
WORTH = 36.0
FEW = 9  # such iterations, below which old factors are not tried; as many are spent to spare an analysis
LOST = 0.01  # share of the entries that have no place in the pattern, above which it is made anew
ROOM = 1.05  # growth of a pattern by entries that others had, up to which they are kept
SMALL = 200_000  # entries up to which minimum degree fills less than nested dissection
Vector = NDArray[np.float64]


class Repeated:
    """The factors of the last matrix that was factorised, and the pattern it was analysed with.

    A system is solved with these factors as preconditioner where that takes much less than a factorisation, else by new
    factors with the old analysis where all its entries have a place in it, else from scratch. All three are checked by the
    residual."""

    def __init__(self) -> None:
        self._solver: Foreign = None
        self._factorised: Sparse | None = None
        self._symmetric = False
        self.analyses = self.factorisations = 0

    def solve(self, matrix: Sparse, rhs: Vector, *, symmetric: bool) -> Vector:
        """As ``direct.solve``, which takes over where this one is not accurate. Raises SingularModelError."""
        size = np.abs(rhs).max(initial=0.0)
        if direct.pardiso() is None or size == 0.0:
            return direct.solve(direct.store_diagonal(matrix), rhs, symmetric=symmetric)
        matrix.sort_indices()
        if self._factorised is None or self._factorised.shape != matrix.shape or self._symmetric != symmetric:
            self._forget()
        self._symmetric = symmetric
        for attempt in (self._by_old_factors, self._by_old_analysis, self._from_scratch):
            x = attempt(matrix, rhs / size)
            if x is not None and direct.residual(matrix, x, rhs / size, symmetric) < direct.ACCURATE:
                return size * x
        self._forget()
        return direct.solve(direct.store_diagonal(matrix), rhs, symmetric=symmetric)

    def _by_old_factors(self, matrix: Sparse, rhs: Vector) -> Vector | None:
        """Where it pays, and as long as it is on course."""
        limit = self._limit
        return self._iterate(matrix, rhs, limit) if limit >= FEW else None

    def _by_old_analysis(self, matrix: Sparse, rhs: Vector) -> Vector | None:
        """Entries without a place in the pattern are left out of the factors: facets that have just met share little."""
        if self._factorised is None:
            return None
        pattern = self._factorised
        values, lost = values_in(pattern.indptr, pattern.indices, matrix.indptr, matrix.indices, matrix.data)
        if lost > LOST * matrix.nnz:
            return None
        self._factorised = None
        if not self._factorise(sp.csr_matrix((values, pattern.indices, pattern.indptr), shape=matrix.shape)):
            return None
        return (
            self._substitute(rhs, direct.SETTINGS[8]) if not lost else self._iterate(matrix, rhs, max(self._limit, FEW))
        )

    @property
    def _limit(self) -> int:
        """Iterations that half a factorisation would pay for."""
        if self._factorised is None:
            return 0
        return int(self._solver.iparm[17] / (WORTH * self._factorised.shape[0]))

    def _iterate(self, matrix: Sparse, rhs: Vector, limit: int) -> Vector | None:
        """Flexible GMRES with the factors there are; None where a third of the iterations show that they are not enough."""
        diagonal = matrix.diagonal() if self._symmetric else None

        def multiply(v: Vector) -> Vector:
            return np.asarray(matrix @ v if diagonal is None else matrix @ v + matrix.T @ v - diagonal * v)

        size, first = float(np.linalg.norm(rhs)), limit // 3
        x, _, done = fgmres(multiply, lambda r: self._substitute(r, 0), rhs, EXACT, first, 1)
        if done:
            return x
        left = rhs - multiply(x)
        reached = float(np.linalg.norm(left)) / size
        if not reached < EXACT ** (first / limit):
            return None
        more, _, _ = fgmres(multiply, lambda r: self._substitute(r, 0), left, EXACT / reached, limit - first, 1)
        return x + more

    def _from_scratch(self, matrix: Sparse, rhs: Vector) -> Vector | None:
        whole = _grown(direct.store_diagonal(matrix), self._factorised)
        self._forget()
        # The analysis also scales and permutes by the values, which symmetric matrices can do without.
        settings = direct.SETTINGS | {18: -1} | ({11: 0, 13: 0} if self._symmetric else {})
        if matrix.nnz <= SMALL:
            settings |= {2: 0}
        self._solver = direct.solver_of(self._symmetric, settings)
        weakref.finalize(self, self._solver.free_memory, everything=True)
        self.analyses += 1
        try:
            direct.analyse(self._solver, whole, np.zeros(len(rhs)))
        except direct.failures():
            return None
        return self._substitute(rhs, direct.SETTINGS[8]) if self._factorise(whole) else None

    def _factorise(self, matrix: Sparse) -> bool:
        """Whether there are new factors."""
        self.factorisations += 1
        try:
            self._solver.set_phase(22)
            self._solver._call_pardiso(matrix, np.zeros(matrix.shape[0]))
        except direct.failures():
            return False
        self._factorised = matrix
        return True

    def _substitute(self, rhs: Vector, refinements: int) -> Vector:
        self._solver.iparm[7] = refinements
        self._solver.set_phase(33)
        return np.asarray(self._solver._call_pardiso(self._factorised, rhs))

    def _forget(self) -> None:
        if self._solver is not None:
            self._solver.free_memory(everything=True)
        self._solver, self._factorised = None, None


def _grown(matrix: Sparse, before: Sparse | None) -> Sparse:
    """With the entries that another matrix has, as zeros, where they are few: they are likely to come back."""
    if before is None:
        return matrix
    indptr, indices = joined_pattern(matrix.indptr, matrix.indices, before.indptr, before.indices)
    if len(indices) > ROOM * matrix.nnz:
        return matrix
    values, _ = values_in(indptr, indices, matrix.indptr, matrix.indices, matrix.data)
    return sp.csr_matrix((values, indices, indptr), shape=matrix.shape)
