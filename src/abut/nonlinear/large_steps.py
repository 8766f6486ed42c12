"""Load stepping at large displacements: automatic step lengths, each step begun by extrapolation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from abut.linear.solver import LinearSolver, NotConverged
from abut.nonlinear.hanging import hanging
from abut.nonlinear.holding import lifted
from abut.nonlinear.iteration import Found, Increment
from abut.nonlinear.load_step import Attempt
from abut.nonlinear.pace import Pace
from abut.nonlinear.semismooth import Step, largest_of, solve_finite
from abut.nonlinear.stepping import Control
from abut.problem.finite import FiniteProblem
from abut.problem.step_error import landed_in
from abut.solution.state import State

MOST = 25  # iterations in a step, above which it is halved
CAREFUL = 2  # cuts in a row from which on a line search shortens iterations


def march_finite(
    problem: FiniteProblem, done: Sequence[State], pace: Pace, solver: LinearSolver, control: Control
) -> Iterator[Attempt]:
    """Load step after load step. done: the converged states so far, from the start on; pace: after the last of them.

    A failed attempt is yielded only where no other follows it; where a linear solver fails, another one solves that step."""
    before, cuts = done[-1], 0
    stands_in: LinearSolver | None = None
    earlier = done[-2] if len(done) > 1 else None
    number, limit = len(done), min(MOST, control.limit)
    control.prepared(f"{solver.name}, unsymmetric, new in every {'iteration' if solver.count is None else 'step'}")
    while (time := pace.end) is not None:
        if cuts == 0 and stands_in is None:
            control.begins(number, time)
        begins = cuts or pace.turned or earlier is None or let_go(problem, earlier, before)
        guess = None if begins or earlier is None else extrapolated(problem, earlier, before, time)
        increment = Increment(number, before.largest)
        begin = problem.with_functions(before, before)
        following = problem.following(begin, problem.displacement(guess or before), before.closed)
        begin, guess = problem.led(begin, following), guess and problem.led(guess, following)
        if guess is not None:
            begin = problem.with_late_points(begin, problem.displacement(guess), np.ones(len(guess.status), bool))
        step = Step(problem, begin, stands_in or solver, increment, limit, control.observe, careful=cuts >= CAREFUL)
        try:
            attempt = _ended(*_settled(step, solve_finite(step, guess, time), time), time)
        except NotConverged as reason:
            stands_in = control.fallback(number, reason)
            continue
        if attempt.converged:
            stands_in = None
            pace.take(len(attempt.iterations), landed_in(attempt.state).share)
            yield attempt
            earlier, before, number, cuts = before, attempt.state, number + 1, 0
            continue
        cuts += 1
        pace.halve()
        if pace.stuck:
            where = hanging(problem, before, attempt.cycling)
            away = lifted(problem.ahead(before, time), before)
            yield replace(attempt, reason="; ".join(filter(None, (attempt.reason, where, away))))
            return
        control.halves(attempt, pace.end or time)


def let_go(problem: FiniteProblem, earlier: State, before: State) -> bool:
    """Whether a contact has ended between two states: bodies that have sprung back do not go on as they came."""
    parts = zip(problem.pairs, problem.split(earlier.closed), problem.split(before.closed))
    return any(was[pair.normal].any() and not now[pair.normal].any() for pair, was, now in parts if not pair.tied)


def extrapolated(problem: FiniteProblem, earlier: State, before: State, time: float) -> State:
    """A guess at ``time`` from the last two converged states, theory (G9): pressures stay open or pushing."""
    ratio = (time - before.time) / (before.time - earlier.time)
    ahead = before.multipliers + ratio * (before.multipliers - earlier.multipliers)
    first = 0
    for pair in problem.pairs:
        if not pair.tied:
            here = slice(first + pair.normal.start, first + pair.normal.stop)
            ahead[here] = np.where(
                before.multipliers[here] > 0.0, np.maximum(ahead[here], 0.0), before.multipliers[here]
            )
        first += len(pair)
    ahead = np.where(before.closed, ahead, before.multipliers)
    return replace(
        before, time=time, multipliers=ahead, unknowns=before.unknowns + ratio * (before.unknowns - earlier.unknowns)
    )


def _settled(step: Step, found: Found, time: float) -> tuple[Step, Found]:
    """Once more with the functions, gaps and points of slip that belong to the end of the step; as it was if that fails."""
    if not found.converged:
        return step, found
    problem, closed = step.problem, found.state.closed
    end = replace(found.state, time=time)
    here = problem.displacement(end)
    before = problem.with_late_points(problem.with_functions(step.before, end), here, closed)
    following = problem.following(before, here, closed, settled=True)
    if before is step.before and not following:
        return step, found
    before, guess = (step.problem.led(each, following) for each in (before, found.state))
    again = replace(step, before=before, limit=step.limit + len(step.done))
    inside = solve_finite(again, guess, time)
    return (again, inside) if inside.converged else (step, found)


def _ended(step: Step, found: Found, time: float) -> Attempt:
    none = np.zeros(len(found.state.status), dtype=bool)
    state = replace(found.state, time=time)
    if found.converged:
        system = step.problem.linearise(step.before, state)
        state = step.problem.accepted(step.before, replace(state, largest=largest_of(system, state, step.increment)))
    return Attempt(
        step.increment.number, state, found.converged, found.iterations, found.cycling, none, time, step.failed
    )
