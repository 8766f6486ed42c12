"""A load step at small displacements solved once more from its end, under further forces."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from abut.linear.solver import LinearSolver, Prepared
from abut.linear.static_condensation import CondensedProblem
from abut.nonlinear.attempt import Attempt
from abut.nonlinear.iteration import Increment
from abut.nonlinear.load_step import Search, Task, load_step
from abut.nonlinear.settings import Settings
from abut.problem.problem import ContactProblem, Problem
from abut.problem.terms import Motion, Share
from abut.solution import Iteration


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
    """What it takes to solve steps again. problem: as its solver wants it; prepared: that, set up; limit: of iterations;
    search: for the contact status."""

    problem: Problem
    solver: LinearSolver
    prepared: Prepared
    limit: int
    settings: Settings
    search: Search

    def under(self, attempt: Attempt, imposed: Imposed) -> Attempt:
        """The end of a step (without friction, since it begins with its own end) with these forces. Raises
        SingularModelError and NotConverged."""
        increment = Increment(attempt.number, attempt.state.largest, self.settings)
        task = Task(
            _with(self.problem, imposed), attempt.state, self.solver, increment, self.limit, _unseen, self.search
        )
        return load_step(task, attempt.time, self.prepared)


def _with(problem: Problem, imposed: Imposed) -> Problem:
    if isinstance(problem, CondensedProblem):
        return replace(problem, whole=replace(problem.whole, terms=(*problem.whole.terms, imposed)))
    assert isinstance(problem, ContactProblem)
    return replace(problem, terms=(*problem.terms, imposed))


def _unseen(_: Iteration) -> None:
    return None
