"""Direct solution of sparse systems: PARDISO where its wheel is installed, SciPy's SuperLU elsewhere."""

from __future__ import annotations

import functools
import importlib.metadata
import os
import weakref
from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from abut.errors import InputError, SingularModelError
from abut.types import Foreign, Sparse

POSITIVE_DEFINITE, SYMMETRIC_INDEFINITE, UNSYMMETRIC = 2, -2, 11
ACCURATE = 1e-10  # relative residual that a sound factorisation stays below
SINGULAR = 1e-6  # relative residual above which the matrix is taken for singular
# Of PARDISO: own settings (1); nested dissection (2); refinement steps (8); pivots perturbed below 10^-k (10), where
# refinement makes good what a larger perturbation spoils; scaling and matching (11, 13); Bunch-Kaufman pivots, refined (21).
SETTINGS = {1: 1, 2: 2, 8: 10, 10: 8, 11: 1, 13: 1, 18: 0, 21: 3}


@functools.lru_cache(maxsize=1)
def pardiso() -> Foreign:
    """pypardiso's module, or None. Its own search for the library walks the whole environment, so name the file."""
    try:
        for file in importlib.metadata.files("mkl") or ():
            if "mkl_rt" in file.name:
                os.environ.setdefault("PYPARDISO_MKL_RT", str(file.locate()))
                break
        import pypardiso

        pypardiso.PyPardisoSolver()
    except (ImportError, OSError, importlib.metadata.PackageNotFoundError):
        return None
    return pypardiso


def solver_name() -> str:
    """Which library ``solve`` uses here."""
    return "PARDISO" if pardiso() is not None else "SuperLU"


def solve(matrix: Sparse, rhs: NDArray[np.float64], *, symmetric: bool) -> NDArray[np.float64]:
    """Solve matrix x = rhs; ``matrix`` is CSR with its diagonal stored, for ``symmetric`` only its upper triangle.

    Raises SingularModelError where the matrix is singular to working precision.
    """
    size = np.abs(rhs).max(initial=0.0)
    if size == 0.0:
        return np.zeros_like(rhs)
    rhs = rhs / size  # refinement stops on absolute sizes
    if pardiso() is None:
        x = _solve_superlu(matrix, rhs, symmetric)
        error = residual(matrix, x, rhs, symmetric)
    else:
        x = _solve_pardiso(matrix, rhs, symmetric)
        error = residual(matrix, x, rhs, symmetric)
        if symmetric and not error < ACCURATE:
            # The symmetric factorisation pivots only within blocks; the unsymmetric one also before.
            full = (matrix + sp.triu(matrix, 1).T).tocsr()
            x = _solve_pardiso(full, rhs, False)
            error = residual(full, x, rhs, False)
        if not error < ACCURATE:
            # PARDISO perturbs pivots that partial pivoting avoids: SuperLU is slower and sure.
            x = _solve_superlu(matrix, rhs, symmetric)
            error = residual(matrix, x, rhs, symmetric)
    if not error < SINGULAR:
        raise SingularModelError("the equations have no unique solution; check supports, contacts and units")
    return size * x


def factorized(matrix: Sparse, *, definite: bool = False) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    """Factorise a symmetric matrix (CSR, whole) once; returns the solution for one right-hand side or several.

    Raises SingularModelError where the matrix is singular."""
    module = pardiso()
    failures = (RuntimeError,) if module is None else (RuntimeError, module.pardiso_wrapper.PyPardisoError)
    try:
        if module is None:
            return spla.splu(matrix.tocsc()).solve
        solver = module.PyPardisoSolver(mtype=POSITIVE_DEFINITE if definite else SYMMETRIC_INDEFINITE)
        for key, value in {1: 1, 2: 2, 8: 2, 10: 8, 11: int(not definite), 13: int(not definite), 21: 1}.items():
            solver.iparm[key - 1] = value
        half = upper(matrix)
        analyse(solver, half, np.zeros(half.shape[0]))
        solver.set_phase(22)
        solver._call_pardiso(half, np.zeros(half.shape[0]))
    except failures as error:
        raise SingularModelError(f"the direct solver failed ({error}); check supports and contacts") from None

    def solve(b: NDArray[np.float64]) -> NDArray[np.float64]:
        solver.set_phase(33)
        return np.asarray(solver._call_pardiso(half, np.asfortranarray(b)))

    return solve


