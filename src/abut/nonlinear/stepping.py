"""Load steps at small displacements: one linear solver serves them all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from abut.linear.solver import LinearSolver, Prepared
from abut.nonlinear.active_set import solve_step
from abut.nonlinear.again import Again
from abut.nonlinear.attempt import UNSTEADY, Attempt
from abut.nonlinear.frames import Solved, in_frame_of_end
from abut.nonlinear.iteration import Increment
from abut.nonlinear.load_step import Task, load_step
from abut.nonlinear.march import Begin, Control
from abut.nonlinear.pace import Pace
from abut.nonlinear.settings import Settings
from abut.problem.frame import Frame
from abut.problem.problem import ContactProblem
from abut.solution.state import State


class SmallSteps:
    """As ``Stepper``, at small displacements. first: the state that the run begins with."""

    def __init__(self, problem: ContactProblem, first: State, solver: LinearSolver, control: Control) -> None:
        self._problem, self._first, self._solver, self._control = problem, first, solver, control
        self._ready: Again | None = None

    def again(self) -> Again:
        """What it takes to solve steps again."""
        self.prepare()
        assert self._ready is not None
        return self._ready

    def prepare(self) -> None:
        """Set up what serves all iterations, as in ``Stepper``."""
        if self._ready is None:
            self._control.prepares(self._solver)
            self._ready = prepared(self._problem, self._solver, self._first, self._control.settings)
            self._control.prepared(self._solver.note(self._ready.prepared))

    def attempts(self, begin: Begin, pace: Pace) -> Sequence[Attempt]:
        """The step, or its parts, as in ``Stepper``."""
        assert pace.end is not None
        ready, increment = self.again(), Increment(begin.number, begin.before.largest, self._control.settings)
        task = Task(
            ready.problem, begin.before, ready.solver, increment, ready.limit, self._control.observe, ready.search
        )
        solved = _Solved(task, ready.prepared, load_step(task, pace.end, ready.prepared))
        solved = in_frame_of_end(self._problem, solved, self._control.settings.steps.solutions)
        return [self._sound(solved.attempt)]

    def _sound(self, attempt: Attempt) -> Attempt:
        """An attempt, or one that has not converged: iterations of metal that flows may leave the solution so far behind
        that what is out of balance is small beside the forces that they have come to."""
        extent = float(np.ptp(self._problem.model.mesh.points, axis=0).max())
        largest = float(np.abs(self._problem.displacement(attempt.state)).max(initial=0.0))
        most = self._control.settings.holding.absurd
        if self._problem.constant or not attempt.converged or largest < most * extent:
            return attempt
        reason = f"displacements of {largest:.2g} exceed {most:g} times the model size {extent:.2g}"
        return replace(attempt, converged=False, reason=reason, balance=None)

    def replace(self, solver: LinearSolver) -> None:
        """Go on with another linear solver, as in ``Stepper``: for all steps to come."""
        self._solver, self._ready = solver, None

    def end(self) -> None:
        """The step has converged, as in ``Stepper``."""


@dataclass(frozen=True)
class _Solved(Solved):
    """As in ``Solved``; attempt: with the iterations in all frames."""

    task: Task
    prepared: Prepared
    attempt: Attempt

    @property
    def before(self) -> State:
        return self.task.before

    @property
    def frame(self) -> Frame:
        return self.task.frame

    @property
    def end(self) -> State:
        return self.attempt.state

    @property
    def converged(self) -> bool:
        return self.attempt.converged

    def again(self, before: State, frame: Frame, guess: State) -> _Solved:
        """As in ``Solved``, from its beginning."""
        task = replace(self.task, before=before, given=frame)
        attempt = load_step(task, self.attempt.time, self.prepared)
        attempt = replace(attempt, iterations=(*self.attempt.iterations, *attempt.iterations))
        return replace(self, task=task, attempt=attempt)

    def unsteady(self) -> _Solved:
        return replace(self, attempt=replace(self.attempt, converged=False, reason=UNSTEADY))


def prepared(problem: ContactProblem, solver: LinearSolver, state: State, settings: Settings) -> Again:
    """Of a run that has not begun to solve; state: any of the problem."""
    condensed = solver.condensed(problem)
    system = condensed.linearise(state, condensed.frame(state), condensed.restrict(state))
    limit = problem.model.solve.max_iterations
    return Again(condensed, solver, solver.prepare(system, None), limit, settings, solve_step)
