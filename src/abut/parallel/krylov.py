"""Krylov iterations on displacements and pressures by PETSc, on all processes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from abut.parallel.systems import NONE, Answer, Conditions, Vector, pressure_rows, pressure_square, solve
from abut.parallel.team import Store
from abut.types import Foreign

STIFFNESS = "stiffness_"  # prefix of PETSc's options for the displacements alone
RESTART, MOST = 100, 300
MULTIGRID = {
    "pc_type": "gamg", "mg_levels_ksp_max_it": "3", "mg_levels_pc_type": "jacobi", "mg_coarse_sub_pc_type": "svd",
}  # fmt: skip
NOTHING = (
    1e-9  # singular value of the coarsest matrix over the stiffness' diagonal: a motion that contact alone resists
)


def multigrid(store: Store, number: int, motions: Vector) -> None:
    """Set up and keep the preconditioner of the stiffness, which has a number in the store. motions: (n_own, m) orthonormal
    rigid motions, this process's share."""
    from petsc4py import PETSc

    matrix = store[number]
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
    if "stiffness solver" in store:
        store["stiffness solver"].destroy()
    store["stiffness solver"] = solver


@dataclass(frozen=True)
class Task:
    """A linear system to iterate on. number: of the stiffness in the store; n: how many pressures; accuracy: residual over
    the right-hand side; small: (m, m) inverse of what resists motions that multigrid does not see; definite: the
    stiffness."""

    number: int
    n: int
    accuracy: float
    small: Vector
    definite: bool


def iterate(store: Store, task: Task, share: Vector, unconstrained: Vector, conditions: Conditions | None) -> Answer:
    """Solve by Krylov iterations. share: of the right-hand side; unconstrained: (n_own, m) share of motions that multigrid
    does not see."""
    from petsc4py import PETSc

    matrix = store[task.number]
    given = conditions or NONE
    pulls, lower = pressure_rows(matrix, task.n, given.coupled), pressure_rows(matrix, task.n, given.lower)
    pulls.scale(-1.0)
    operator = matrix
    if task.n:
        upper, corner = PETSc.Mat().createTranspose(pulls), pressure_square(matrix.comm, task.n, given.corner)
        operator = PETSc.Mat().createNest([[matrix, upper], [lower, corner]], comm=matrix.comm)
        operator.assemble()
    solver = PETSc.KSP().create(matrix.comm)
    solver.setOperators(operator)
    solver.setType("cg" if task.definite and not task.n else "fgmres")
    solver.setGMRESRestart(RESTART)
    solver.setTolerances(rtol=task.accuracy, atol=0.0, max_it=MOST)
    solver.setFromOptions()
    blocks = Blocks(
        store["stiffness solver"], pulls, unconstrained, task.small, given.inverse, solver.getType() == "minres"
    )
    solver.getPC().setType("python")
    solver.getPC().setPythonContext(blocks)
    answer = solve(solver, operator, share, given.rhs)
    solver.destroy()  # now, not when Python finds the time: it holds many vectors
    return answer


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


def _unless_given(prefix: str, options: Mapping[str, str]) -> None:
    """Set PETSc's options, but for those that the user has set."""
    from petsc4py import PETSc

    database = PETSc.Options()
    for name, value in options.items():
        if not database.hasName(prefix + name):
            database[prefix + name] = value