class Factorization:
    """A matrix (CSR, diagonal stored; of a ``symmetric`` one the upper triangle), factorised for several right-hand sides.

    quick: without refinement wherever the residual is small enough as it is. Refinement goes on to the last digit, and takes
    several times as long as the solution."""

    def __init__(self, matrix: Sparse, *, quick: bool = False, symmetric: bool = True) -> None:
        self._matrix, self._symmetric = matrix, symmetric
        self._refinements = (0, SETTINGS[8]) if quick else (SETTINGS[8],)
        self._solver = None if pardiso() is None else solver_of(symmetric, SETTINGS)
        if self._solver is None:
            return
        weakref.finalize(self, self._solver.free_memory, everything=True)
        self._sound = True
        try:
            analyse(self._solver, matrix, np.zeros(matrix.shape[0]))
            self._solver.set_phase(22)
            self._solver._call_pardiso(matrix, np.zeros(matrix.shape[0]))
        except pardiso().pardiso_wrapper.PyPardisoError:
            self._sound = False

    @property
    def negative(self) -> int | None:
        """How many eigenvalues are negative, by the signs of the pivots; None where these do not tell."""
        if self._solver is None or not self._sound or not self._symmetric:
            return None
        return int(self._solver.iparm[22])

    def solve(self, rhs: NDArray[np.float64]) -> NDArray[np.float64]:
        """As ``solve``, which takes over where the factors are not accurate. Raises SingularModelError."""
        size = np.abs(rhs).max(initial=0.0)
        if self._solver is None or not self._sound or size == 0.0:
            return solve(self._matrix, rhs, symmetric=self._symmetric)
        self._solver.set_phase(33)
        for steps in self._refinements:
            self._solver.iparm[7] = steps
            x: NDArray[np.float64] = self._solver._call_pardiso(self._matrix, rhs / size)
            if residual(self._matrix, x, rhs / size, self._symmetric) < ACCURATE:
                return size * x
        return solve(self._matrix, rhs, symmetric=self._symmetric)


def solver_of(symmetric: bool, settings: dict[int, int]) -> Foreign:
    """PARDISO for one kind of matrix, with settings by their numbers."""
    solver = pardiso().PyPardisoSolver(mtype=SYMMETRIC_INDEFINITE if symmetric else UNSYMMETRIC)
    for key, value in settings.items():
        solver.iparm[key - 1] = value
    return solver


def failures() -> type[Exception]:
    """What PARDISO raises."""
    error: type[Exception] = pardiso().pardiso_wrapper.PyPardisoError
    return error


def analyse(solver: Foreign, matrix: Sparse, b: NDArray[np.float64]) -> None:
    """PARDISO's symbolic phase. Raises InputError where the factors would not fit into memory."""
    solver.set_phase(11)
    solver._call_pardiso(matrix, b)
    needed = 1024.0 * max(solver.iparm[14], int(solver.iparm[15]) + int(solver.iparm[16]))
    available = available_memory()
    if available is not None and needed > available:
        solver.free_memory(everything=True)
        raise InputError(
            f"solve.linear: the direct solver needs about {needed / 1e9:.1f} GB, but {available / 1e9:.1f} GB of memory are "
            'free; choose linear = "amg" (3D, but for mixed tet10), a coarser mesh, or a larger machine'
        )


def available_memory() -> float | None:
    """Bytes that can be had without swapping; None where the system does not say."""
    try:
        with open("/proc/meminfo", encoding="ascii") as lines:
            for line in lines:
                if line.startswith("MemAvailable:"):
                    return 1024.0 * int(line.split()[1])
    except OSError:
        pass
    return None


