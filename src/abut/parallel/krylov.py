"""Linear systems of displacements and pressures by PETSc: Krylov iterations or factorisation, on all processes.

Displacements are spread over the processes; rows and columns of pressures, one dimension lower, belong to process 0.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.parallel.team import Store
from abut.types import Array, Foreign, Sparse

Vector = NDArray[np.float64]
STIFFNESS = "stiffness_"  # prefix of PETSc's options for the displacements alone
RESTART, MOST = 100, 300
REFINED, REFINEMENTS = 1e-13, 5  # residual of a factorisation, and steps it may take
MULTIGRID = {
    "pc_type": "gamg", "mg_levels_ksp_max_it": "3", "mg_levels_pc_type": "jacobi", "mg_coarse_sub_pc_type": "svd",
}  # fmt: skip
NOTHING = (
    1e-9  # singular value of the coarsest matrix over the stiffness' diagonal: a motion that contact alone resists
)
FACTORS = ("cholesky", "lu")
OUT_OF_MEMORY = (-8, -9, -11, -13, -14, -15, -17, -20)  # what MUMPS calls so in INFOG(1)
WORKSPACE = (
    50,
    200,
    1000,
)  # per cent over MUMPS's estimate, tried in turn: pivots put off for later need more than it sees
PACKAGES = ("mumps", "superlu_dist")


@dataclass(frozen=True)
class Answer:
    """Of a linear solution, on each process: its share of the displacements, all pressures on process 0; iterations;
    error: residual over the right-hand side; reason: PETSc's word for how it ended, below zero where it failed;
    memory: whether a factorisation ran out of it."""

    displacement: Vector
    pressure: Vector
    iterations: int
    error: float
    reason: int
    memory: bool


@dataclass(frozen=True)
class Conditions:
    """What stands beside the stiffness, on process 0: coupled, lower (n, n_places), corner (n, n) and right-hand side as in
    ``abut.linear.saddle_point.Saddle``; inverse: preconditioner of the pressures (n,) -> (n,), roughly of
    -(lower K^-1 coupled^T + corner)."""

    coupled: Foreign
    lower: Foreign
    corner: Foreign
    rhs: Vector
    inverse: Callable[[Vector], Vector] | None = None


NONE = Conditions(None, None, None, np.zeros(0))  # of every process but the first


def multigrid(store: Store, motions: Vector) -> None:
    """Set up and keep the preconditioner of the stiffness. motions: (n_own, m) orthonormal rigid motions, this process's
    share."""
    from petsc4py import PETSc

    matrix = store["matrix"]
    vectors = []
    for column in motions.T:
        vectors.append(matrix.createVecLeft())
        vectors[-1].array[:] = column
    matrix.setNearNullSpace(PETSc.NullSpace().create(vectors=vectors, comm=matrix.comm))
    solver = PETSc.KSP().create(matrix.comm)
    solver.setOperators(matrix)
    solver.setOptionsPrefix(STIFFNESS)
    solver.setType("preonly")
    options = PETSc.Options()
    if options.hasName("pc_type") and not options.hasName(STIFFNESS + "pc_type"):
        options[STIFFNESS + "pc_type"] = options.getString("pc_type")
    drop = NOTHING * matrix.getDiagonal().max()[1]
    _unless_given(STIFFNESS, {**MULTIGRID, "mg_coarse_sub_pc_svd_zero_sing": f"{drop:.3e}"})
    solver.setFromOptions()
    solver.setUp()
    solver.getPC().setReusePreconditioner(True)  # while springs are in the matrix
    store["stiffness solver"] = solver


def iterate(
    store: Store,
    accuracy: float,
    n: int,
    small: Vector,
    share: Vector,
    unconstrained: Vector,
    conditions: Conditions | None,
) -> Answer:
    """Solve by Krylov iterations until the residual is ``accuracy`` times the right-hand side.

    n: how many pressures; share: of the right-hand side; unconstrained: (n_own, m) share of rigid motions that multigrid
    does not see, small: (m, m) inverse of their resistance."""
    from petsc4py import PETSc

    matrix = store["matrix"]
    given = conditions or NONE
    pulls, lower = _rows(matrix, n, given.coupled), _rows(matrix, n, given.lower)
    pulls.scale(-1.0)
    operator = matrix
    if n:
        upper, corner = PETSc.Mat().createTranspose(pulls), _square(matrix.comm, n, given.corner)
        operator = PETSc.Mat().createNest([[matrix, upper], [lower, corner]], comm=matrix.comm)
        operator.assemble()
    solver = PETSc.KSP().create(matrix.comm)
    solver.setOperators(operator)
    solver.setType("fgmres" if n else "cg")
    solver.setGMRESRestart(RESTART)
    solver.setTolerances(rtol=accuracy, atol=0.0, max_it=MOST)
    solver.setFromOptions()
    blocks = Blocks(store["stiffness solver"], pulls, unconstrained, small, given.inverse, solver.getType() == "minres")
    solver.getPC().setType("python")
    solver.getPC().setPythonContext(blocks)
    answer = _solve(solver, operator, share, given.rhs)
    solver.destroy()  # now, not when Python finds the time: it holds many vectors
    return answer


def factorise(store: Store, n: int, symmetric: bool, share: Vector, conditions: Conditions | None) -> Answer:
    """Solve by a factorisation of the whole matrix, and refinement."""
    keep_factors(store, n, symmetric, conditions)
    answer = by_factors(store, share, (conditions or NONE).rhs)
    drop_factors(store)
    return answer


def keep_factors(store: Store, n: int, symmetric: bool, conditions: Conditions | None) -> None:
    """Prepare a factorisation of the whole matrix, for ``by_factors``, in place of the one before."""
    drop_factors(store)
    store["factors"] = _factors(store["matrix"], n, symmetric, conditions or NONE)


def by_factors(store: Store, share: Vector, rhs: Vector) -> Answer:
    """Solve with the factors that are kept. share: of the right-hand side; rhs: its rows of pressures, on process 0."""
    solver, operator = store["factors"]
    return _solve(solver, operator, share, rhs)


def drop_factors(store: Store) -> None:
    """Free their memory now, not when Python finds the time."""
    if "factors" in store:
        store.pop("factors")[0].destroy()


def _factors(matrix: Foreign, n: int, symmetric: bool, given: Conditions) -> tuple[Foreign, Foreign]:
    """PETSc's solver, and the matrix that it factorises."""
    from petsc4py import PETSc

    operator = matrix
    if n:
        coupled, lower = _rows(matrix, n, given.coupled), _rows(matrix, n, given.lower)
        upper = coupled.transpose(PETSc.Mat())
        upper.scale(-1.0)
        corner = _square(matrix.comm, n, given.corner)
        nest = PETSc.Mat().createNest([[matrix, upper], [lower, corner]], comm=matrix.comm)
        nest.assemble()
        operator = nest.convert("aij", PETSc.Mat())
    operator.setOption(PETSc.Mat.Option.SYMMETRIC, symmetric)
    for share in WORKSPACE:
        solver = _direct(operator, symmetric, share)
        if share == WORKSPACE[-1] or not _ran_out(solver.getPC()):
            break
        solver.destroy()
    return solver, operator


