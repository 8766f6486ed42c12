"""A globally convergent search for the active set: interior point iterations, then exact solutions with the set found."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.errors import SingularModelError
from abut.linear.solver import Prepared
from abut.nonlinear.exact import Aim, Solved, finer, settled, solve_set
from abut.nonlinear.interior_point import Manner, Programme, begin, iterate, near
from abut.nonlinear.iteration import Found, Increment, active_laws, largest_pressure, report
from abut.nonlinear.smooth_laws import finish_smooth
from abut.solution import Iteration
from abut.solution.state import State


@dataclass
class Log:
    """The rows of a step so far, told as they come."""

    done: list[Iteration]
    observe: Callable[[Iteration], None]
    last: int

    def add(self, row: Iteration) -> None:
        self.done.append(row)
        self.observe(row)

    @property
    def next(self) -> int:
        return len(self.done) + 1

    @property
    def full(self) -> bool:
        return len(self.done) >= self.last


def search(
    solver: Prepared, state: State, increment: Increment, limit: int, log: Log, tied: NDArray[np.bool_], aim: Aim
) -> Found:
    """The state at the end of a load step. limit: of iterations of the constraint function, which come last."""
    system, settings = solver.system, increment.settings
    few = max(int(settings.status.few * (~tied).sum()), 1)

    def finish(solved: Solved) -> Found:
        if aim == "set":
            return Found(solved.state, tuple(log.done), True, solved.changed, active_laws)
        return finish_smooth(solver, solved.state, increment, limit, log.done, log.observe)

    clock = time.perf_counter()
    interior = settings.interior
    manner = Manner(interior.boundary, interior.central, correctors=2 if solver.exact else 0)
    programme = Programme.of(solver, settings)
    if system.compliance is None:  # it took a solution
        log.add(_row(solver, tied, state, increment, log.next, 0, clock))
    if log.full:
        return Found(state, tuple(log.done), False, ~tied, active_laws)
    clock = time.perf_counter()
    here = begin(programme, state, manner)
    log.add(_row(solver, tied, here.state, increment, log.next, 0, clock))
    active = tied
    best, idle = (np.inf, np.inf), 0
    solved: Solved | None = None
    while not log.full:
        clock = time.perf_counter()
        here = iterate(near(programme, here), manner)
        at, closed = near(programme, here), programme.active(here)
        changed, active = int((closed != active).sum()), closed
        log.add(_row(solver, tied, here.state.with_closed(active), increment, log.next, changed, clock))
        missed = max(at.missed, float(np.abs(system.gap(here.state) / system.scale)[tied].max(initial=0.0)))
        idle = 0 if at.mean < best[0] or missed < best[1] else idle + 1
        best = min(at.mean, best[0]), min(missed, best[1])
        floor = (
            idle >= settings.newton.patience or at.mean < interior.floor * largest_pressure(here.state, increment) ** 2
        )
        if not floor and (int(programme.undecided(here).sum()) > few or changed > max(few, 2)):
            continue
        solved = polish(solver, here.state.with_closed(active), increment, log, tied, aim)
        if solved is not None and not solved.changed.any():
            return finish(solved)
        if floor:
            break
    left = settings.newton.stalled * largest_pressure(here.state, increment)
    if solved is not None and solved.violation.max() <= left:
        return finish(solved)
    return Found(here.state.with_closed(active), tuple(log.done), False, programme.undecided(here), active_laws)


def polish(
    solver: Prepared, state: State, increment: Increment, log: Log, tied: NDArray[np.bool_], aim: Aim
) -> Solved | None:
    """Exact solutions, beginning with the active set of ``state``, while ever fewer multipliers change: the last of them,
    and the answer where its set stands still. None where none was possible."""
    settings = increment.settings
    stride, tries = settings.accuracy.stride, settings.newton.patience
    solved, fewest, accuracy, count, error = None, len(tied) + 1, stride, 0, np.inf
    while not log.full:
        try:
            following = solve_set(solver, state, increment, tied, log.next, accuracy)
        except SingularModelError:
            return solved
        log.add(following.row)
        solved = following
        changed = int(solved.changed.sum())
        if changed == 0 and settled(solver, solved, settings, aim, error):
            return solved
        if changed == 0:
            state, accuracy, error = solved.state, finer(solver, solved, settings, aim), solved.error
            continue
        if changed >= fewest or (count + 1 >= tries and changed > 0.5 * fewest):
            return solved
        fewest, count, error = changed, count + 1, np.inf
        state, accuracy = solved.state.with_closed(solved.wanted), stride
    return solved


def _row(
    solver: Prepared,
    tied: NDArray[np.bool_],
    state: State,
    increment: Increment,
    count: int,
    changed: int,
    clock: float,
) -> Iteration:
    """The row of the table for a state between: how far gaps and pressures are from one of them being zero."""
    system = solver.system
    gap = system.gap(state) / system.scale
    violation = np.abs(np.where(tied, gap, np.minimum(gap, state.multipliers)))
    return report(system, state, increment, count, changed, violation, time.perf_counter() - clock)
