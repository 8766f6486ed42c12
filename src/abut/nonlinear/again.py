"""A load step at small displacements solved once more from its end, under further forces."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from abut.linear.solver import LinearSolver, Prepared, Vector
from abut.linear.static_condensation import CondensedProblem
from abut.nonlinear.attempt import Attempt
from abut.nonlinear.iteration import Found, Increment
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
        """Force, tangent and history at a state, as in ``Term``."""
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
        search = _roughly(self.search, self.settings.accuracy.further)
        task = Task(_with(self.problem, imposed), attempt.state, self.solver, increment, self.limit, _unseen, search)
        return load_step(task, attempt.time, self.prepared)


def _with(problem: Problem, imposed: Imposed) -> Problem:
    if isinstance(problem, CondensedProblem):
        whole = replace(problem.whole, terms=(*problem.whole.terms, imposed))
        return replace(problem, whole=whole, refinements=0)  # cancellation takes no digit that the forces have
    assert isinstance(problem, ContactProblem)
    return replace(problem, terms=(*problem.terms, imposed))


def _roughly(search: Search, enough: float) -> Search:
    """A search that solvers which are not exact do well ``enough``."""

    def found(solver: Prepared, *rest: Any, **further: Any) -> Found:
        solver = replace(cast(Any, solver), predict=_as_asked)
        if not solver.exact:
            solver = replace(cast(Any, solver), accurate=max(enough, solver.accurate))
        return search(solver, *rest, **further)

    return found


def _as_asked(gap: Vector, pressure: Vector, active: NDArray[np.bool_], tied: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The status that the law asks for: so near the solution there is nothing to foresee."""
    return active


def _unseen(_: Iteration) -> None:
    return None
