"""Newton's method for bodies under finite deformation without contact."""

from __future__ import annotations

import time as clock
from dataclasses import replace

import numpy as np

from abut.errors import SingularModelError, Unsound
from abut.linear.solver import Prepared
from abut.nonlinear.forcing import FINE, forcing
from abut.nonlinear.iteration import Found, active_laws, largest_force
from abut.nonlinear.newton import BALANCED, STALLED, Task
from abut.problem.linearised import Linearised
from abut.problem.problem import ContactProblem
from abut.solution import Iteration
from abut.solution.state import State


def equilibrium(task: Task, time: float, previous: Prepared) -> tuple[Found, Prepared]:
    """The state in balance at ``time``, and the linear solver as it was last set up. previous: of the step before.

    Where a cell turns inside out, or a tangent is singular, it ends with the last sound state and the reason."""
    problem, before, prepared = task.problem, task.before, previous
    if not isinstance(problem, ContactProblem):
        raise TypeError("finite deformation needs all displacements")
    state, rows, error, last, reason = replace(before, time=time), list[Iteration](), np.inf, np.inf, ""
    system = problem.begin(before, time)
    known = _error(system, state, task)
    while len(rows) < task.limit:
        start = clock.perf_counter()
        try:
            prepared = task.solver.prepare(system, prepared)
            accuracy = forcing(error, last, BALANCED) if np.isfinite(error) else FINE
            change, _ = prepared.solve(system.rows([]), system.unbalanced(state), state.multipliers, accuracy)
            trial = replace(state, unknowns=state.unknowns + change)
            system = problem.linearise(before, trial)
        except (Unsound, SingularModelError) as failure:
            reason = str(failure)
            rows.append(_row(task, len(rows) + 1, known, clock.perf_counter() - start))
            task.observe(rows[-1])
            break
        state, last, error = trial, error, _error(system, trial, task)
        known = error
        rows.append(_row(task, len(rows) + 1, error, clock.perf_counter() - start))
        task.observe(rows[-1])
        if not np.isfinite(error):
            break
        if error <= BALANCED or (error <= STALLED and error > 0.5 * last):
            prepared = task.solver.prepare(system, prepared)
            return Found(state, tuple(rows), True, np.zeros(0, dtype=bool), active_laws, system=system), prepared
    if not np.isfinite(error):
        state = before  # whose forces are known to be sound
    return Found(state, tuple(rows), False, np.zeros(0, dtype=bool), active_laws, reason), prepared


def _error(system: Linearised, state: State, task: Task) -> float:
    force = system.unbalanced(state)
    return float(np.abs(force).max(initial=0.0)) / largest_force(system, state, force, task.increment)


def _row(task: Task, number: int, error: float, seconds: float) -> Iteration:
    return Iteration(
        step=task.increment.number, iteration=number, active=0, changed=0, residual=error, contact_residual=0.0,
        penetration=0.0, seconds=seconds,
    )  # fmt: skip
