"""Newton's method on a problem: linearise at the trial state, solve the contact problem that this makes, go on from its
solution."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from abut.linear.solver import LinearSolver, Prepared
from abut.nonlinear.exact import Aim
from abut.nonlinear.iteration import Found, Increment, largest_force
from abut.problem.frame import Frame
from abut.problem.linearised import Linearised
from abut.problem.problem import Problem
from abut.solution import Iteration
from abut.solution.state import State


class Search(Protocol):
    """How the contact status of a linearised problem is found, as ``abut.nonlinear.active_set.solve_step`` does."""

    def __call__(
        self, solver: Prepared, begin: State, increment: Increment, limit: int, observe: Callable[[Iteration], None],
        earlier: Sequence[Iteration] = (), aim: Aim = "solution", settle: bool = False,
    ) -> Found: ...  # fmt: skip


@dataclass(frozen=True)
class Task:
    """A load step to solve. before: the last converged state; limit: of iterations; observe: called with each of them;
    search: for the contact status; given: a frame other than that which begins there."""

    problem: Problem
    before: State
    solver: LinearSolver
    increment: Increment
    limit: int
    observe: Callable[[Iteration], None]
    search: Search
    given: Frame | None = None

    @cached_property
    def frame(self) -> Frame:
        """What is fixed during the step: ``given``, or that which begins at ``before``."""
        return self.problem.frame(self.before) if self.given is None else self.given


def newton(
    task: Task,
    guess: State,
    previous: Prepared | None,
    earlier: Sequence[Iteration] = (),
    aim: Aim = "solution",
    settle: bool = False,
) -> tuple[Found, Prepared]:
    """The state at the end of a load step, from ``guess`` on, and the linear solver as it was last set up.

    A constant problem is linearised once: what remains is the search for the contact status. Any other one is linearised
    anew at each state that this search finds, until its forces are in balance there. earlier, aim, settle: as for
    ``Search``."""
    problem, solver, settings = task.problem, task.solver, task.increment.settings.newton
    system = problem.linearise(task.before, task.frame, guess)
    prepared = solver.prepare(system, previous)
    found = task.search(prepared, guess, task.increment, task.limit, task.observe, earlier, aim, settle)
    error, near = np.inf, problem.constant
    while found.converged and not problem.constant:
        system = problem.linearise(task.before, task.frame, found.state)
        before, error = error, _unbalanced(system, found.state, task.increment)
        if error <= settings.balanced or (error <= settings.stalled and error > 0.5 * before):
            near = True
            break
        left = task.limit - len(found.iterations) + len(earlier)
        if left <= 0 or not np.isfinite(error):
            return replace(found, converged=False), prepared
        prepared = solver.prepare(system, prepared)
        found = task.search(
            prepared, found.state, task.increment, left, task.observe, found.iterations, aim, settle=True
        )
    return replace(found, system=system if near else None), prepared


def _unbalanced(system: Linearised, state: State, increment: Increment) -> float:
    internal = system.internal(state)
    largest = largest_force(system, state, internal, increment)
    return float(np.abs(system.relative(system.unbalanced(state, internal), largest)).max(initial=0.0))
