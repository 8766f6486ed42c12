"""One load step at large displacements: what belongs to its functions, solved, and once more with those of its end.

One that Newton's method cannot follow is led by a drag on all motion until all is at rest again: bodies that jump to another
equilibrium, or that hardly anything holds; theory (G23)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from abut.linear.solver import LinearSolver
from abut.nonlinear.attempt import UNSTEADY, Attempt
from abut.nonlinear.drag import Drag, scale
from abut.nonlinear.frames import Solved, in_frame_of_end
from abut.nonlinear.hourglass import folds_at_once
from abut.nonlinear.iteration import Found, Increment, largest_so_far
from abut.nonlinear.pace import Pace
from abut.nonlinear.semismooth import Step, solve_finite
from abut.nonlinear.settings import DEFAULT, Settings
from abut.problem.balance import Balance
from abut.problem.frame import Frame
from abut.problem.problem import ContactProblem
from abut.problem.stabilising import with_drag
from abut.solution import Iteration
from abut.solution.state import State


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
        solved = _Solved(step, solve_finite(step, guess, time), time)
        solved = in_frame_of_end(problem, solved, self.settings.steps.solutions)
        step, found = solved.step, solved.found
        if found.converged:
            step.failed = folds_at_once(problem, before, found.state, self.settings.steps.folded)
            found = replace(found, converged=not step.failed)
        return _ended(step, found, time)


@dataclass(frozen=True)
class _Solved(Solved):
    """As in ``Solved``: a step that was to end at ``time``, and what it came to."""

    step: Step
    found: Found
    time: float

    @property
    def before(self) -> State:
        return self.step.before

    @property
    def frame(self) -> Frame:
        return self.step.frame

    @property
    def end(self) -> State:
        return replace(self.found.state, time=self.time)

    @property
    def converged(self) -> bool:
        return self.found.converged

    def again(self, before: State, frame: Frame, guess: State) -> _Solved:
        step = replace(self.step, before=before, frame=frame, limit=self.step.limit + len(self.step.done))
        return replace(self, step=step, found=solve_finite(step, guess, self.time))

    def unsteady(self) -> _Solved:
        self.step.failed = UNSTEADY
        return replace(self, found=replace(self.found, converged=False))


def _ended(step: Step, found: Found, time: float) -> Attempt:
    none = np.zeros(len(found.state.status), dtype=bool)
    state, balance = found.state, None  # that of the last step, where no other is sound
    if found.system is not None:
        state = replace(found.state, time=time)
        balance = Balance.of(found.system, state)
    if found.converged:
        assert found.system is not None
        state = replace(state, largest=largest_so_far(found.system, state, step.increment))
        state = step.problem.accepted(step.before, step.frame, state, found.system)
    return Attempt(
        step.increment.number, state, found.converged, found.iterations, found.cycling, none, time, step.failed,
        balance=balance, reached=None if found.reached is None else replace(found.reached, time=time),
    )  # fmt: skip


@dataclass
class Strength:
    """Of a drag from part to part. share: of the stiffness, at most ``change`` times and
    at least half of it by ``settings``; fall: by which it falls next, 1 after a part that failed and
    twice as much after each easy one; failed: whether one has."""

    share: float
    settings: Settings
    fall: float
    failed: bool = False

    def grow(self) -> bool:
        """After a part that failed; whether it may: up to where the bodies' own stiffness is as slight beside it as it was
        beside that to begin with."""
        self.share, self.fall, self.failed = self.share * 0.5 * self.settings.drag.change, 1.0, True
        return self.share * self.settings.drag.slight <= 1.0

    def ease(self, iterations: int) -> None:
        """After one that took so many."""
        easy = self.settings.steps.easy
        if iterations <= (easy if self.failed else easy // 2):
            self.share = max(self.share / self.fall, self.settings.newton.balanced)
            self.fall = min(2.0 * self.fall, self.settings.drag.change)


@dataclass(frozen=True)
class Led:
    """Attempts at a step: its parts, the last of them at rest; or the one that failed and that nothing follows."""

    attempts: tuple[Attempt, ...]

    @property
    def converged(self) -> bool:
        """Whether they are its parts."""
        return self.attempts[-1].converged


def stride(settings: Settings) -> float:
    """Of the way to the next goal, that is tried under a drag."""
    return float(settings.steps.smallest**0.5)


def led_on(setting: Setting, before: State, pace: Pace) -> Led:
    """A step from the converged state ``before``, where no step without a drag is short enough; ``pace`` goes on with its
    length."""
    pace.stride(stride(setting.settings))
    assert pace.end is not None
    return stabilised(setting, before, pace.end)


def stabilised(setting: Setting, before: State, time: float) -> Led:
    """The step from the converged state ``before`` to ``time`` in parts, each with a drag on the way since the one before:
    backward Euler steps of a motion without inertia."""
    settings, asked = setting.settings, setting.settings.drag
    problem, setting = setting.problem, replace(setting, limit=min(2 * settings.steps.easy, setting.limit))
    size, most = scale(problem.again(before, before)), 0.0
    strength = Strength(asked.slight, settings, asked.change)
    here, parts, spent = before, list[Attempt](), tuple[Iteration, ...]()
    part, why = None, "bodies do not come to rest"
    for _ in range(settings.steps.solutions):
        drag = Drag(strength.share * size, here.unknowns)
        part = setting.attempted(here, here if parts else None, time, drag=drag)
        spent += part.iterations
        if not part.converged:
            if strength.grow():
                continue
            why = part.reason
            break
        force = drag.force(part.state.unknowns)
        here = with_drag(part.state, force)
        parts.append(replace(part, state=here, iterations=spent, whole=False))
        spent = ()
        if is_gone(problem, before, here, settings.holding.gone):
            why = "bodies move on and on: the loads are more than what they act on can carry"
            break
        left = float(np.abs(force).max(initial=0.0)) / here.largest.force
        most = max(most, left)
        least = strength.share <= settings.newton.balanced
        if left < asked.slight and (left < 10.0 * asked.slight * most or least):  # at the outset bodies are slow, too
            last = setting.attempted(here, here, time)
            spent += last.iterations
            if last.converged:
                return Led((*parts, replace(last, state=with_drag(last.state, 0.0 * force), iterations=spent)))
        strength.ease(len(part.iterations))
    assert part is not None
    why = f"under a drag on all motion {why}"
    return Led((replace(part, iterations=spent or part.iterations, converged=False, reason=why),))


def is_gone(problem: ContactProblem, before: State, here: State, sizes: float) -> bool:
    """Whether something has moved beyond all that loads of a model may mean."""
    way = problem.displacement(here) - problem.displacement(before)
    return bool(np.abs(way).max() > sizes * np.ptp(problem.model.mesh.points, axis=0).max())
