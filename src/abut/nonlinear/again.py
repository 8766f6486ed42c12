"""A load step at small displacements solved once more from its end, under further forces."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from abut.linear.solver import LinearSolver, Prepared, Vector
from abut.linear.static_condensation import CondensedProblem
from abut.nonlinear.active_set import solve_step
from abut.nonlinear.attempt import Attempt
from abut.nonlinear.exact import Aim
from abut.nonlinear.iteration import Found, Increment
from abut.nonlinear.load_step import load_step
from abut.nonlinear.newton import Task
from abut.nonlinear.settings import Settings
from abut.problem.problem import ContactProblem, Problem
from abut.problem.terms import Motion, Share
from abut.solution import Iteration
from abut.solution.state import State

ENOUGH = 1e-4  # of the largest force and pressure, left by iterative solvers: the forces change these by some percent


@dataclass(frozen=True)
class Imposed:
    """Forces that nothing changes, on the side of those of stresses: (dim n_points,)."""

    force: np.ndarray
    name: str = "imposed forces"
    constant: bool = True

    def evaluate(self, before: Motion, now: Motion) -> Share:
        """As in ``Term``."""
        return Share(self.force)


@dataclass(frozen=True)
class Again:
    """What it takes to solve steps again. problem: as its solver wants it; prepared: that, set up; limit: of iterations."""

    problem: Problem
    solver: LinearSolver
    prepared: Prepared
    limit: int
    settings: Settings

    def under(self, attempt: Attempt, imposed: Imposed) -> Attempt:
        """The end of a step (without friction, since it begins with its own end) with these forces. Raises
        SingularModelError and NotConverged."""
        increment = Increment(attempt.number, attempt.state.largest, self.settings)
        task = Task(_with(self.problem, imposed), attempt.state, self.solver, increment, self.limit, _unseen, _roughly)
        return load_step(task, attempt.time, self.prepared)


def prepared(problem: ContactProblem, solver: LinearSolver, state: State, settings: Settings) -> Again:
    """Of a run that has not begun to solve; state: any of the problem."""
    condensed = solver.condensed(problem)
    system = condensed.linearise(state, condensed.frame(state), condensed.restrict(state))
    limit = problem.model.solve.max_iterations
    return Again(condensed, solver, solver.prepare(system, None), limit, settings)


def _with(problem: Problem, imposed: Imposed) -> Problem:
    if isinstance(problem, CondensedProblem):
        whole = replace(problem.whole, terms=(*problem.whole.terms, imposed))
        return replace(problem, whole=whole, refinements=0)  # cancellation takes no digit that the forces have
    assert isinstance(problem, ContactProblem)
    return replace(problem, terms=(*problem.terms, imposed))


def _roughly(
    solver: Prepared, begin: State, increment: Increment, limit: int, observe: Callable[[Iteration], None],
    earlier: Sequence[Iteration] = (), aim: Aim = "solution", settle: bool = False,
) -> Found:  # fmt: skip
    """``solve_step``, where the solver is not exact only to ``ENOUGH``."""
    solver = replace(cast(Any, solver), predict=_as_asked)
    if not solver.exact:
        solver = replace(cast(Any, solver), accurate=max(ENOUGH, solver.accurate))
    return solve_step(solver, begin, increment, limit, observe, earlier, aim, settle)


def _as_asked(gap: Vector, pressure: Vector, active: NDArray[np.bool_], tied: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The status that the law asks for: so near the solution there is nothing to foresee."""
    return active


def _unseen(_: Iteration) -> None:
    return None
