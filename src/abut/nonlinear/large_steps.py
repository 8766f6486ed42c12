"""Load steps at large displacements, each begun by extrapolation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from abut.linear.solver import LinearSolver
from abut.nonlinear.attempt import Attempt
from abut.nonlinear.hanging import hanging
from abut.nonlinear.holding import lifted, overcome
from abut.nonlinear.hourglass import hourglassing
from abut.nonlinear.march import Begin, Control
from abut.nonlinear.one_step import Setting, led_on
from abut.nonlinear.pace import Pace
from abut.nonlinear.unsettled import gives_way
from abut.problem.problem import ContactProblem
from abut.problem.stabilising import is_dragged
from abut.solution.state import State


class LargeSteps:
    """As ``Stepper``, at large displacements: where a linear solver fails another one takes that step."""

    def __init__(self, problem: ContactProblem, solver: LinearSolver, control: Control) -> None:
        self._problem, self._solver, self._control = problem, solver, control
        self._stands_in: LinearSolver | None = None
        self._limit = min(control.settings.steps.most, control.limit) if problem.pairs else control.limit
        control.prepared(f"{solver.name}, new in every {'iteration' if solver.count is None else 'step'}")

    def prepare(self) -> None:
        """Set up what serves all iterations, as in ``Stepper``: every step sets up its own."""

    def attempts(self, begin: Begin, pace: Pace) -> Sequence[Attempt]:
        """The step, or its parts, as in ``Stepper``; under a drag where no other step is short enough."""
        assert pace.end is not None
        before, time = begin.before, pace.end
        setting = Setting(
            self._problem,
            self._stands_in or self._solver,
            begin.number,
            self._limit,
            self._control.observe,
            self._control.settings,
        )
        careful = begin.cuts >= self._control.settings.steps.careful
        attempt = setting.attempted(before, self._guess(begin, pace), time, careful=careful)
        return [attempt] if attempt.converged or not pace.last else _led(setting, before, pace, attempt)

    def replace(self, solver: LinearSolver) -> None:
        """Go on with another linear solver, as in ``Stepper``: for this step."""
        self._stands_in = solver

    def end(self) -> None:
        """The step has converged, as in ``Stepper``."""
        self._stands_in = None

    def _guess(self, begin: Begin, pace: Pace) -> State | None:
        """By extrapolation, where that tells something. Without contact the tangent at the last state tells more, unless
        metal flows: the tangent has all of it go on flowing, and a bar that necks lets most of itself go."""
        problem, before, earlier = self._problem, begin.before, begin.earlier
        tried = begin.cuts >= (self._control.settings.steps.careful if problem.restraint.by_supports else 1)
        if tried or pace.turned or earlier is None or is_dragged(before):
            return None
        if not (problem.pairs or before.history.arrays):
            return None
        if before.time <= earlier.time:  # a drag has led on without time
            return None
        return extrapolated(problem, earlier, before, pace.end or before.time)


def _led(setting: Setting, before: State, pace: Pace, failed: Attempt) -> Sequence[Attempt]:
    """The parts of a step under a drag, where all others have ``failed``; that with the reasons if there are none."""
    time, goal = failed.time, pace.goal
    led = led_on(setting, before, pace)
    if led.converged:
        return led.attempts
    where = hanging(setting.problem, before, failed.cycling)
    frame = setting.problem.ended(before)
    away = lifted(setting.problem.ahead(before, frame, time), before)
    more = ""
    if goal is not None and not away:
        more = overcome(setting.problem.ahead(before, frame, goal), setting.problem.model.solve.time(goal))
    law = gives_way(setting.problem, failed.reason)
    folded = hourglassing(setting.problem, before, setting.settings.steps.folded)
    told = (failed.reason, law, folded, where, away, more, led.attempts[-1].reason)
    return [replace(failed, reason="; ".join(filter(None, told)))]


def extrapolated(problem: ContactProblem, earlier: State, before: State, time: float) -> State:
    """A guess at ``time`` from the last two converged states, theory (G9): pressures stay open or pushing."""
    ratio = (time - before.time) / (before.time - earlier.time)
    ahead = before.multipliers + ratio * (before.multipliers - earlier.multipliers)
    first = 0
    for pair in problem.pairs:
        if not pair.decided:
            here = slice(first + pair.normal.start, first + pair.normal.stop)
            ahead[here] = np.where(
                before.multipliers[here] > 0.0, np.maximum(ahead[here], 0.0), before.multipliers[here]
            )
        first += len(pair)
    ahead = np.where(before.closed, ahead, before.multipliers)
    return replace(
        before, time=time, multipliers=ahead, unknowns=before.unknowns + ratio * (before.unknowns - earlier.unknowns)
    )
