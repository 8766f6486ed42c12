"""Eigenpairs of a symmetric pencil with conditions beside it, by SLEPc on all processes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from abut.linear.direct import ACCURATE
from abut.parallel.factors import Factors, factors_of, saddle_rows
from abut.parallel.systems import NONE, Answer, Conditions, Vector, clean_up, solve
from abut.parallel.team import Store
from abut.types import Foreign


@dataclass(frozen=True)
class Task:
    """solve(left x) = t x with factors of a matrix beside conditions. matrix, factors, left, metric: their numbers in the
    store; inverts: whether ``left`` is the metric, and the 1 / t nearest to zero are wanted, else the largest t; count: how
    many; basis: how many vectors there are; tolerance: residual over t; restarts: at most, None where SLEPc decides."""

    matrix: int
    factors: int
    left: int
    metric: int
    inverts: bool
    count: int
    basis: int
    tolerance: float
    restarts: int | None


@dataclass(frozen=True)
class Found:
    """values: (n,) 1 / t where the task ``inverts``, else t; vectors: (n_own, n) shares, of length 1 in the metric; reason:
    SLEPc's word for how it ended, below zero where it failed."""

    values: Vector
    vectors: Vector
    reason: int


def keep_apart(store: Store, number: int, into: int, n: int, conditions: Conditions | None) -> None:
    """Keep factors of the matrix ``number``, with n conditions beside it, under a number of their own: apart from those of
    load steps."""
    rows = saddle_rows(store[number], n, None, conditions or NONE)
    store[into] = factors_of(rows, store[number].comm, ACCURATE)


def solve_apart(store: Store, number: int, n: int, share: Vector) -> Answer:
    """Solve with the factors ``number``, without a right-hand side of the n conditions."""
    kept: Factors = store[number]
    return solve(kept.solver, kept.operator, share, np.zeros(0 if kept.operator.comm.rank else n))


def negative(store: Store, number: int) -> int | None:
    """How many eigenvalues are negative by the pivots of the factors ``number``; None where the package does not tell, or
    some are zero."""
    kept: Factors = store[number]
    preconditioner = kept.solver.getPC()
    if preconditioner.getType() != "cholesky" or preconditioner.getFactorSolverType() != "mumps":
        return None
    below, zero, _ = preconditioner.getFactorMatrix().getInertia()
    return None if zero else int(below)


class Inverse:
    """What factors with conditions make of forces, as a preconditioner."""

    def __init__(self, factors: Factors) -> None:
        self.factors = factors
        self.answer, self.force = factors.operator.createVecs()

    def apply(self, _: Foreign, x: Foreign, y: Foreign) -> None:
        """y = P x, for PETSc."""
        n = x.getLocalSize()
        self.force.zeroEntries()
        self.force.array[:n] = x.array_r
        self.factors.solver.solve(self.force, self.answer)
        y.array[:] = self.answer.array_r[:n]


def iterate(store: Store, task: Task, start: Vector) -> Found:
    """Krylov-Schur iterations from a vector (n_own,)."""
    import slepc4py

    slepc4py.init(["abut"])
    from slepc4py import SLEPc

    metric, left = store[task.metric], store[task.left]
    solver = SLEPc.EPS().create(metric.comm)
    solver.setOperators(store[task.matrix] if task.inverts else left, metric)
    solver.setProblemType(SLEPc.EPS.ProblemType.GHEP)
    transform = solver.getST()
    if task.inverts:
        transform.setType("sinvert")
        transform.setMatMode(SLEPc.ST.MatMode.SHELL)  # the factors are there: it need not form a matrix
        solver.setTarget(0.0)
        solver.setWhichEigenpairs(SLEPc.EPS.Which.TARGET_MAGNITUDE)
    else:
        solver.setWhichEigenpairs(SLEPc.EPS.Which.LARGEST_REAL)
    inner = transform.getKSP()
    inner.setType("preonly")
    inner.getPC().setType("python")
    inner.getPC().setPythonContext(Inverse(store[task.factors]))
    solver.getDS().setParallel(SLEPc.DS.ParallelType.SYNCHRONIZED)  # processes may have different LAPACKs, and signs
    solver.setDimensions(task.count, task.basis)
    solver.setTolerances(task.tolerance, task.restarts)
    solver.setFromOptions()
    first = metric.createVecLeft()
    first.array[:] = start
    solver.setInitialSpace(first)
    solver.solve()
    found = min(solver.getConverged(), task.count)
    values, vectors = np.zeros(found), np.zeros((len(start), found))
    for i in range(found):
        values[i] = solver.getEigenpair(i, first).real
        vectors[:, i] = first.array_r
    reason = solver.getConvergedReason()
    solver.destroy()
    clean_up(metric.comm)
    return Found(values, vectors, int(reason))
