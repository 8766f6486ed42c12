"""The ends of load steps: how long the next one is."""

from __future__ import annotations

import math
from collections.abc import Sequence

from abut.model.conditions import History
from abut.model.step_ends import SAME as NEAR
from abut.model.step_ends import apart, named_times

FIRST = 0.1  # of the way to the next goal
EASY, GROWTH = 6, 1.5  # iterations up to which the next step is longer, and by how much
HARD, SHRINK = 12, 0.7  # iterations above which it is shorter
LANDED = 0.01  # share of friction at points that touch and stick in one step, theory (G21), before it is shortened
LEAST = 0.5  # by how much at most
SMALLEST, LAST = 1.0 / 4096.0, 1.0 / 64.0  # of the way to the next goal; the same of steps that a user has given
SAME = 1e-12  # times that differ by less are the same


class Pace:
    """The ends of load steps. goals: times that are met, increasing, the last one is the end; longest: step, a time; legs:
    goals after which the step takes the share ``first`` of the way to the next of them; kinks: of histories, where the way
    ahead is new; given: the goals are the load steps, however many iterations they take, and what ends between is a part
    of one; smallest: share of the way to the next goal below which a step is too short."""

    def __init__(
        self, goals: Sequence[float], longest: float = 1.0, first: float = FIRST, legs: Sequence[float] = (),
        kinks: Sequence[float] = (), given: bool = False, smallest: float = SMALLEST,
    ) -> None:  # fmt: skip
        self._goals, self._longest, self._share, self._kinks = goals, longest, first, kinks
        self._given, self._smallest = given, smallest
        self._legs = [*(leg for leg in legs if leg < goals[-1] - SAME), goals[-1]]
        self.time = 0.0
        self._length = self._fresh()

    @property
    def goal(self) -> float | None:
        """The next one; None at the end."""
        return next((goal for goal in self._goals if goal > self.time + SAME), None)

    @property
    def end(self) -> float | None:
        """Of the next step."""
        goal = self.goal
        if goal is None:
            return None
        left = goal - self.time
        if left <= self._length * (1.0 + SAME):
            return goal
        return self.time + min(self._length, 0.5 * left if left < 2.0 * self._length else left)

    def whole(self, time: float) -> bool:
        """Whether what ends at a time is a load step, not a part of one."""
        return not self._given or time in self._goals

    @property
    def turned(self) -> bool:
        """Whether the way ahead is new."""
        return any(abs(self.time - kink) <= NEAR for kink in self._kinks)

    @property
    def stuck(self) -> bool:
        """Whether steps have become too short."""
        return self._length < self._smallest * self._leg

    @property
    def last(self) -> bool:
        """Whether steps are too short when the next one fails."""
        end = self.end
        return end is None or 0.5 * (end - self.time) < self._smallest * self._leg

    def halve(self) -> None:
        """After a step that failed."""
        end = self.end
        assert end is not None
        self._length = 0.5 * (end - self.time)

    def stride(self, share: float) -> None:
        """Go on with a step of a share of the way to the next goal, whatever failed."""
        self._length = min(share * self._leg, self._longest)

    def take(self, iterations: int, landed: float = 0.0) -> None:
        """The step to ``end`` has converged in so many iterations; landed: share of friction that touched and stuck."""
        end = self.end
        assert end is not None
        self.time = end
        if any(abs(end - leg) < SAME for leg in self._legs):
            self._length = self._fresh()
            return
        factor = GROWTH if iterations <= EASY else SHRINK if iterations > HARD else 1.0
        factor = 2.0 if self._given else factor
        if self._share < 1.0 and landed > 0.0:
            factor = min(factor, max(LEAST, math.sqrt(LANDED / landed)))
        self._length = min(factor * self._length, self._longest)

    def repeat(self, time: float, iterations: int, landed: float = 0.0, strides: Sequence[float] = ()) -> None:
        """Take a step of an earlier run that ended at ``time``, perhaps one of ``strides``."""
        length = self._length
        for share in strides:
            self.stride(share)
            if self.end is not None and abs(self.end - time) < SAME:
                break
            self._length = length
        while self.end is not None and self.end > time + SAME and not self.stuck:
            self.halve()
        self.take(iterations, landed)
        self.time = time

    @property
    def _leg(self) -> float:
        begin = max((leg for leg in self._legs[:-1] if leg <= self.time + SAME), default=0.0)
        return next(leg for leg in self._legs if leg > begin + SAME) - begin

    def _fresh(self) -> float:
        return min(self._share * self._leg, self._longest)


def given_pace(ends: Sequence[float], parts: bool = True) -> Pace:
    """Load steps that end at given times; parts: those that fail are taken in parts, down to a sixty-fourth."""
    return Pace(ends, first=1.0, legs=ends[:-1], given=True, smallest=LAST if parts else 1.0)


def pace_of(steps: int | str, times: Sequence[float] | None, histories: Sequence[History]) -> Pace:
    """From what a user says of the steps: their number is that of the longest ones, "auto" leaves them all to this; times
    are met, each in one step if it can be."""
    named, turns = named_times(histories)
    if times:
        goals = sorted([*times, *apart([time for time in named if time < times[-1]], times)])
        return Pace(goals, first=1.0, legs=goals[:-1], kinks=turns)
    if isinstance(steps, str):
        return Pace([*named, 1.0], legs=turns, kinks=turns)
    return Pace([*named, 1.0], 1.0 / steps, first=1.0, legs=turns, kinks=turns)