class PartialFactorization:
    """A symmetric matrix with all but the ``kept`` unknowns eliminated (PARDISO's Schur complement).

    schur: (n_kept, n_kept) dense, what is left of the matrix.
    """

    def __init__(self, matrix: Sparse, kept: NDArray[np.int64]) -> None:
        self._matrix = matrix
        self._solver = pardiso().PyPardisoSolver(mtype=SYMMETRIC_INDEFINITE)
        # Own settings (1), nested dissection (2), no refinement (8: not possible here), Schur complement (36).
        for key, value in {1: 1, 2: 2, 8: 0, 10: 13, 24: 0, 36: 1}.items():
            self._solver.iparm[key - 1] = value
        self._solver.perm = np.zeros(matrix.shape[0], dtype=np.int32)
        self._solver.perm[kept] = 1
        weakref.finalize(self, self._solver.free_memory, everything=True)
        place = np.zeros((len(kept), len(kept)), order="F")
        analyse(self._solver, matrix, place)
        self.schur = self._call(22, place)
        self.sound = self._solver.iparm[13] == 0  # number of perturbed pivots

    def forward(self, b: NDArray[np.float64]) -> NDArray[np.float64]:
        """Eliminate: in the kept unknowns stands what the condensed system takes as right-hand side."""
        return self._call(331, b)

    def backward(self, y: NDArray[np.float64]) -> NDArray[np.float64]:
        """All unknowns from the result of ``forward`` with the kept unknowns replaced by their solution."""
        return self._call(333, y)

    def _call(self, phase: int, b: NDArray[np.float64]) -> NDArray[np.float64]:
        self._solver.set_phase(phase)
        result: NDArray[np.float64] = self._solver._call_pardiso(self._matrix, b)
        return result


def partial_factorization(matrix: Sparse, kept: NDArray[np.int64]) -> PartialFactorization | None:
    """Eliminate all but the ``kept`` unknowns of a matrix given by its upper triangle (CSR, diagonal stored); what is
    eliminated must be positive definite. None where it is singular, or PARDISO is not installed."""
    module = pardiso()
    if module is None:
        return None
    matrix.sort_indices()
    try:
        result = PartialFactorization(matrix, kept)
    except module.pardiso_wrapper.PyPardisoError:
        return None
    return result if result.sound else None


def residual(matrix: Sparse, x: NDArray[np.float64], rhs: NDArray[np.float64], symmetric: bool) -> float:
    """Largest residual over the largest entry of the right-hand side, or componentwise over |A| |x| + |b| where that is
    smaller (a right-hand side at rounding level is met no better)."""

    def product(a: Sparse, v: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(a @ v + a.T @ v - a.diagonal() * v if symmetric else a @ v)

    miss = np.abs(product(matrix, x) - rhs)
    plain = miss.max() / max(np.abs(rhs).max(), 1e-300)
    if plain < ACCURATE:
        return float(plain)
    bound = product(abs(matrix), np.abs(x)) + np.abs(rhs)
    return float(min(plain, (miss / np.maximum(bound, 1e-300)).max()))


def upper(matrix: Sparse) -> Sparse:
    """The upper triangle of a square matrix (CSR), columns in order, diagonal included where it is stored.

    SciPy's triu goes through coordinates, which takes as long as a third of PARDISO's analysis."""
    matrix.sort_indices()
    rows = np.repeat(np.arange(matrix.shape[0], dtype=matrix.indices.dtype), np.diff(matrix.indptr))
    kept = matrix.indices >= rows
    before = np.concatenate([[0], np.cumsum(kept)])  # entries kept up to each
    return sp.csr_matrix(
        (matrix.data[kept], matrix.indices[kept], before[matrix.indptr].astype(matrix.indptr.dtype)), shape=matrix.shape
    )


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


def _solve_pardiso(matrix: Sparse, rhs: NDArray[np.float64], symmetric: bool) -> NDArray[np.float64]:
    solver = solver_of(symmetric, SETTINGS)
    try:
        analyse(solver, matrix, rhs)
        solver.set_phase(23)
        x: NDArray[np.float64] = solver._call_pardiso(matrix, rhs)
    except failures() as error:
        raise SingularModelError(f"the direct solver failed ({error}); check supports, contacts and units") from None
    finally:
        solver.free_memory(everything=True)
    return x


def _solve_superlu(matrix: Sparse, rhs: NDArray[np.float64], symmetric: bool) -> NDArray[np.float64]:
    full = matrix + sp.triu(matrix, 1).T if symmetric else matrix
    try:
        return np.asarray(spla.splu(full.tocsc()).solve(rhs))
    except RuntimeError as error:
        raise SingularModelError(f"the direct solver failed ({error}); check supports, contacts and units") from None