def _direct(operator: Foreign, symmetric: bool, workspace: int) -> Foreign:
    """PETSc's solver with the factors of a matrix. workspace: in per cent over MUMPS's own estimate."""
    from petsc4py import PETSc

    solver = PETSc.KSP().create(operator.comm)
    solver.setOperators(operator)
    solver.setType("fgmres")
    solver.setTolerances(rtol=REFINED, atol=0.0, max_it=REFINEMENTS)
    package = direct_solver()
    preconditioner = solver.getPC()
    preconditioner.setType("cholesky" if symmetric and package == "mumps" else "lu")
    preconditioner.setFactorSolverType(package)
    if package == "mumps":
        preconditioner.setFactorSetUpSolverType()
        preconditioner.getFactorMatrix().setMumpsIcntl(14, workspace)
    if PETSc.Options().getString("pc_type", FACTORS[0]) in FACTORS:
        solver.setFromOptions()
    solver.setUp()
    return solver


def direct_solver() -> str:
    """The package that factorises: PETSc's own does so on one process only."""
    from petsc4py import PETSc

    return next((name for name in PACKAGES if PETSc.Sys.hasExternalPackage(name)), "petsc")


class Blocks:
    """Preconditioner of theory (V11): the interface's own operator for the pressures, then multigrid for the
    displacements; for MINRES, which wants it symmetric, each by itself."""

    def __init__(
        self, stiffness: Foreign, pulls: Foreign, unconstrained: Vector, small: Vector, inverse: Foreign, apart: bool
    ) -> None:
        self.stiffness, self.pulls, self.unconstrained, self.small = stiffness, pulls, unconstrained, small
        self.inverse, self.apart = inverse, apart
        self.residual, self.answer = stiffness.getOperators()[0].createVecs()
        self.pressure = pulls.createVecLeft()

    def apply(self, _: Foreign, x: Foreign, y: Foreign) -> None:
        """y = P x, for PETSc."""
        n = self.residual.getLocalSize()
        into, out = x.array_r, np.empty(len(x.array_r))
        if self.inverse is not None:
            q = self.inverse(into[n:])
            out[n:] = q if self.apart else -q
            self.pressure.array[:] = out[n:]
        self.residual.array[:] = into[:n]
        if not self.apart and self.pulls.getSize()[0]:
            self.pressure.scale(-1.0)
            self.pulls.multTransposeAdd(self.pressure, self.residual, self.residual)
        self.stiffness.solve(self.residual, self.answer)
        out[:n] = self.answer.array_r
        if self.small.size:
            shares = self.residual.comm.tompi4py().allreduce(self.unconstrained.T @ self.residual.array_r)
            out[:n] += self.unconstrained @ (self.small @ shares)
        y.array[:] = out


