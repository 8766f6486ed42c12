"""A globally convergent search for the active set: interior point iterations, then exact solutions with the set found."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut.errors import SingularModelError
from abut.linear.solver import Prepared
from abut.nonlinear.exact import Aim, Solved, finer, settled, solve_set
from abut.nonlinear.interior_point import Interior, Manner, Programme, begin, iterate, near
from abut.nonlinear.iteration import Found, Increment, broken, imbalance, largest_pressure, report
from abut.nonlinear.laws import active_laws
from abut.nonlinear.newton import End, Method, newton
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
    clock = time.perf_counter()
    interior = settings.interior
    manner = Manner(interior.boundary, interior.central, correctors=2 if solver.exact else 0)
    programme = Programme.of(solver, settings)
    if system.compliance is None:  # it took a solution
        log.add(_row(solver, tied, state, increment, log.next, 0, clock))
    if log.full:
        return Found(state, tuple(log.done), False, ~tied, active_laws)
    clock = time.perf_counter()
    here = begin(programme, state)
    log.add(_row(solver, tied, here.state, increment, log.next, 0, clock))
    method = InteriorContact(Polish(solver, increment, log, aim), programme, manner)
    there, end = newton(method, Inside(here, tied), log.last - len(log.done))
    solved, left = there.solved, settings.newton.stalled * largest_pressure(there.here.state, increment)
    if end is not End.SOLVED and (solved is None or solved.violation.max() > left):
        undecided = programme.undecided(there.here)
        return Found(there.here.state.with_closed(there.active), tuple(log.done), False, undecided, active_laws)
    assert solved is not None
    if aim == "set":
        return Found(solved.state, tuple(log.done), True, solved.changed, active_laws)
    return finish_smooth(solver, solved.state, increment, limit, log.done, log.observe)


@dataclass(frozen=True)
class Inside:
    """An iteration's end: a point inside, and the set (n,) that it tells. floor: nothing gets better from here on;
    polished: whether exact solutions have been tried; solved: the last of them so far."""

    here: Interior
    active: NDArray[np.bool_]
    floor: bool = False
    polished: bool = False
    solved: Solved | None = None


class InteriorContact(Method[Inside]):
    """Interior points, until exact solutions from the set that they tell find the answer, or nothing gets better."""

    def __init__(self, polish: Polish, programme: Programme, manner: Manner) -> None:
        self._polish, self._programme, self._manner = polish, programme, manner
        self._few = max(int(polish.increment.settings.status.few * (~polish.tied).sum()), 1)
        self._best, self._idle = (np.inf, np.inf), 0

    def advanced(self, here: Inside) -> Inside:
        """One iteration, as in ``Method``."""
        clock, polish, programme = time.perf_counter(), self._polish, self._programme
        system, increment, log, tied = polish.solver.system, polish.increment, polish.log, polish.tied
        inside = iterate(near(programme, here.here), self._manner)
        at, active = near(programme, inside), programme.active(inside)
        changed = int((active != here.active).sum())
        told = inside.state.with_closed(active)
        log.add(_row(polish.solver, tied, told, increment, log.next, changed, clock))
        missed = max(at.missed, float(np.abs(system.gap(inside.state) / system.scale)[tied].max(initial=0.0)))
        self._idle = 0 if at.mean < self._best[0] or missed < self._best[1] else self._idle + 1
        self._best = min(at.mean, self._best[0]), min(missed, self._best[1])
        settings = increment.settings
        least = (settings.newton.stalled * largest_pressure(inside.state, increment)) ** 2
        floor = self._idle >= settings.newton.patience or at.mean < least
        if not floor and (int(programme.undecided(inside).sum()) > self._few or changed > max(self._few, 2)):
            return Inside(inside, active, solved=here.solved)
        return Inside(inside, active, floor, True, polish.from_set(told))

    def ended(self, there: Inside) -> End | None:
        """Whether, and why, iterations end, as in ``Method``."""
        if there.polished and there.solved is not None and not there.solved.changed.any():
            return End.SOLVED
        if there.floor:
            return End.STALLED
        return End.EXHAUSTED if self._polish.log.full else None


@dataclass(frozen=True)
class Exact:
    """A state with the active set to solve with, or as it was solved; accuracy: asked of the solution; solved: the last one;
    singular: whether there is none."""

    state: State
    accuracy: float
    solved: Solved | None = None
    singular: bool = False


@dataclass
class Polish(Method[Exact]):
    """Exact solutions, while ever fewer multipliers change."""

    solver: Prepared
    increment: Increment
    log: Log
    aim: Aim
    fewest: int = 0
    count: int = 0
    error: float = np.inf

    @property
    def tied(self) -> NDArray[np.bool_]:
        """(n,) multipliers that are always closed."""
        return self.solver.system.tied

    def from_set(self, state: State) -> Solved | None:
        """The last solution, beginning with the active set of ``state``, and the answer where its set stands still. None
        where none was possible."""
        self.fewest, self.count, self.error = len(state.status) + 1, 0, np.inf
        begin = Exact(state, self.increment.settings.accuracy.stride)
        return newton(self, begin, self.log.last - len(self.log.done))[0].solved

    def advanced(self, here: Exact) -> Exact:
        """One iteration, as in ``Method``."""
        try:
            solved = solve_set(self.solver, here.state, self.increment, self.tied, self.log.next, here.accuracy)
        except SingularModelError:
            return replace(here, singular=True)
        self.log.add(solved.row)
        return Exact(solved.state, here.accuracy, solved)

    def ended(self, there: Exact) -> End | None:
        """Whether, and why, iterations end, as in ``Method``."""
        if there.singular or there.solved is None:
            return End.STALLED
        settings, changed = self.increment.settings, int(there.solved.changed.sum())
        if changed == 0:
            return End.SOLVED if settled(self.solver, there.solved, settings, self.aim, self.error) else None
        late = self.count + 1 >= settings.newton.patience and changed > 0.5 * self.fewest
        return End.STALLED if changed >= self.fewest or late else None

    def followed(self, there: Exact) -> Exact:
        """The same set, solved better where it stands still, or the one that the law asks for."""
        solved, settings = there.solved, self.increment.settings
        assert solved is not None
        changed = int(solved.changed.sum())
        if changed == 0:
            self.error = solved.error
            return replace(there, accuracy=finer(self.solver, solved, settings, self.aim))
        self.fewest, self.count, self.error = changed, self.count + 1, np.inf
        return replace(there, state=solved.state.with_closed(solved.wanted), accuracy=settings.accuracy.stride)


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
    left = imbalance(system, state, increment), broken(violation, state, increment)
    return report(system, state, increment, count, changed, left, time.perf_counter() - clock)
