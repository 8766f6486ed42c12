"""A wheel that a torque turns through its backlash into another: contact alone holds it, and is open at first."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.benchmarks.finite_gears import BASE
from abut.benchmarks.once_stopped import driven


def ends(torque: float, friction: float = 0.0, play: float = 0.025) -> tuple[np.ndarray, float, abut.Solution]:
    """The force on the pinion, its moment about the axle, and all of it."""
    solution = abut.solve(driven(torque, friction, play))
    assert solution.converged
    resultant = solution.contacts[0].resultant
    return resultant.force, float(resultant.moment[0]), solution


def test_a_torque_turns_a_wheel_through_its_backlash() -> None:
    """The moment of the contact force is the torque's; its arm the radius of the base circle, to the 2 % by which teeth bend
    and facets turn. The other way round it is the mirror image, to what a cut of mirrored facets leaves. No step is taken
    again, for the flanks that meet are those that the torque turns together: those that it turns apart are as near."""
    force, moment, solution = ends(200.0)
    assert moment == pytest.approx(-200.0, rel=1e-6)
    assert 200.0 / np.linalg.norm(force) == pytest.approx(BASE[0], rel=0.02)
    assert not any("did not converge" in note or "led to" in note for note in solution.notes)
    mirrored, back, _ = ends(-200.0)
    assert back == pytest.approx(200.0, rel=1e-6)
    assert mirrored == pytest.approx(force * [1.0, -1.0], rel=1e-3)


@pytest.mark.long
@pytest.mark.parametrize("torque", [0.02, 200.0])
def test_with_friction_at_any_torque(torque: float) -> None:
    """The first point that meets the wheel comes round the axle, not straight: where it would have to be pulled to stick,
    it slips. By statics the moment is the torque's, and no step is taken again."""
    _, moment, solution = ends(torque, 0.2)
    assert moment == pytest.approx(-torque, rel=1e-6)
    assert not any("did not converge" in note or "led to" in note for note in solution.notes)


@pytest.mark.exhaustive
@pytest.mark.parametrize(("friction", "play"), [(0.2, 0.4), (0.0, 0.4)])
def test_with_more_play(friction: float, play: float) -> None:
    """By statics the moment is the torque's, whatever rubs and however far the way is."""
    _, moment, _ = ends(200.0, friction, play)
    assert moment == pytest.approx(-200.0, rel=1e-6)
