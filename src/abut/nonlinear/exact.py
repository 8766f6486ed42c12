"""One solution with a given active set, exact but for rounding or what an iterative solver leaves."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from abut.problem.system import (
    Stage,
    System,
    Unknowns,
    active_laws,
    advance,
    largest_pressure,
    next_active,
    report,
)
from abut.solution import Iteration

Aim = Literal["solution", "set", "this set"]
ROUGH = 1e-2  # reduction of the residual asked of iterative linear solvers while the set changes
TOLD, MOST = (
    0.2,
    3,
)  # of equilibrium and of closed gaps, where a state tells which set comes next; solutions until there
STRIDE = 1e-4  # the same at most in one solve, lest a set is solved to the end that then turns out not to be final
ROUNDING = 1e-8  # the same that may be left to rounding
SEARCHED = 1e-5  # of equilibrium and of closed gaps, where only the set is wanted


@dataclass(frozen=True)
class Solved:
    """state: with the active set that was used; wanted: the one that the law asks for then, theory (V7); violation: (n,)
    by how much (pressure) each multiplier breaks the law; closure: see ``closure``; row: of the table."""

    state: Unknowns
    wanted: NDArray[np.bool_]
    violation: NDArray[np.float64]
    closure: float
    row: Iteration

    @property
    def changed(self) -> NDArray[np.bool_]:
        return self.wanted != self.state.active

    @property
    def error(self) -> float:
        """Of equilibrium and of closed gaps."""
        return max(self.row.residual, self.closure)


def solve_set(
    system: System, state: Unknowns, stage: Stage, tied: NDArray[np.bool_], count: int, accuracy: float
) -> Solved:
    """Solve with the active set of ``state``, completed where it lets a body go, as iteration ``count`` of the step.

    An iterative solver goes on where a rough solution says nothing, as after a state that was far off."""
    clock = time.perf_counter()
    active = system.complete(state.active, system.gap(state, stage.weights), stage.weights) | tied
    state = replace(state, active=active)
    for _ in range(MOST if not system.exact else 1):
        state = advance(system, state, stage.weights, active_laws(system, state, stage.weights), accuracy)
        wanted, violation = next_active(system, state, stage, tied)
        changed = int((wanted != active).sum())
        row = report(system, state, stage, count, changed, violation, time.perf_counter() - clock)
        solved = Solved(state, wanted, violation, closure(system, state, stage), row)
        if solved.error <= TOLD:
            break
        accuracy = max(TOLD / solved.error, STRIDE)
    return replace(solved, row=replace(row, contact_residual=max(row.contact_residual, solved.closure)))


def settled(system: System, solved: Solved, aim: Aim, before: float = np.inf) -> bool:
    """Whether a set that stands still has been solved well enough. before: its error after the solution before this one:
    what no longer falls is rounding."""
    rounding = solved.error <= ROUNDING and solved.error > 0.5 * before
    return system.exact or solved.error <= _wanted(system, aim) or rounding


def finer(system: System, solved: Solved, aim: Aim) -> float:
    """The reduction of the residual to ask for next where it has not."""
    return max(0.3 * _wanted(system, aim) / solved.error, STRIDE)


def _wanted(system: System, aim: Aim) -> float:
    return max(SEARCHED, system.accurate) if aim == "set" else system.accurate


def closure(system: System, state: Unknowns, stage: Stage) -> float:
    """Largest weighted gap left where contact is closed, as a pressure over the largest pressure."""
    if system.exact or not state.active.any():
        return 0.0
    gap = system.gap(state, stage.weights) / system.join([pair.scale for pair in system.pairs])
    return float(np.abs(gap[state.active]).max() / largest_pressure(state, stage))
