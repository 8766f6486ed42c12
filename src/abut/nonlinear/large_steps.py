"""Load stepping at large displacements: automatic step lengths, each step begun by extrapolation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from abut.linear.solver import LinearSolver, NotConverged
from abut.nonlinear.hanging import hanging
from abut.nonlinear.holding import lifted, overcome
from abut.nonlinear.load_step import Attempt
from abut.nonlinear.one_step import Setting
from abut.nonlinear.pace import Pace
from abut.nonlinear.stabilised import led_on, stabilised
from abut.nonlinear.stepping import Control
from abut.problem.finite import FiniteProblem
from abut.problem.stabilising import drag_of, is_dragged
from abut.problem.step_error import landed_in
from abut.solution.state import State

MOST = 25  # iterations in a step, above which it is halved
AGAIN = (
    1  # cuts in a row up to which a step begins by extrapolation; none where contact alone holds a body: that throws it
)
CAREFUL = 2  # cuts in a row from which on a line search shortens iterations


def march_finite(
    problem: FiniteProblem, done: Sequence[State], pace: Pace, solver: LinearSolver, control: Control
) -> Iterator[Attempt]:
    """Load step after load step. done: the converged states so far, from the start on; pace: after the last of them.

    A failed attempt is yielded only where no other follows it; where a linear solver fails, another one solves that step."""
    before, cuts = done[-1], 0
    stands_in: LinearSolver | None = None
    earlier = done[-2] if len(done) > 1 else None
    number, limit = len(done), min(MOST, control.limit) if problem.pairs else control.limit
    control.prepared(f"{solver.name}, new in every {'iteration' if solver.count is None else 'step'}")
    while (time := pace.end) is not None:
        if cuts == 0 and stands_in is None:
            control.begins(number, time)
        tried = cuts > (AGAIN if problem.restraint.by_supports else 0)
        begins = tried or pace.turned or is_dragged(before) or not problem.pairs
        begins = begins or earlier is None or let_go(problem, earlier, before)
        guess = None if begins or earlier is None else extrapolated(problem, earlier, before, time)
        setting = Setting(problem, stands_in or solver, number, limit, control.observe)
        try:
            attempts = _attempts(setting, before, guess, time, careful=cuts >= CAREFUL)
            if gave_up := not attempts[-1].converged and pace.last:
                attempts = _led(setting, before, pace, attempts[-1])
        except NotConverged as reason:
            stands_in = control.fallback(number, reason)
            continue
        if attempts[-1].converged:
            stands_in = None
            pace.take(sum(len(part.iterations) for part in attempts), landed_in(attempts[-1].state).share)
            last = replace(attempts[-1], whole=pace.whole(time))
            yield from (*attempts[:-1], last)
            earlier, before, number, cuts = before, last.state, number + last.whole, 0
            continue
        if gave_up:
            yield attempts[-1]
            return
        cuts += 1
        pace.halve()
        control.halves(attempts[-1], pace.end or time)


def _attempts(setting: Setting, before: State, guess: State | None, time: float, careful: bool) -> Sequence[Attempt]:
    """One at the step to ``time``; after a step that ended under a drag its parts under a drag as well."""
    if not drag_of(before).any():
        return [setting.attempted(before, guess, time, careful=careful)]
    return stabilised(setting, before, time).attempts


def _led(setting: Setting, before: State, pace: Pace, failed: Attempt) -> Sequence[Attempt]:
    """The parts of a step under a drag, where all others have ``failed``; that with the reasons if there are none."""
    time, goal = failed.time, pace.goal
    led = led_on(setting, before, pace)
    if led.converged:
        return led.attempts
    where = hanging(setting.problem, before, failed.cycling)
    away = lifted(setting.problem.ahead(before, time), before)
    more = "" if away or goal is None else overcome(setting.problem.ahead(before, goal))
    return [
        replace(failed, reason="; ".join(filter(None, (failed.reason, where, away, more, led.attempts[-1].reason))))
    ]


def let_go(problem: FiniteProblem, earlier: State, before: State) -> bool:
    """Whether a contact has ended between two states: bodies that have sprung back do not go on as they came."""
    parts = zip(problem.pairs, problem.split(earlier.closed), problem.split(before.closed))
    return any(was[pair.normal].any() and not now[pair.normal].any() for pair, was, now in parts if not pair.two_way)


def extrapolated(problem: FiniteProblem, earlier: State, before: State, time: float) -> State:
    """A guess at ``time`` from the last two converged states, theory (G9): pressures stay open or pushing."""
    ratio = (time - before.time) / (before.time - earlier.time)
    ahead = before.multipliers + ratio * (before.multipliers - earlier.multipliers)
    first = 0
    for pair in problem.pairs:
        if not pair.two_way:
            here = slice(first + pair.normal.start, first + pair.normal.stop)
            ahead[here] = np.where(
                before.multipliers[here] > 0.0, np.maximum(ahead[here], 0.0), before.multipliers[here]
            )
        first += len(pair)
    ahead = np.where(before.closed, ahead, before.multipliers)
    return replace(
        before, time=time, multipliers=ahead, unknowns=before.unknowns + ratio * (before.unknowns - earlier.unknowns)
    )
