"""Factorisation of the whole matrix of displacements and pressures by PETSc, analysed once for matrices that differ in their
values only."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from abut.parallel.matrix import matrix_of, own_rows
from abut.parallel.systems import FACTORS, NONE, Answer, Conditions, Vector, pressure_rows, ran_out, solve
from abut.parallel.team import Store
from abut.types import Foreign, Sparse

REFINED, REFINEMENTS = 1e-13, 5  # residual of a factorisation, and steps it may take
WORKSPACE = (50, 200, 1000)  # per cent over MUMPS's estimate, in turn: pivots put off for later need more than it sees
PACKAGES = ("mumps", "superlu_dist")
WIDE = 1.5  # entries of the pattern over those of the matrix from which on it is narrowed: contact has gone elsewhere


@dataclass(frozen=True)
class Factors:
    """solver: PETSc's, of the matrix ``operator``; pattern: where this process's rows of it may have entries, CSR of ones;
    symmetric: the matrix."""

    solver: Foreign
    operator: Foreign
    pattern: Sparse
    symmetric: bool

    def destroy(self) -> None:
        """Free their memory now, not when Python finds the time."""
        self.solver.destroy()
        self.operator.destroy()


def factorise(
    store: Store,
    number: int,
    n: int,
    symmetric: bool,
    share: Vector,
    more: Sparse | None,
    conditions: Conditions | None,
) -> Answer:
    """Solve by a factorisation of the whole matrix, and refinement; as ``keep_factors`` and ``by_factors``."""
    keep_factors(store, number, n, symmetric, more, conditions)
    return by_factors(store, share, (conditions or NONE).rhs)


def keep_factors(
    store: Store, number: int, n: int, symmetric: bool, more: Sparse | None, conditions: Conditions | None
) -> None:
    """Factorise the whole matrix, for ``by_factors``, in place of the one before, whose analysis serves if it fits.

    number: of the stiffness in the store; n: how many pressures; more: (n_own, n_places) added to the stiffness."""
    rows = saddle_rows(store[number], n, more, conditions or NONE)
    comm, old = store[number].comm, store.get("factors")
    pattern = _pattern(rows, store[number], conditions or NONE)
    fits = old is not None and (old.pattern.shape, old.symmetric) == (pattern.shape, symmetric)
    if old is not None and all(
        comm.tompi4py().allgather(fits)
    ):  # a model of as many unknowns may lie on processes otherwise
        both = (old.pattern + pattern).tocsr()  # sums of ones: what is stored once stays
        grown, wide = comm.tompi4py().allreduce(
            np.array([both.nnz > old.pattern.nnz, both.nnz > WIDE * pattern.nnz], dtype=np.int64)
        )
        if not (grown or wide):
            _refill(old, rows)
            if not ran_out(old.solver.getPC()):
                return
        pattern = pattern if wide else _ones(both)
    drop_factors(store)
    store["factors"] = _factors(_on(pattern, rows), pattern, symmetric, comm)


def by_factors(store: Store, share: Vector, rhs: Vector) -> Answer:
    """Solve with the factors that are kept. share: of the right-hand side; rhs: its rows of pressures, on process 0."""
    kept: Factors = store["factors"]
    return solve(kept.solver, kept.operator, share, rhs)


def drop_factors(store: Store) -> None:
    """Free their memory."""
    if "factors" in store:
        store.pop("factors").destroy()


def saddle_rows(matrix: Foreign, n: int, more: Sparse | None, given: Conditions) -> Sparse:
    """This process's rows of the whole matrix, CSR: those of its displacements, then, on process 0, of the pressures. In the
    columns pressures follow the displacements of process 0."""
    from petsc4py import PETSc

    own = own_rows(matrix)
    own = own if more is None else (own + more).tocsr()
    if not n:
        return own
    upper = pressure_rows(matrix, n, given.coupled).transpose(PETSc.Mat())
    forces, first = -1.0 * own_rows(upper), int(matrix.getOwnershipRanges()[1])
    upper.destroy()
    rows = sp.hstack([own[:, :first], forces, own[:, first:]], format="csr")
    if given.lower is None:
        return rows
    return sp.vstack([rows, _below(given.lower, given.corner, first)], format="csr")


def _below(lower: Sparse, corner: Sparse, first: int) -> Sparse:
    """Rows of pressures. first: how many displacements come before these."""
    return sp.hstack([lower[:, :first], corner, lower[:, first:]], format="csr")


def _pattern(rows: Sparse, matrix: Foreign, given: Conditions) -> Sparse:
    """Where ``rows`` have entries, or may have with another contact status: CSR of ones."""
    if given.possible is None:
        return _ones(rows)
    below = _below(*given.possible, int(matrix.getOwnershipRanges()[1]))
    above = sp.csr_matrix((rows.shape[0] - below.shape[0], rows.shape[1]))
    return _ones((_ones(rows) + _ones(sp.vstack([above, below], format="csr"))).tocsr())


def _ones(rows: Sparse) -> Sparse:
    rows.sum_duplicates()
    return sp.csr_matrix((np.ones(rows.nnz), rows.indices, rows.indptr), shape=rows.shape)


def _on(pattern: Sparse, rows: Sparse) -> Sparse:
    """Rows with the entries of a pattern that has all of theirs, zeros among them."""
    numbered = sp.csr_matrix((np.arange(1.0, pattern.nnz + 1.0), pattern.indices, pattern.indptr), shape=pattern.shape)
    place = numbered.multiply(_ones(rows)).tocsr()
    place.sort_indices()
    values = np.zeros(pattern.nnz)
    values[place.data.astype(np.int64) - 1] = rows.data
    return sp.csr_matrix((values, pattern.indices, pattern.indptr), shape=pattern.shape)


def _refill(factors: Factors, rows: Sparse) -> None:
    """Factorise other values, without another analysis."""
    from petsc4py import PETSc

    filled, ints = _on(factors.pattern, rows), PETSc.IntType
    factors.operator.setValuesCSR(filled.indptr.astype(ints), filled.indices.astype(ints), filled.data)
    factors.operator.assemble()
    factors.solver.setUp()


def factors_of(rows: Sparse, comm: Foreign, accurate: float) -> Factors:
    """Of a symmetric matrix of which this process has ``rows``, whose negative eigenvalues can be counted. accurate:
    residual from which on solutions are refined."""
    return _factors(rows, _ones(rows), True, comm, accurate, counted=True)


def _factors(
    rows: Sparse, pattern: Sparse, symmetric: bool, comm: Foreign, accurate: float = REFINED, counted: bool = False
) -> Factors:
    """rows: this process's of the matrix."""
    from petsc4py import PETSc

    operator = matrix_of(rows, comm)
    operator.setOption(PETSc.Mat.Option.SYMMETRIC, symmetric)
    for workspace in WORKSPACE:
        solver = _direct(operator, symmetric, workspace, accurate, counted)
        if workspace == WORKSPACE[-1] or not ran_out(solver.getPC()):
            break
        solver.destroy()
    return Factors(solver, operator, pattern, symmetric)


