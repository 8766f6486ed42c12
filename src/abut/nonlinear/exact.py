"""One linear solution with a given active set, exact but for rounding or the error of an iterative solver."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from abut.linear.solver import Prepared
from abut.nonlinear.iteration import (
    Increment,
    advance,
    broken,
    imbalance,
    largest_pressure,
    next_active,
    report,
)
from abut.nonlinear.laws import active_laws
from abut.nonlinear.settings import Settings
from abut.solution import Iteration
from abut.solution.state import State

Aim = Literal["solution", "set", "this set"]


@dataclass(frozen=True)
class Solved:
    """state: with the active set that was used; wanted: the one that the law asks for then, theory (V7); violation: (n,)
    by how much (pressure) each multiplier breaks the law; closure: see ``closure``; row: of the table."""

    state: State
    wanted: NDArray[np.bool_]
    violation: NDArray[np.float64]
    closure: float
    row: Iteration

    @property
    def changed(self) -> NDArray[np.bool_]:
        return self.wanted != self.state.closed

    @property
    def error(self) -> float:
        """Of equilibrium and of closed gaps."""
        return max(self.row.residual, self.closure)


def solve_set(
    solver: Prepared, state: State, increment: Increment, tied: NDArray[np.bool_], count: int, accuracy: float
) -> Solved:
    """Solve with the active set of ``state``, completed where it lets a body go, as iteration ``count`` of the step.

    An iterative solver goes on where a rough solution says nothing, as after a state that was far off."""
    clock, asked = time.perf_counter(), increment.settings.accuracy
    system = solver.system
    active = system.restraint.complete(system.forces, state.closed, system.gap(state)) | tied
    state = state.with_closed(active)
    for _ in range(increment.settings.newton.patience if not solver.exact else 1):
        state = advance(solver, state, active_laws(system, state), accuracy)
        wanted, violation = next_active(system, state, increment, tied)
        changed = int((wanted != active).sum())
        left = imbalance(system, state, increment), broken(violation, state, increment)
        row = report(system, state, increment, count, changed, left, time.perf_counter() - clock)
        solved = Solved(state, wanted, violation, closure(solver, state, increment), row)
        if solved.error <= asked.told:
            break
        accuracy = max(asked.told / solved.error, asked.stride)
    return replace(solved, row=replace(row, contact_residual=max(row.contact_residual, solved.closure)))


def settled(solver: Prepared, solved: Solved, settings: Settings, aim: Aim, before: float = np.inf) -> bool:
    """Whether a set that stands still has been solved well enough. before: its error after the solution before this one:
    what no longer falls is rounding."""
    rounding = solved.error <= settings.newton.stalled and solved.error > 0.5 * before
    return solver.exact or solved.error <= _wanted(solver, settings, aim) or rounding


def finer(solver: Prepared, solved: Solved, settings: Settings, aim: Aim) -> float:
    """The reduction of the residual to ask for next where it has not: the rougher the state in which a set stands still,
    the less is it worth to be solved to the end."""
    asked = settings.accuracy
    last = asked.spare * _wanted(solver, settings, aim) / solved.error
    return max(last, min(solved.error**2, asked.rough), asked.fine)


def _wanted(solver: Prepared, settings: Settings, aim: Aim) -> float:
    return max(settings.accuracy.fine, solver.accurate) if aim == "set" else solver.accurate


def closure(solver: Prepared, state: State, increment: Increment) -> float:
    """Largest weighted gap left where contact is closed, as a pressure over the largest pressure."""
    if solver.exact or not state.closed.any():
        return 0.0
    gap = solver.system.gap(state) / solver.system.scale
    return float(np.abs(gap[state.closed]).max() / largest_pressure(state, increment))
