"""The problem linearised at a state of large displacements, solved with its statuses whatever these are to begin with."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.linear.choice import Direct
from abut.nonlinear.finite_laws import left_open
from abut.nonlinear.friction import solve_linearised
from abut.nonlinear.iteration import Increment
from abut.nonlinear.laws import Asked, barely_covered, friction_laws
from abut.solution import Saved
from abut.solution.state import CLOSED, OPEN, SLIPPING
from models.pressed_cylinder import pressed_cylinder
from models.sliding import finite


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_the_laws_are_met_from_any_status(friction: float) -> None:
    """Balance, complementarity and Coulomb's law to rounding, the same solution from all of eight statuses, of which seven
    are drawn at random; what has no target opposite, or no past, carries nothing. With friction whole steps with the
    statuses that laws ask for find nothing from two of them: they come back to one that they have had."""
    model, kept = pressed_cylinder(friction=friction), list[Saved]()
    run = replace(model, supports=[*model.supports[:2], abut.Support("cylinder.left", x=0, y=0, z=-0.3)])
    abut.solve(replace(run, solve=abut.SolveOptions(times=[0.5, 1.0])), on_step=lambda _, saved: kept.append(saved))
    problem, before = finite(model), replace(kept[-1].state, time=0.5)
    system = problem.ahead(before, problem.ended(before), 0.55)
    prepared, rng, solutions = Direct().prepare(system, None), np.random.default_rng(3), []
    nothing = barely_covered(system) | (np.zeros(len(system), bool) if system.forgotten is None else system.forgotten)
    assert nothing.any()
    assert not nothing.all()
    for k in range(8):
        pair, begin = system.pairs[0], replace(before, time=0.55)
        drawn = rng.choice([OPEN, CLOSED, SLIPPING] if friction else [OPEN, CLOSED], len(pair.space))
        begin = begin.with_status(np.asarray(pair.of_functions(drawn)).astype(np.int8)) if k else begin
        found = solve_linearised(prepared, begin, Increment(1))
        assert found is not None
        largest = np.abs(found.multipliers).max()
        assert np.abs(left_open(system, friction_laws(system, found), Asked())).max() < 1e-8 * largest
        assert np.abs(system.unbalanced(found)).max() < 1e-9 * np.abs(system.internal(found)).max()
        assert (found.multipliers[nothing] == 0.0).all()
        solutions.append(found.multipliers)
    assert np.ptp(solutions, axis=0).max() < 1e-7 * np.abs(solutions).max()
