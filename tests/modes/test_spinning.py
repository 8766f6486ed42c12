"""Frequencies of what turns, against closed forms: centrifugal forces grow with the distance from the axis."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.mesh import make

SPEED, MASS = 3.0, 4.0  # of a block 2 wide, 1 high and 1 thick, density 2
ALONG, ACROSS = 60.0, 100.0  # stiffnesses of its springs


def block(kinematics: str, **load: object) -> abut.Model:
    """On springs at both sides, as good as rigid."""
    mesh = make.join({"block": make.rectangle([0, 2], [0, 1], cells=[4, 2])})
    springs = [abut.Spring(side, f"block.{side}", x=ALONG / 2.0, y=ACROSS / 2.0) for side in ("left", "right")]
    return abut.Model(
        mesh,
        plane="stress",
        kinematics=kinematics,
        solids=[abut.Solid("block", abut.LinearElastic(1e9, 0.0, density=MASS / 2.0))],
        springs=springs,
        loads=[abut.Centrifugal(SPEED, through=(1.0, 0.5), **load)],
        modes=[abut.Frequencies(2)],
    )


def squares(model: abut.Model) -> np.ndarray:
    return abut.solve(model).modes[0].eigenvalues


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_a_mass_on_springs_is_softer_by_the_square_of_its_speed(kinematics: str):
    """omega^2 = k / m - Omega^2 along both axes; stresses of the block, 1e-8 of its modulus, do nothing."""
    expected = np.array([ALONG, ACROSS]) / MASS - SPEED**2
    np.testing.assert_allclose(squares(block(kinematics)), expected, rtol=1e-6)


def test_beyond_the_critical_speed_it_is_unstable():
    """Omega^2 > k / m along one axis: omega^2 = 15 - 20.25 < 0."""
    model = replace(block("small"), loads=[abut.Centrifugal(4.5, through=(1.0, 0.5))])
    result = abut.solve(model).modes[0]
    np.testing.assert_allclose(result.eigenvalues, [15.0 - 20.25, 25.0 - 20.25], rtol=1e-6)
    assert result.values[0] < 0.0
    assert result.missing == 0


def test_what_does_not_turn_at_the_end_or_is_told_not_to_is_as_stiff_as_at_rest():
    at_rest = np.array([ALONG, ACROSS]) / MASS
    stopped = abut.Amplitude(((0.0, 0.0), (0.5, 1.0), (1.0, 0.0)))
    np.testing.assert_allclose(squares(block("small", amplitude=stopped)), at_rest, rtol=1e-6)
    model = replace(block("small"), modes=[abut.Frequencies(2, stiffening=False)])
    np.testing.assert_allclose(squares(model), at_rest, rtol=1e-6)
    slower = abut.Amplitude(((0.0, 0.0), (1.0, 0.25)))  # of the force: half the speed
    np.testing.assert_allclose(squares(block("small", amplitude=slower)), at_rest - SPEED**2 / 4.0, rtol=1e-6)


def test_a_turning_beam_lags_slower_than_it_flaps():
    """Of a clamped beam that turns about an axis through its foot, omega^2 = omega0^2 + 1.193 Omega^2 along the axis
    (Southwell's coefficient, Leissa 1981), and in the plane of rotation Omega^2 less, whatever omega0; but for the height of
    the section, of the order of (4 / 100)^2."""
    length, side, speed = 100.0, 4.0, 500.0
    mesh = make.join({"beam": make.box([0, length], [0, side], [0, side], cells=[10, 1, 1], cell="hex20")})
    still, turning = (
        abut.solve(
            abut.Model(
                mesh,
                [abut.Solid("beam", abut.LinearElastic(210e3, 0.0, density=7.85e-9))],
                [abut.Support("beam.left", x=0, y=0, z=0)],
                [abut.Centrifugal(omega, axis=(0, 0, 1), through=(0.0, side / 2.0, 0.0))],
                modes=[abut.Frequencies(2)],
            )
        ).modes[0]
        for omega in (0.0, speed)
    )
    axial = np.abs(turning.shapes).max(axis=1)
    assert axial.argmax(axis=1).tolist() == [1, 2]  # in the plane of rotation first
    lag, flap = turning.eigenvalues
    np.testing.assert_allclose(flap - lag, speed**2, rtol=2e-3)
    np.testing.assert_allclose((flap - still.eigenvalues[0]) / speed**2, 1.193, rtol=5e-3)
