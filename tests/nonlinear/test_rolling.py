"""A body that contact alone holds, at large displacements: a roller between two plates."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from models.rolling import DOWN, LENGTH, roller


@pytest.mark.parametrize("friction", [0.4, 0.1])
def test_a_roller_goes_half_as_far_as_the_plate_that_rolls_it(friction: float) -> None:
    """Rolling without slip; the roller must not be thrown out where for an iteration everything seems to slip. To the
    share by which rubber shortens along the contact, of the order of the square of b / R = 0.3, over a tenth of a turn."""
    model = roller(10, friction)
    solution = abut.solve(model)
    assert solution.converged
    centre = np.flatnonzero(np.linalg.norm(model.mesh.points, axis=1) < 1e-9)
    moved = solution.displacement[centre].ravel()
    assert moved == pytest.approx([0.5 * LENGTH, -0.5 * DOWN], abs=0.02)
    assert all(contact.active for contact in solution.contacts)
