"""Loads at references: forces at points, in balance at any turn, with their derivative."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from abut.bodies.mean_turn import mean_turn, spread

STEP = 1e-6
CLOSE = 1e-7  # of central differences: STEP squared, and rounding over STEP


def case(dim: int, flat: bool = False):
    """Arms from their mean, where the points are, weights, offset."""
    random = np.random.default_rng(dim)
    arms = random.normal(size=(6, dim))
    if flat:
        arms[:, 2] = 0.0
    weights = random.random(6)
    weights /= weights.sum()
    arms -= weights @ arms
    turn = Rotation.from_rotvec([0.5, -1.0, 1.5]).as_matrix() if dim == 3 else np.array([[0.6, -0.8], [0.8, 0.6]])
    points = arms @ turn.T + 0.1 * random.normal(size=arms.shape) + 5.0
    return arms, points, weights, random.normal(size=dim), random


def in_space(vectors):
    result = np.zeros((len(vectors), 3))
    result[:, : vectors.shape[1]] = vectors
    return result


@pytest.mark.parametrize(("dim", "flat"), [(3, False), (3, True), (2, False)])
def test_forces_balance_the_load_and_their_derivative_is_exact(dim, flat):
    arms, points, weights, offset, random = case(dim, flat)
    force, moment = random.normal(size=dim), random.normal(size=3 if dim == 3 else 1)
    at = spread(arms, points, weights, offset, force, moment)
    reference = in_space((weights @ points)[None])[0] + mean_turn(arms, points, weights) @ in_space(offset[None])[0]
    assert at.force.sum(axis=0) == pytest.approx(force, rel=1e-12)
    about = np.cross(in_space(points) - reference, in_space(at.force)).sum(axis=0)
    assert about[0 if dim == 3 else 2 :] == pytest.approx(moment, rel=1e-11)
    columns = []
    for direction in STEP * np.eye(points.size):
        ends = [
            spread(arms, points + s * direction.reshape(points.shape), weights, offset, force, moment) for s in (1, -1)
        ]
        columns.append((ends[0].force - ends[1].force).ravel() / (2.0 * STEP))
    assert np.abs(at.left @ at.right - np.array(columns).T).max() < CLOSE


def test_the_derivative_of_a_force_is_symmetric_and_that_of_a_moment_is_not():
    """A dead force has a potential, a moment about fixed axes none."""
    arms, points, weights, offset, random = case(3)
    force, moment = random.normal(size=(2, 3))
    of_force, of_moment = (
        at.left @ at.right
        for at in (
            spread(arms, points, weights, offset, force, 0.0 * moment),
            spread(arms, points, weights, offset, 0.0 * force, moment),
        )
    )
    assert np.abs(of_force - of_force.T).max() < 1e-13 * np.abs(of_force).max() * 10
    assert np.abs(of_moment - of_moment.T).max() > 0.1 * np.abs(of_moment).max()


@pytest.mark.parametrize("dim", [2, 3])
def test_the_mean_turn_of_a_rigid_motion_is_its_own(dim):
    arms, _, weights, *_ = case(dim)
    turn = Rotation.from_rotvec([0.0, 0.0, 2.5] if dim == 2 else [1.0, 2.0, -1.5]).as_matrix()
    points = arms @ turn[:dim, :dim].T + 3.0
    assert mean_turn(arms, points, weights) == pytest.approx(turn, abs=1e-12)
