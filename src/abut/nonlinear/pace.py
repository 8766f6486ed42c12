"""The ends of load steps: how long the next one is."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from abut.model.conditions import History
from abut.model.step_ends import SAME as NEAR
from abut.model.step_ends import apart, named_times
from abut.nonlinear.settings import DEFAULT, Settings
from abut.problem.onset import Onset

NO_ONSET = Onset()


@dataclass(frozen=True)
class Slips:
    """That contacts may begin to slip. fits: some press before loads do anything, which a first step as short as can be
    shows."""

    fits: bool = False


class Pace:
    """The ends of load steps. goals: times that are met, increasing, the last one is the end; longest: step, a time; legs:
    goals after which the step takes the share ``first`` of the way to the next of them; kinks: of histories, where the way
    ahead is new; given: the goals are the load steps, however many iterations they take, and what ends between is a part
    of one, at least this share of the way; slips: steps are as short as the onset of slip asks for; settings: thresholds."""

    def __init__(
        self, goals: Sequence[float], longest: float = 1.0, first: float | None = None, legs: Sequence[float] = (),
        kinks: Sequence[float] = (), given: float | None = None, slips: Slips | None = None, settings: Settings = DEFAULT,
    ) -> None:  # fmt: skip
        self._goals, self._longest, self._kinks, self._given = goals, longest, kinks, given is not None
        self._smallest = settings.steps.smallest if given is None else given
        self._settings, self._same, self._follows = settings.steps, settings.newton.rounding, slips is not None
        self._share = self._settings.first if first is None else first
        self._legs = [*(leg for leg in legs if leg < goals[-1] - self._same), goals[-1]]
        self.time = 0.0
        self._length = self._fresh()  # as iterations tell
        self._fits = slips is not None and slips.fits
        self._curve = self._settings.smallest * self._leg if self._fits else math.inf  # as the onset of slip asks for
        self._goes_on, self._begun = False, 0.0

    @property
    def goal(self) -> float | None:
        """The next one; None at the end."""
        return next((goal for goal in self._goals if goal > self.time + self._same), None)

    @property
    def end(self) -> float | None:
        """Of the next step."""
        goal = self.goal
        if goal is None:
            return None
        left, length = goal - self.time, min(self._length, self._curve)
        if left <= length * (1.0 + self._same):
            return goal
        return self.time + min(length, 0.5 * left if left < 2.0 * length else left)

    def whole(self, time: float) -> bool:
        """Whether what ends at a time is a load step, not a part of one."""
        return self._follows or not self._given or time in self._goals

    @property
    def turned(self) -> bool:
        """Whether the way ahead is new."""
        return any(abs(self.time - kink) <= NEAR for kink in self._kinks)

    @property
    def goes_on(self) -> bool:
        """Whether tractions go on as in the last step: neither a new way nor what a fit had alone."""
        return self._goes_on and not self.turned

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
        self._length, self._curve = min(share * self._leg, self._longest), math.inf

    def refine(self, onset: Onset) -> bool:
        """Whether the step to ``end``, which has converged, jumps over the onset of slip: a shorter one goes before it."""
        end, factor = self.end, self._next(onset)
        assert end is not None
        steps = self._settings
        length = max(1.0 / steps.points, steps.aim * factor) * (end - self.time)
        if not self._follows or self._followed or factor >= 0.5 or length < steps.smallest * self._leg:
            return False
        self._curve = self._rounded(length)
        return True

    def take(self, iterations: int, landed: float = 0.0, onset: Onset = NO_ONSET, at: float | None = None) -> None:
        """The step to ``end`` has converged in so many iterations; landed: share of friction that touched and stuck; at:
        where it ended, if not there."""
        end = self.end if at is None else at
        assert end is not None
        first, taken, limited = self._fits and self.time == 0.0, end - self.time, self._curve < self._length
        self.time, self._goes_on = end, not first
        if any(abs(end - leg) < self._same for leg in self._legs):
            self._length, self._curve, self._goes_on, self._begun = self._fresh(), math.inf, False, 0.0
            return
        self._begun = 0.0 if first or self.turned else self._begun + onset.begun
        if self._follows:
            ahead = (
                onset if onset.sticks > 0.0 else replace(onset, fresh=onset.turns)
            )  # where all slips it may only turn
            free = first or self._followed or (ahead.sticks <= 0.0 and math.isinf(self._next(ahead)))
            self._curve = math.inf if free else self._rounded(self._factor(ahead) * taken)
        steps = self._settings
        hard = iterations > 2 * steps.easy
        factor = steps.growth if iterations <= steps.easy else steps.shrink if hard else 1.0
        factor = 2.0 if self._given else factor
        if self._share < 1.0 and landed > 0.0:
            factor = min(factor, max(0.5, math.sqrt(steps.missed / landed)))
        if not limited or (factor < 1.0 and not first):
            self._length = min(factor * (taken if limited else self._length), self._longest)

    def repeat(
        self, time: float, iterations: int, landed: float = 0.0, onset: Onset = NO_ONSET, stride: float | None = None
    ) -> None:
        """Take a step of an earlier run that ended at ``time``, perhaps one of a share ``stride``."""
        length = self._length
        if stride is not None:
            self.stride(stride)
            if self.end is None or abs(self.end - time) >= self._same:
                self._length = length
        while self.end is not None and self.end > time + self._same and not self.stuck:
            self.halve()
        if self._follows and self.end is not None and abs(self.end - time) > self._same:
            self._length, self._curve = length, time - self.time
        self.take(iterations, landed, onset, at=time)

    def _rounded(self, length: float) -> float:
        """Down to a fourth root of a power of two of the way to the next goal, lest the digits in which solvers, numbers of
        processes and units differ make other steps."""
        quarters = math.floor(4.0 * math.log2(length / self._leg) + 1e-6)
        return float(self._leg * 2.0 ** (quarters / 4.0))

    def _factor(self, onset: Onset) -> float:
        """How much longer the next step is than one with an onset of slip that was taken."""
        longest = 2.0 if onset.shares[0] > self._same else float(self._settings.points)
        return min(longest, onset.ahead, self._settings.aim * self._next(onset))

    def _next(self, onset: Onset) -> float:
        """How much longer a step may be than the one that shows an onset of slip, theory (R21)."""
        fresh, bent = onset.shares
        if fresh <= self._same or bent <= 0.0:
            return math.inf
        return max(1.0 / (self._settings.points * fresh), math.sqrt(self._settings.missed / bent))

    @property
    def _followed(self) -> bool:
        """Whether as much as carries all of friction has begun to slip since the way ahead was new: what sticks and begins
        again has had its points."""
        return self._begun >= 1.0 - self._same

    @property
    def _leg(self) -> float:
        begin = max((leg for leg in self._legs[:-1] if leg <= self.time + self._same), default=0.0)
        return next(leg for leg in self._legs if leg > begin + self._same) - begin

    def _fresh(self) -> float:
        return min(self._share * self._leg, self._longest)


def given_pace(
    ends: Sequence[float], parts: bool = True, slips: Slips | None = None, settings: Settings = DEFAULT
) -> Pace:
    """Load steps that end at given times; parts: those that fail are taken in parts, down to the root of the smallest share
    (a sixty-fourth); slips: there are further ones where contact begins to slip."""
    smallest = settings.steps.smallest**0.5 if parts else 1.0
    return Pace(ends, first=1.0, legs=ends[:-1], kinks=ends[:-1], given=smallest, slips=slips, settings=settings)


def pace_of(
    steps: int | str, times: Sequence[float] | None, histories: Sequence[History], slips: Slips | None = None,
    settings: Settings = DEFAULT,
) -> Pace:  # fmt: skip
    """From what a user says of the steps: their number is that of the longest ones, "auto" leaves them all to this, and to
    contacts that may slip; times are met, each in one step if it can be."""
    named, turns = named_times(histories)
    if times:
        goals = sorted([*times, *apart([time for time in named if time < times[-1]], times)])
        return Pace(goals, first=1.0, legs=goals[:-1], kinks=turns, settings=settings)
    if isinstance(steps, str):
        return Pace([*named, 1.0], legs=turns, kinks=turns, slips=slips, settings=settings)
    return Pace([*named, 1.0], 1.0 / steps, first=1.0, legs=turns, kinks=turns, settings=settings)
