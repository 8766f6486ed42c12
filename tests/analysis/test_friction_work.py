"""Friction that gives work back is said, but not what is left of the slip of points that stick."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from abut.analysis.friction import STUCK, friction_checks
from abut.solution.state import CLOSED, SLIPPING

BOUND = 0.3


def line(status: int, slip: float, name: str) -> bool:
    """Whether the certificate's line passes for one point in 2D under unit pressure, with a traction of 0.2 along x while it
    slips by ``slip`` along x."""
    pair = SimpleNamespace(
        contact=SimpleNamespace(name="c"),
        normal=np.array([0]),
        index=np.array([[0, 1]]),
        tangential_traction=lambda values: np.array([[values[1], 0.0]]),
        space=SimpleNamespace(weight=np.ones(1)),
        stiffness=1.0,
        smooth=False,
    )
    limit = SimpleNamespace(rough=False, at=lambda pressure: (BOUND * pressure, None))
    slips = np.array([[0.0] * 4, [slip, 0.0, 0.0, 0.0]])
    checks = friction_checks(pair, np.array([1.0, 0.2]), np.array([status, status]), slips, limit, 1.0)
    return next(check.passed for check in checks if check.name.endswith(name))


@pytest.mark.parametrize("slip", [0.5 * STUCK, -0.5 * STUCK])
def test_what_sticking_points_have_left_is_no_work(slip):
    assert line(CLOSED, slip, "friction work")
    assert line(CLOSED, slip, "sticking")


def test_a_point_that_is_dragged_along_by_its_traction_gives_work_back():
    assert not line(SLIPPING, 1e-3, "friction work")
    assert line(SLIPPING, -1e-3, "friction work")  # friction opposes slip
    assert not line(CLOSED, 1e-3, "friction work")
