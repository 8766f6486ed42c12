"""Linear systems of displacements and pressures on many processes: what PETSc is given and answers.

Displacements are spread over the processes; rows and columns of pressures, one dimension lower, belong to process 0.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.types import Array, Foreign, Sparse

Vector = NDArray[np.float64]
FACTORS = ("cholesky", "lu")
OUT_OF_MEMORY = (-8, -9, -11, -13, -14, -15, -17, -20)  # what MUMPS calls so in INFOG(1)


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
    -(lower K^-1 coupled^T + corner); possible: lower and corner with all entries that they may have with another contact
    status, where one analysis is to serve several."""

    coupled: Foreign
    lower: Foreign
    corner: Foreign
    rhs: Vector
    inverse: Callable[[Vector], Vector] | None = None
    possible: tuple[Sparse, Sparse] | None = None


NONE = Conditions(None, None, None, np.zeros(0))  # of every process but the first


def solve(solver: Foreign, operator: Foreign, share: Vector, rhs: Vector) -> Answer:
    x, b = operator.createVecs()
    b.array[:] = np.concatenate([share, rhs])
    solver.solve(b, x)
    size = b.norm()
    miss = b.duplicate()
    operator.mult(x, miss)
    miss.axpy(-1.0, b)
    values = np.array(x.array_r)
    error = miss.norm() / size if size > 0.0 else float(np.nan_to_num(x.norm(), nan=np.inf))
    clean_up(operator.comm)
    return Answer(
        values[: len(share)], values[len(share) :], solver.getIterationNumber(), error, solver.getConvergedReason(),
        ran_out(solver.getPC()),
    )  # fmt: skip


def clean_up(comm: Foreign) -> None:
    """Give back what Python has let go of: where several processes share it, PETSc waits until all are told to."""
    from petsc4py import PETSc

    if hasattr(PETSc, "garbage_cleanup"):  # from 3.18 on; earlier ones do not wait
        PETSc.garbage_cleanup(comm)


def ran_out(preconditioner: Foreign) -> bool:
    """Whether a factorisation by MUMPS ran out of memory."""
    if preconditioner.getType() not in FACTORS or preconditioner.getFactorSolverType() != "mumps":
        return False
    return preconditioner.getFactorMatrix().getMumpsInfog(1) in OUT_OF_MEMORY


def pressure_rows(matrix: Foreign, n: int, rows: Sparse | None) -> Foreign:
    """A matrix (n, n_places) with all of its rows on process 0, which has them as CSR."""
    from petsc4py import PETSc

    columns = matrix.getSizes()[1]
    return PETSc.Mat().createAIJ(((_own(matrix.comm, n), n), columns), csr=_csr(rows), comm=matrix.comm)


def pressure_square(comm: Foreign, n: int, rows: Sparse | None) -> Foreign:
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
