"""Semi-smooth Newton on contact and slip together, and the status that the laws ask for."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from abut.contact.laws import Complementarity, Coulomb, Tied
from abut.linear.solver import Prepared
from abut.nonlinear.exact import ROUGH, STRIDE
from abut.nonlinear.friction_foresight import advanced, foreseen
from abut.nonlinear.iteration import (
    FLAT,
    NO_PRESSURE,
    Found,
    Increment,
    largest_pressure,
    points,
    report,
)
from abut.problem.laws import LawRows, at_multipliers, giving
from abut.problem.linearised import Linearised
from abut.problem.pair import Pair
from abut.solution import Iteration
from abut.solution.state import CLOSED, OPEN, SLIPPING, State

TOLERANCE = 1e-10  # of the laws over the largest pressure, and of equilibrium over the largest force
STALLED = 1e-7  # the same that may be left where it no longer falls
PATIENCE = 3  # iterations in which neither fewer change than ever nor less is left than half of ever
RECENT = 6  # iterations whose statuses tell which multipliers keep changing
Vector = NDArray[np.float64]
Status = NDArray[np.int8]


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
        self.recent = [*self.recent[1 - RECENT :], state.status]
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


def newton(course: Course, first: State, limit: int, patience: int = PATIENCE) -> Found | None:
    """Semi-smooth Newton from a state and its status, in whole steps; None where it gives up.

    It does as soon as a status comes back, or nothing gets better any more."""
    system, state = course.solver.system, first
    seen: set[bytes] = set()
    fewest, least, before, idle = len(first.status) + 1, np.inf, np.inf, 0
    tolerance, accuracy = tolerated(course.solver), ROUGH
    foreseen_other, last = False, 0
    for _ in range(limit):
        clock = time.perf_counter()
        following = advanced(course.solver, state, friction_laws, course.increment, accuracy)
        wanted = next_status(system, following, course.increment)
        changed = points(system, wanted != state.status)
        state = following.with_status(wanted)
        left = course.add(state, changed, clock)
        if not changed and (left <= tolerance or (left <= STALLED and left > 0.5 * before)):
            return course.found(state)
        better = changed < fewest or (changed == 0 and left < 0.5 * least)
        idle = 0 if better else idle + 1
        if idle >= patience or (changed and wanted.tobytes() in seen):
            return None
        fewest, least = min(fewest, changed), min(least, left)
        before = left if not changed else np.inf
        accuracy = ROUGH if changed else max(0.3 * tolerance / left, STRIDE)
        seen.add(wanted.tobytes())
        misled, foreseen_other = foreseen_other and changed >= last, False
        last = changed
        if changed and not misled:
            status = foreseen(course.solver, following, wanted)
            foreseen_other = not np.array_equal(status, wanted)
            state = state.with_status(status)
    return None


def tolerated(solver: Prepared) -> float:
    """What laws and equilibrium may have left, over the largest pressure and force."""
    return TOLERANCE if solver.exact else max(TOLERANCE, solver.accurate)


def friction_laws(system: Linearised, state: State) -> list[LawRows]:
    """The laws of all pairs with the status as it is."""
    parts = (system.gap(state), state.multipliers, state.closed, state.slipping)
    return [
        giving(
            pair,
            at_multipliers(pair, _law(pair, system), gap, multipliers, closed, slipping if pair.frictional else None),
        )
        for pair, gap, multipliers, closed, slipping in zip(system.pairs, *map(system.split, parts))
    ]


def _law(pair: Pair, system: Linearised) -> Tied | Coulomb | Complementarity:
    if pair.tied:
        return Tied()
    if not pair.frictional:
        return Complementarity(pair.stiffness)
    return coulomb(pair, system)


def coulomb(pair: Pair, system: Linearised) -> Coulomb:
    """The law of a pair with friction."""
    return Coulomb(pair.stiffness, pair.friction(system.factors))


def next_status(system: Linearised, state: State, increment: Increment, gap: Vector | None = None) -> Status:
    """The status that the laws ask for, theory (R5), (R6), of each multiplier. What differs by rounding alone stays.
    gap: (n,) weighted gaps and slips to judge by; left out: those of the state."""
    if not len(state.multipliers):
        return state.status
    pressed = np.concatenate([np.zeros(0), *(p[pair.normal] for pair, p in _contacts(system, state.multipliers))])
    reference = float(np.abs(pressed).max(initial=increment.largest.pressure))
    small = FLAT * max(reference, NO_PRESSURE)
    gap = system.gap(state) if gap is None else gap
    gaps, multipliers, before = (system.split(part) for part in (gap, state.multipliers, state.status))
    return system.join(
        [
            np.full(len(pair), CLOSED) if pair.two_way else _wanted(pair, system.factors, gap, part, status, small)
            for pair, gap, part, status in zip(system.pairs, gaps, multipliers, before)
        ]
    )


def _contacts(system: Linearised, values: Vector) -> list[tuple[Pair, Vector]]:
    return [(pair, part) for pair, part in zip(system.pairs, system.split(values)) if not pair.tied]


def _wanted(pair: Pair, factors: Vector, gap: Vector, multipliers: Vector, status: Status, small: float) -> Status:
    normal, earlier = pair.normal, status[pair.normal]
    depth = -gap[normal] / pair.scale[normal]
    pushed = multipliers[normal] + depth
    closed = np.where(earlier != OPEN, pushed >= -small, pushed > small)
    result = np.where(closed, CLOSED, OPEN)
    if not pair.frictional:
        return result
    limit = pair.friction(factors)
    if not limit.rough:
        drag = pair.tangential_traction(multipliers)
        trial = pair.tangential_traction(multipliers - gap / pair.scale)
        size = np.linalg.norm(trial, axis=1)
        excess = size - limit.at(np.maximum(pushed, 0.0))[0]
        back = (
            np.einsum("kd,kd->k", drag, trial) < -small * size
        )  # slips the way it is pulled: it sticks before it slips back
        slips = np.where(earlier == SLIPPING, (excess >= -small) & ~back, excess > small)
        result = np.where(closed & ((slips & (size > small)) | limit.none), SLIPPING, result)
    return np.asarray(pair.of_functions(result))
