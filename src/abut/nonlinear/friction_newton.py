"""Semi-smooth Newton on contact and slip together."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from abut.linear.solver import Prepared
from abut.nonlinear.friction_foresight import advanced, foreseen
from abut.nonlinear.friction_laws import Status, friction_laws, next_status
from abut.nonlinear.iteration import (
    Found,
    Increment,
    largest_pressure,
    points,
    report,
)
from abut.solution import Iteration
from abut.solution.state import State

Vector = NDArray[np.float64]


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
        row = report(self.solver.system, state, self.increment, len(self.done) + 1, changed, np.zeros(1), seconds)
        row = replace(row, contact_residual=float(missed / largest))
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


def newton(course: Course, first: State, limit: int) -> Found | None:
    """Semi-smooth Newton from a state and its status, in whole steps; None where it gives up.

    It does as soon as a status comes back, or nothing gets better any more."""
    system, state = course.solver.system, first
    seen: set[bytes] = set()
    fewest, least, before, idle = len(first.status) + 1, np.inf, np.inf, 0
    settings, asked = course.increment.settings.newton, course.increment.settings.accuracy
    tolerance, accuracy = max(settings.balanced, course.solver.accurate), asked.rough
    foreseen_other, last = False, 0
    for _ in range(limit):
        clock = time.perf_counter()
        following = advanced(course.solver, state, friction_laws, course.increment, accuracy)
        wanted = next_status(system, following, course.increment)
        changed = points(system, wanted != state.status)
        state = following.with_status(wanted)
        left = course.add(state, changed, clock)
        if not changed and (left <= tolerance or (left <= settings.stalled and left > 0.5 * before)):
            return course.found(state)
        better = changed < fewest or (changed == 0 and left < 0.5 * least)
        idle = 0 if better else idle + 1
        if idle >= settings.patience or (changed and wanted.tobytes() in seen):
            return None
        fewest, least = min(fewest, changed), min(least, left)
        before = left if not changed else np.inf
        accuracy = asked.rough if changed else max(asked.spare * tolerance / left, asked.stride)
        seen.add(wanted.tobytes())
        misled, foreseen_other = foreseen_other and changed >= last, False
        last = changed
        if changed and not misled:
            status = foreseen(course.solver, following, wanted)
            foreseen_other = not np.array_equal(status, wanted)
            state = state.with_status(status)
    return None
