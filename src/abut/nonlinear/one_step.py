"""One load step at large displacements: what belongs to its functions, solved, and once more with those of its end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from abut.linear.solver import LinearSolver
from abut.nonlinear.attempt import Attempt
from abut.nonlinear.drag import Drag
from abut.nonlinear.iteration import Found, Increment
from abut.nonlinear.semismooth import Step, largest_of, solve_finite
from abut.nonlinear.settings import DEFAULT, Settings
from abut.problem.balance import Balance
from abut.problem.problem import ContactProblem
from abut.solution import Iteration
from abut.solution.state import State

UNSTEADY = "the fluid spreads on with every solution"
AGAIN = 1  # times that a step is solved with the frame that belongs to its end, where that is another one


@dataclass(frozen=True)
class Setting:
    """What attempts at a load step share. number: of the step; limit: of iterations; observe: called with each of them."""

    problem: ContactProblem
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
        problem, known = self.problem, self.problem.ended(before)
        frame = problem.frame(before, guess)
        begin, guess = problem.handed(before, known, frame), guess and problem.handed(guess, known, frame)
        increment = Increment(self.number, before.largest, self.settings)
        step = Step(problem, begin, frame, self.solver, increment, self.limit, self.observe, careful=careful, drag=drag)
        found = solve_finite(step, guess, time)
        spreads = self.settings.steps.spreads if frame.wet else 0
        for done in range(AGAIN + spreads):
            frame = step.frame
            if found.converged:
                frame = problem.settled(step.before, step.frame, replace(found.state, time=time))
                frame = frame if done < AGAIN else step.frame.with_wet(frame.wet)
            if frame is step.frame:
                break
            begin, guess = (problem.handed(each, step.frame, frame) for each in (step.before, found.state))
            again = replace(step, before=begin, frame=frame, limit=step.limit + len(step.done))
            inside = solve_finite(again, guess, time)
            if not inside.converged and frame.wet is step.frame.wet:
                break
            step, found = again, inside
        if found.converged and _spreads_on(step, found, time):
            step.failed, found = UNSTEADY, replace(found, converged=False)
        return _ended(step, found, time)


def _spreads_on(step: Step, found: Found, time: float) -> bool:
    """Whether fluids get elsewhere than where the step has them."""
    if not step.frame.wet:
        return False
    return step.problem.settled(step.before, step.frame, replace(found.state, time=time)).wet is not step.frame.wet


def _ended(step: Step, found: Found, time: float) -> Attempt:
    none = np.zeros(len(found.state.status), dtype=bool)
    state, balance = found.state, None  # that of the last step, where no other is sound
    if found.system is not None:
        state = replace(found.state, time=time)
        balance = Balance.of(found.system, state)
    if found.converged:
        assert found.system is not None
        state = replace(state, largest=largest_of(found.system, state, step.increment))
        state = step.problem.accepted(step.before, step.frame, state, found.system)
    return Attempt(
        step.increment.number, state, found.converged, found.iterations, found.cycling, none, time, step.failed,
        balance=balance,
    )  # fmt: skip
