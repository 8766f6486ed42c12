"""Load stepping: step after step, each from the last converged state, in parts or shorter ones where it fails."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from abut.linear.solver import LinearSolver, NotConverged
from abut.nonlinear.attempt import Attempt
from abut.nonlinear.pace import Pace
from abut.nonlinear.settings import DEFAULT, Settings
from abut.problem.onset import Onset
from abut.problem.step_error import landed_in
from abut.solution import Iteration
from abut.solution.state import State


@dataclass(frozen=True)
class Control:
    """limit: of iterations in a step; observe: called with each of them; begins: called with each step's number and end;
    prepares: called before a linear solver is set up; prepared: called with its note; fallback: another solver where one
    fails; halves: called with an attempt that failed and the end of the next one; onset: of slip between two
    states, after another one if what it shows goes on;
    refines: called with a step that jumps over it and the end of the next one; settings: thresholds."""

    limit: int
    observe: Callable[[Iteration], None]
    begins: Callable[[int, float], None]
    prepares: Callable[[LinearSolver], None]
    prepared: Callable[[str], None]
    fallback: Callable[[int, NotConverged], LinearSolver]
    halves: Callable[[Attempt, float], None]
    onset: Callable[[State | None, State, State], Onset]
    refines: Callable[[Attempt, float], None]
    settings: Settings = DEFAULT


@dataclass(frozen=True)
class Begin:
    """Where a load step begins. number: its own; before: the last converged state; earlier: the one before that, None where
    there is none; cuts: how often it has been halved."""

    number: int
    before: State
    earlier: State | None = None
    cuts: int = 0


class Stepper(Protocol):
    """How the load steps of a problem are solved."""

    def prepare(self) -> None:
        """Set up what serves all iterations, before a step is told of."""
        ...

    def attempts(self, begin: Begin, pace: Pace) -> Sequence[Attempt]:
        """The step to the end that ``pace`` tells: its parts, or the one that has failed. Raises NotConverged where the
        linear solver fails."""
        ...

    def replace(self, solver: LinearSolver) -> None:
        """Go on with another linear solver."""
        ...

    def end(self) -> None:
        """The step has converged."""
        ...


def march(stepper: Stepper, done: Sequence[State], pace: Pace, control: Control) -> Iterator[Attempt]:
    """Load step after load step. done: the converged states so far, from the start on; pace: after the last of them.

    The state of a failed attempt is dropped, as is one that jumps over the onset of slip; it is yielded only where no other
    follows it. Parts of a step have its number.
    Where a linear solver fails another one begins the step again."""
    number, told = len(done), False
    begin = Begin(number, done[-1], done[-2] if len(done) > 1 else None)
    while (time := pace.end) is not None:
        try:
            stepper.prepare()
            if not told:
                control.begins(begin.number, time)
                told = True
            shortest = pace.last
            attempts = stepper.attempts(begin, pace)
        except NotConverged as reason:
            stepper.replace(control.fallback(begin.number, reason))
            continue
        last = attempts[-1]
        if not last.converged and shortest:
            yield last
            return
        if not last.converged:
            begin = replace(begin, cuts=begin.cuts + 1)
            pace.halve()
            control.halves(last, pace.end or time)
            continue
        onset = control.onset(begin.earlier if pace.goes_on else None, begin.before, last.state)
        if len(attempts) == 1 and pace.refine(onset):
            control.refines(last, pace.end or time)
            continue
        last = replace(last, whole=pace.whole(last.time))
        pace.take(sum(len(part.iterations) for part in attempts), landed_in(last.state).share, onset)
        stepper.end()
        yield from (*attempts[:-1], last)
        begin, told = Begin(begin.number + last.whole, last.state, begin.before), False
