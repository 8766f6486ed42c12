"""Solutions with the same rows and several right-hand sides."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.linear.solver import Prepared, Solve
from abut.nonlinear.settings import AccuracySettings
from abut.problem.linearised import Rows
from abut.solution.state import State

Vector = NDArray[np.float64]


def solutions(solver: Prepared, rows: Rows, state: State, accuracy: AccuracySettings) -> Solve:
    """With rows near a state, as often as wanted: (residual of equilibrium, of the rows) -> (du, dp). Where they are
    symmetric by factors that are kept, or iteratively, each solution from the one before on."""
    system = solver.system
    if not rows.symmetric or any(pair.frictional for pair in system.pairs):
        return lambda residual, of_law: solver.solve(
            replace(rows, residual=of_law), residual, state.multipliers, accuracy.stride
        )
    factors = solver.factorise(rows)
    if factors is not None:
        return factors
    du, dp = np.zeros_like(state.unknowns), np.zeros_like(state.multipliers)

    def solve(residual: Vector, of_law: Vector) -> tuple[Vector, Vector]:
        nonlocal du, dp
        if du.any() or dp.any():
            residual = residual + system.stiffness @ du - system.operator.T @ dp
            of_law = of_law + rows.by_displacement @ du + rows.by_pressure @ dp
        more = solver.solve(replace(rows, residual=of_law), residual, state.multipliers, accuracy.rough)
        du, dp = du + more[0], dp + more[1]
        return du, dp

    return solve
