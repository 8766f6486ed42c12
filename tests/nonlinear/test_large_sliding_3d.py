"""Contact at current positions in 3D: the exact tangent with turning frames, sliding with friction, momentum."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.contact.coupling import CouplingOptions
from abut.contact.moving_normals import normal_pattern
from abut.contact.slip_points import SlipPoints, slip_now
from abut.problem.turns import rotation
from abut.solution.state import State
from models.sliding import finite, forgetful, pressed_in_space, tangent_errors


@pytest.mark.parametrize("cell", ["hex8", "tet10"])
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_tangent_is_the_derivative(friction: float, cell: str) -> None:
    """As in 2D, with both components of slip and traction along tangents that turn with the surface."""
    assert max(tangent_errors(finite(pressed_in_space(friction, cell)), 3e-3)) < 1e-7


def test_tangent_where_slip_counts_at_late_points() -> None:
    problem = finite(pressed_in_space(0.3))
    assert max(tangent_errors(problem, 3e-3, forgetful(problem, 3e-3))) < 1e-7


@pytest.mark.long
def test_sliding() -> None:
    """Quadratic convergence to a state in which what slips carries the coefficient times the pressure against its motion;
    forces on both sides add up to none."""
    states: list[State] = []
    model = pressed_in_space(0.3)
    solution = abut.solve(model, on_step=lambda _, saved: states.append(saved.state))
    assert solution.converged
    for step in solution.steps:
        left = [max(row.residual, row.contact_residual) for row in step.iterations]
        first = next(i for i, value in enumerate(left) if value < 1e-3)
        assert min(left[first : first + 3]) < 1e-8
    problem, state = finite(model), states[-1]
    system = problem.again(state, state)
    pair = system.pairs[0]
    slips = state.slipping[pair.normal]
    traction = pair.tangential_traction(state.multipliers)[slips]
    assert slips.sum() >= 4
    assert np.allclose(np.linalg.norm(traction, axis=1), 0.3 * state.multipliers[pair.normal][slips], rtol=1e-8)
    way = np.array([0.4, 0.1]) / np.hypot(0.4, 0.1)
    opposed = -(traction[:, :2] @ way) / np.linalg.norm(traction, axis=1)
    assert opposed.min() > 0.9
    force = (pair.rows.T @ state.multipliers).reshape(-1, 3)
    assert np.abs(force.sum(axis=0)).max() < 1e-13 * np.abs(force).sum()


def test_slip_of_a_rigid_motion() -> None:
    """Both bodies turned by 0.8 about a skew axis and moved, with gaps between them: no slip."""
    model = pressed_in_space(0.3)
    contactor, target = model.sides(model.contacts[0])
    points = SlipPoints.of(contactor, target, 1, CouplingOptions(reach=1.0))
    moved = contactor.points @ rotation(np.array([0.3, -0.5, 0.55])).T + [1.0, 2.0, -3.0]
    moving = replace(contactor, points=moved)
    slip = slip_now(points, moving, replace(target, points=moved), normal_pattern(contactor).at(moving))
    assert np.abs(slip.value).max() < 1e-12
