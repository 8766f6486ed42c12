"""Automatic load steps at large displacements: how long the next one is."""

from __future__ import annotations

from collections.abc import Sequence

from abut.model.conditions import History

FIRST = 0.1  # of the way to the next goal
EASY, GROWTH = 6, 1.5  # iterations up to which the next step is longer, and by how much
HARD, SHRINK = 12, 0.7  # iterations above which it is shorter
SMALLEST = 1.0 / 4096.0  # of the way to the next goal
SAME = 1e-12  # times that differ by less are the same


class Pace:
    """The ends of load steps. goals: times that are met, increasing, the last one is the end; longest: step, a time; first:
    share of the way to a goal in its first step; turns: goals at which a history has a kink, so that the way ahead is new."""

    def __init__(
        self, goals: Sequence[float], longest: float = 1.0, first: float = FIRST, turns: Sequence[float] = ()
    ) -> None:
        self._goals, self._longest, self._share, self.turns = goals, longest, first, turns
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

    @property
    def stuck(self) -> bool:
        """Whether steps have become too short."""
        return self._length < SMALLEST * self._way

    def halve(self) -> None:
        """After a step that failed."""
        end = self.end
        assert end is not None
        self._length = 0.5 * (end - self.time)

    def take(self, iterations: int) -> None:
        """The step to ``end`` has converged in so many iterations."""
        end, goal = self.end, self.goal
        assert end is not None
        self.time = end
        if end == goal:
            self._length = self._fresh()
            return
        factor = GROWTH if iterations <= EASY else SHRINK if iterations > HARD else 1.0
        self._length = min(factor * self._length, self._longest)

    def repeat(self, time: float, iterations: int) -> None:
        """Take a step of an earlier run that ended at ``time``."""
        while self.end is not None and self.end > time + SAME and not self.stuck:
            self.halve()
        self.take(iterations)
        self.time = time

    @property
    def _way(self) -> float:
        """From the goal before the next step to the one after it."""
        goal = self.goal or self._goals[-1]
        return goal - max((own for own in self._goals if own < goal - SAME), default=0.0)

    def _fresh(self) -> float:
        return min(self._share * self._way, self._longest)


def kinks(histories: Sequence[History]) -> list[float]:
    """Times between the ends at which what is prescribed changes its direction."""
    times = {time for history in histories if history is not None for time, _ in history.points}
    return sorted(time for time in times if 0.0 < time < 1.0)


def pace_of(steps: int, times: Sequence[float] | None, histories: Sequence[History]) -> Pace:
    """From what a user says of the steps: their number is that of the longest ones; times are met, each in one step if
    it can be."""
    turns = kinks(histories)
    last = times[-1] if times else 1.0
    goals = [goal for goal in sorted({*turns, *(times or (1.0,))}) if goal <= last]
    if times:
        return Pace(goals, first=1.0, turns=turns)
    return Pace(goals, turns=turns) if steps == 1 else Pace(goals, 1.0 / steps, first=1.0, turns=turns)
