"""Semi-smooth Newton on contact and slip together, in whole steps; half spaces foresee where contact closes."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from abut.linear.solver import Prepared
from abut.nonlinear.friction_laws import Status, next_status
from abut.nonlinear.iteration import Found, Increment, advance, imbalance, largest_pressure, points, report
from abut.nonlinear.laws import friction_laws
from abut.nonlinear.newton import End, Method, newton
from abut.problem.pair import Pair
from abut.solution import Iteration
from abut.solution.state import CLOSED, OPEN, State


@dataclass
class Course:
    """A load step so far. done: rows of the table; best: the state that breaks the laws least, and by how much (pressure);
    recent: the last statuses."""

    solver: Prepared
    increment: Increment
    done: list[Iteration]
    observe: Callable[[Iteration], None]
    best: tuple[float, State | None] = (np.inf, None)
    recent: list[Status] = field(default_factory=list)

    def add(self, state: State, changed: int, clock: float) -> float:
        """A row of the table for a state and its status; the larger one of what laws and equilibrium have left."""
        seconds, missed = time.perf_counter() - clock, self._missed(state)
        largest = largest_pressure(state, self.increment)
        both = imbalance(self.solver.system, state, self.increment), float(missed / largest)
        row = report(self.solver.system, state, self.increment, len(self.done) + 1, changed, both, seconds)
        self.done.append(row)
        self.observe(row)
        self.recent = [*self.recent[1 - 2 * self.increment.settings.newton.patience :], state.status]
        left = max(row.contact_residual, row.residual)
        if left * largest < self.best[0]:
            self.best = left * largest, state
        return left

    def _missed(self, state: State) -> float:
        """By how much (pressure) the laws are broken, with the status as it is."""
        system = self.solver.system
        left = [
            float(np.abs(law.residual / pair.weight).max(initial=0.0)) * pair.stiffness
            for pair, law in zip(system.pairs, friction_laws(system, state))
        ]
        return max(left, default=0.0)

    def found(self, state: State) -> Found:
        """What the search ends with where it has succeeded."""
        return Found(state, tuple(self.done), True, np.zeros(len(state.status), dtype=bool), friction_laws)

    def failed(self) -> Found | None:
        """The best state; None where there is none."""
        state = self.best[1]
        if state is None:
            return None
        recent = np.stack(self.recent)
        between = np.bitwise_or.reduce(np.left_shift(1, recent.astype(np.uint8)), axis=0).astype(np.uint8)
        changing = np.ptp(recent, axis=0) > 0
        return Found(state, tuple(self.done), False, changing, friction_laws, between=between)


@dataclass(frozen=True)
class Trial:
    """What an iteration leaves. state: with the status to go on with; wanted: the status that laws ask for there; changed:
    points whose status that changes; left: of laws and equilibrium."""

    state: State
    wanted: Status
    changed: int
    left: float


class Sliding(Method[Trial]):
    """Whole steps with the status that laws ask for; gives up as soon as a status comes back, or nothing gets better any
    more."""

    def __init__(self, course: Course) -> None:
        self._course, self._settings = course, course.increment.settings
        self._tolerance = max(self._settings.newton.balanced, course.solver.accurate)
        self._accuracy = self._settings.accuracy.rough
        self._fewest, self._least, self._before = np.inf, np.inf, np.inf
        self._idle = 0
        self._seen: set[bytes] = set()

    def advanced(self, here: Trial) -> Trial:
        """As in ``Method``."""
        clock, course = time.perf_counter(), self._course
        following = advanced(course.solver, here.state, course.increment, self._accuracy)
        wanted = next_status(course.solver.system, following, *course.increment.rounding)
        changed = points(course.solver.system, wanted != here.state.status)
        left = course.add(following.with_status(wanted), changed, clock)
        return Trial(following, wanted, changed, left)

    def ended(self, there: Trial) -> End | None:
        """As in ``Method``."""
        asked, changed, left = self._settings.newton, there.changed, there.left
        if not changed and (left <= self._tolerance or (left <= asked.stalled and left > 0.5 * self._before)):
            return End.SOLVED
        better = changed < self._fewest or (changed == 0 and left < 0.5 * self._least)
        self._idle = 0 if better else self._idle + 1
        if self._idle >= asked.patience or (changed and there.wanted.tobytes() in self._seen):
            return End.STALLED
        return None

    def followed(self, there: Trial) -> Trial:
        """With the status that laws ask for, closed where half spaces close; without them
        ``test_counts_of_a_layer_that_recedes`` fails."""
        asked, changed, left, wanted = self._settings.accuracy, there.changed, there.left, there.wanted
        self._fewest, self._least = min(self._fewest, changed), min(self._least, left)
        self._before = left if not changed else np.inf
        self._accuracy = asked.rough if changed else max(asked.spare * self._tolerance / left, asked.stride)
        self._seen.add(wanted.tobytes())
        status = foreseen(self._course.solver, there.state, wanted) if changed else wanted
        return replace(there, state=there.state.with_status(status))


def slid(course: Course, first: State, limit: int) -> Found | None:
    """Newton's method from a state and its status on; None where it gives up."""
    there, end = newton(Sliding(course), Trial(first, first.status, 0, np.inf), limit)
    return course.found(there.state.with_status(there.wanted)) if end is End.SOLVED else None


def advanced(solver: Prepared, state: State, increment: Increment, accuracy: float) -> State:
    """The state after a Newton step. An iterative solver, asked for ``accuracy`` of the residual, goes on where forces are
    so far from balance that the state says nothing."""
    system, asked = solver.system, increment.settings.accuracy
    for _ in range(1 if solver.exact else increment.settings.newton.patience):
        state = advance(solver, state, friction_laws(system, state), accuracy)
        left = imbalance(system, state, increment)
        if left <= asked.told:
            break
        accuracy = float(np.clip(asked.told / left, asked.stride, asked.spare))
    return state


def foreseen(solver: Prepared, state: State, wanted: NDArray[np.int8]) -> NDArray[np.int8]:
    """The status (n,) to go on with where the laws ask for ``wanted``: closed where half spaces without friction close, and
    stuck where that is new. What of it slips only a solution tells."""
    pairs, split = solver.system.pairs, solver.system.split
    beside = solver.system.join([_beside(pair) for pair in pairs]).astype(bool)
    gap = solver.system.gap(state)
    closed = split(solver.foresee(gap, state.multipliers, (wanted != OPEN) | beside, beside))
    return solver.system.join([_with(*part) for part in zip(pairs, split(wanted), closed)])


def _beside(pair: Pair) -> NDArray[np.bool_]:
    """Multipliers that never open by themselves, (n,)."""
    return np.arange(len(pair)) >= (0 if pair.decided else len(pair.space))


def _with(pair: Pair, wanted: NDArray[np.int8], closed: NDArray[np.bool_]) -> NDArray[np.int8]:
    if pair.decided:
        return wanted
    shut = np.asarray(pair.of_functions(closed[pair.normal]))
    return np.where(shut, np.where(wanted == OPEN, CLOSED, wanted), OPEN)