def _solve(solver: Foreign, operator: Foreign, share: Vector, rhs: Vector) -> Answer:
    x, b = operator.createVecs()
    b.array[:] = np.concatenate([share, rhs])
    solver.solve(b, x)
    size = b.norm()
    miss = b.duplicate()
    operator.mult(x, miss)
    miss.axpy(-1.0, b)
    values = np.array(x.array_r)
    error = miss.norm() / size if size > 0.0 else 0.0
    return Answer(
        values[: len(share)], values[len(share) :], solver.getIterationNumber(), error, solver.getConvergedReason(),
        _ran_out(solver.getPC()),
    )  # fmt: skip


def _ran_out(preconditioner: Foreign) -> bool:
    """Whether a factorisation by MUMPS ran out of memory."""
    if preconditioner.getType() not in FACTORS or preconditioner.getFactorSolverType() != "mumps":
        return False
    return preconditioner.getFactorMatrix().getMumpsInfog(1) in OUT_OF_MEMORY


def _unless_given(prefix: str, options: Mapping[str, str]) -> None:
    """Set PETSc's options, but for those that the user has set."""
    from petsc4py import PETSc

    database = PETSc.Options()
    for name, value in options.items():
        if not database.hasName(prefix + name):
            database[prefix + name] = value


def _rows(matrix: Foreign, n: int, rows: Sparse | None) -> Foreign:
    """A matrix (n, n_places) with all of its rows on process 0, which has them as CSR."""
    from petsc4py import PETSc

    columns = matrix.getSizes()[1]
    return PETSc.Mat().createAIJ(((_own(matrix.comm, n), n), columns), csr=_csr(rows), comm=matrix.comm)


def _square(comm: Foreign, n: int, rows: Sparse | None) -> Foreign:
    """A matrix (n, n) that is all on process 0."""
    from petsc4py import PETSc

    local = _own(comm, n)
    return PETSc.Mat().createAIJ(((local, n), (local, n)), csr=_csr(rows), comm=comm)


def _own(comm: Foreign, n: int) -> int:
    return 0 if comm.rank else n


def _csr(rows: Sparse | None) -> tuple[Array, Array, Vector]:
    from petsc4py import PETSc

    ints = PETSc.IntType
    if rows is None:
        return np.zeros(1, ints), np.zeros(0, ints), np.zeros(0)
    rows = rows.tocsr()
    rows.sort_indices()
    return rows.indptr.astype(ints), rows.indices.astype(ints), rows.data
