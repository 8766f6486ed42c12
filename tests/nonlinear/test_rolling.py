"""A body that contact alone holds, at large displacements: a roller between two plates."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from models.rolling import DOWN, FRICTION, LENGTH, LOAD, TURN, pushed_across, roller, wheel


@pytest.mark.long
@pytest.mark.parametrize("friction", [0.4, 0.2])
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


@pytest.mark.long
@pytest.mark.parametrize(("cells", "friction"), [(24, 0.3), (16, 0.1)])
def test_a_wheel_rolls(cells: int, friction: float) -> None:
    """As far as its rim turns, to the two hundredths by which the indented slab stretches (p0 / E = 0.08). It comes down on
    an edge of its facets, and off the slab again and again in iterations: it must not be carried away then."""
    solution = abut.solve(wheel(cells, friction))
    assert solution.converged
    assert solution.steps[-1].rigid["wheel"].displacement[0] == pytest.approx(TURN, rel=0.03)
    assert [check.name for check in solution.certificate if not check.passed and check.name != "resolution"] == []


@pytest.mark.long
def test_a_wheel_without_friction_turns_where_it_is() -> None:
    """Nothing holds it along the slab but the spring that rigid motions get, which takes what facets push it."""
    solution = abut.solve(wheel(16, 0.0))
    assert solution.converged
    assert abs(solution.steps[-1].rigid["wheel"].displacement[0]) < 1e-3 * TURN


@pytest.mark.long
def test_a_block_that_slips_all_over_may_be_free_across() -> None:
    """Pushed along a plate by a smooth pusher, nothing but friction holds it across, and all of it slips: it takes the
    coefficient times the load and no more."""
    solution = abut.solve(pushed_across())
    assert solution.converged
    floor, _ = solution.contacts
    assert abs(floor.force[0]) == pytest.approx(
        FRICTION * abs(floor.force[2]), rel=1e-3
    )  # facets lean by the indentation
    assert abs(floor.force[2]) == pytest.approx(LOAD, rel=5e-3)  # pressure that follows the stretched top
    assert abs(floor.force[1]) < 1e-6 * LOAD
    assert all(check.passed for check in solution.certificate)