def _direct(operator: Foreign, symmetric: bool, workspace: int, accurate: float, counted: bool) -> Foreign:
    """PETSc's solver with the factors of a matrix. workspace: in per cent over MUMPS's own estimate; accurate: residual from
    which on solutions are refined; counted: pivots tell how many eigenvalues are negative."""
    from petsc4py import PETSc

    solver = PETSc.KSP().create(operator.comm)
    solver.setOperators(operator)
    solver.setType("fgmres")
    solver.setTolerances(rtol=accurate, atol=0.0, max_it=REFINEMENTS)
    package = direct_solver()
    preconditioner = solver.getPC()
    preconditioner.setType("cholesky" if symmetric and package == "mumps" else "lu")
    preconditioner.setFactorSolverType(package)
    if package == "mumps":
        preconditioner.setFactorSetUpSolverType()
        preconditioner.getFactorMatrix().setMumpsIcntl(14, workspace)
        preconditioner.getFactorMatrix().setMumpsIcntl(24, 1)  # a body that spins freely stays as it is: no failure
        if counted:
            preconditioner.getFactorMatrix().setMumpsIcntl(13, 1)  # ScaLAPACK, for the last front, does not count
    if PETSc.Options().getString("pc_type", FACTORS[0]) in FACTORS:
        solver.setFromOptions()
    solver.setUp()
    return solver


def direct_solver() -> str:
    """The package that factorises: PETSc's own does so on one process only."""
    from petsc4py import PETSc

    return next((name for name in PACKAGES if PETSc.Sys.hasExternalPackage(name)), "petsc")
