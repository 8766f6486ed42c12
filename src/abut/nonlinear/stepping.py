"""Load stepping: the end of the next load step, and the treatment of failed attempts."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from abut.linear.solver import LinearSolver, NotConverged
from abut.nonlinear.iteration import Increment
from abut.nonlinear.load_step import Attempt, load_step
from abut.nonlinear.newton import Task
from abut.problem.problem import ContactProblem
from abut.solution import Iteration
from abut.solution.state import State

NO_TIME = 1e-12  # times that differ by less are the same


class Schedule(Protocol):
    """When load steps end."""

    def next(self, attempt: Attempt | None) -> float | None:
        """The time at which the next attempt ends, after the last one (None: before the first); None at the end."""
        ...

    def whole(self, time: float) -> bool:
        """Whether a step is to end at a time, not a part of one."""
        ...


@dataclass(frozen=True)
class Fixed:
    """Load steps that end at given times, each attempted once."""

    times: Sequence[float]

    def next(self, attempt: Attempt | None) -> float | None:
        """As in ``Schedule``."""
        if attempt is None:
            return self.times[0] if self.times else None
        if not attempt.converged:
            return None
        return next((time for time in self.times if time > attempt.state.time), None)

    def whole(self, time: float) -> bool:
        """As in ``Schedule``."""
        return True


class Automatic:
    """Load steps that end at given times and, where one does not converge, in between: half as far, and twice as far again
    after each that does. smallest: share of the way to the next given time below which it gives up."""

    def __init__(self, times: Sequence[float], begin: float = 0.0, smallest: float = 1.0 / 64.0) -> None:
        self._times, self._smallest = times, smallest
        self._begin, self._from, self._share = begin, begin, 1.0

    def next(self, attempt: Attempt | None) -> float | None:
        """As in ``Schedule``."""
        if attempt is not None and attempt.converged:
            self._from, self._share = attempt.state.time, min(2.0 * self._share, 1.0)
        goal = next((time for time in self._times if time > self._from * (1.0 + NO_TIME)), None)
        if goal is None:
            return None
        whole = goal - max((time for time in self._times if time < goal), default=self._begin)
        if attempt is not None and not attempt.converged:
            self._share = 0.5 * (attempt.time - self._from) / whole
        if self._share < self._smallest:
            return None
        reached = self._from + self._share * whole
        return goal if reached > goal * (1.0 - NO_TIME) else reached

    def whole(self, time: float) -> bool:
        """As in ``Schedule``."""
        return time in self._times


@dataclass(frozen=True)
class Control:
    """limit: of iterations in a step; observe: called with each of them; begins: called with each step's number and end;
    prepares: called before a linear solver is set up; prepared: called with its note; fallback: another solver where one
    fails; halves: called with an attempt that failed and the end of the next one."""

    limit: int
    observe: Callable[[Iteration], None]
    begins: Callable[[int, float], None]
    prepares: Callable[[LinearSolver], None]
    prepared: Callable[[str], None]
    fallback: Callable[[int, NotConverged], LinearSolver]
    halves: Callable[[Attempt, float], None]


def march(
    problem: ContactProblem, first: State, schedule: Schedule, solver: LinearSolver, control: Control, number: int = 1
) -> Iterator[Attempt]:
    """Load step after load step, from the state ``first``; number: of the next one.

    Each attempt starts from the last converged state: the state of a failed one is dropped, and yielded only where no other
    follows it; attempts that are parts of a step have its number; a solver that fails is replaced by another one, which
    begins the step again."""
    before, attempt = first, None
    condensed, prepared = None, None
    time = schedule.next(attempt)
    while time is not None:
        told = False
        while True:
            if condensed is None or prepared is None:
                control.prepares(solver)
                condensed = solver.condensed(problem)
                prepared = solver.prepare(condensed.linearise(before, before), None)
                control.prepared(solver.note(prepared))
            if not told:
                control.begins(number, time)
                told = True
            task = Task(condensed, before, solver, Increment(number, before.largest), control.limit, control.observe)
            try:
                attempt = replace(load_step(task, time, prepared), whole=schedule.whole(time))
                break
            except NotConverged as reason:
                solver, condensed, prepared = control.fallback(number, reason), None, None
        time = schedule.next(attempt)
        if attempt.converged or time is None:
            yield attempt
        else:
            control.halves(attempt, time)
        if attempt.converged:
            before, number = attempt.state, number + attempt.whole
