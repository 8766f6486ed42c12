"""One load step at large displacements: what belongs to its functions, solved, and once more with those of its end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from abut.linear.solver import LinearSolver
from abut.nonlinear.drag import Drag
from abut.nonlinear.iteration import Found, Increment
from abut.nonlinear.load_step import Attempt
from abut.nonlinear.semismooth import Step, largest_of, solve_finite
from abut.nonlinear.settings import DEFAULT, Settings
from abut.problem.balance import Balance
from abut.problem.finite import FiniteProblem
from abut.problem.stabilising import without_drag
from abut.solution import Iteration
from abut.solution.state import State


@dataclass(frozen=True)
class Setting:
    """What attempts at a load step share. number: of the step; limit: of iterations; observe: called with each of them."""

    problem: FiniteProblem
    solver: LinearSolver
    number: int
    limit: int
    observe: Callable[[Iteration], None]
    settings: Settings = DEFAULT

    def attempted(
        self, before: State, guess: State | None, time: float, careful: bool = False, drag: Drag | None = None
    ) -> Attempt:
        """The step from the converged state ``before`` to ``time``. guess: at its end; None: the tangent leads
        there; drag: on the way."""
        problem, before = self.problem, without_drag(before)
        begin = problem.with_functions(before, before)
        following = problem.following(begin, guess or before)
        begin, guess = problem.led(begin, following), guess and problem.led(guess, following)
        if guess is not None:
            begin = problem.with_late_points(begin, problem.displacement(guess), np.ones(len(guess.status), bool))
        increment = Increment(self.number, before.largest, self.settings)
        step = Step(problem, begin, self.solver, increment, self.limit, self.observe, careful=careful, drag=drag)
        return _ended(*_settled(step, solve_finite(step, guess, time), time), time)


def _settled(step: Step, found: Found, time: float) -> tuple[Step, Found]:
    """Once more with the functions, gaps and points of slip that belong to the end of the step; as it was if that fails."""
    if not found.converged:
        return step, found
    problem, closed = step.problem, found.state.closed
    end = replace(found.state, time=time)
    here = problem.displacement(end)
    before = problem.with_late_points(problem.with_functions(step.before, end), here, closed)
    following = problem.following(before, end, settled=True)
    if before is step.before and not following:
        return step, found
    before, guess = (step.problem.led(each, following) for each in (before, found.state))
    again = replace(step, before=before, limit=step.limit + len(step.done))
    inside = solve_finite(again, guess, time)
    return (again, inside) if inside.converged else (step, found)


def _ended(step: Step, found: Found, time: float) -> Attempt:
    none = np.zeros(len(found.state.status), dtype=bool)
    state, balance = found.state, None  # that of the last step, where no other is sound
    if found.system is not None:
        state = replace(found.state, time=time)
        balance = Balance.of(found.system, state)
    if found.converged:
        assert found.system is not None
        state = replace(state, largest=largest_of(found.system, state, step.increment))
        state = step.problem.accepted(step.before, state, found.system)
    return Attempt(
        step.increment.number, state, found.converged, found.iterations, found.cycling, none, time, step.failed,
        balance=balance,
    )  # fmt: skip
