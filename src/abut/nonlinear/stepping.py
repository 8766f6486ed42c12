"""Load steps at small displacements: one linear solver serves them all."""

from __future__ import annotations

from collections.abc import Sequence

from abut.linear.solver import LinearSolver, Prepared
from abut.nonlinear.again import Again
from abut.nonlinear.iteration import Increment
from abut.nonlinear.load_step import Attempt, load_step
from abut.nonlinear.march import Begin, Control
from abut.nonlinear.newton import Task
from abut.nonlinear.pace import Pace
from abut.problem.problem import ContactProblem, Problem
from abut.solution.state import State


class SmallSteps:
    """As ``Stepper``, at small displacements. first: the state that the run begins with."""

    def __init__(self, problem: ContactProblem, first: State, solver: LinearSolver, control: Control) -> None:
        self._problem, self._first, self._solver, self._control = problem, first, solver, control
        self._ready: tuple[Problem, Prepared] | None = None

    def again(self) -> Again:
        """What it takes to solve steps again."""
        if self._ready is None:
            self.prepare()
        assert self._ready is not None
        return Again(self._ready[0], self._solver, self._ready[1], self._control.limit, self._control.settings)

    def prepare(self) -> None:
        """As in ``Stepper``."""
        if self._ready is None:
            self._control.prepares(self._solver)
            condensed = self._solver.condensed(self._problem)
            first = condensed.linearise(self._first, condensed.frame(self._first), self._first)
            self._ready = condensed, self._solver.prepare(first, None)
            self._control.prepared(self._solver.note(self._ready[1]))

    def attempts(self, begin: Begin, pace: Pace) -> Sequence[Attempt]:
        """As in ``Stepper``."""
        assert self._ready is not None
        assert pace.end is not None
        condensed, prepared = self._ready
        increment = Increment(begin.number, begin.before.largest, self._control.settings)
        task = Task(condensed, begin.before, self._solver, increment, self._control.limit, self._control.observe)
        return [load_step(task, pace.end, prepared)]

    def replace(self, solver: LinearSolver) -> None:
        """As in ``Stepper``: for all steps to come."""
        self._solver, self._ready = solver, None

    def end(self) -> None:
        """As in ``Stepper``."""
