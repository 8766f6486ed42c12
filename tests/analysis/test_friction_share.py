"""The share of its limit that friction carries, where a contact has been unloaded."""

from __future__ import annotations

import math

import pytest

import abut
from abut.mesh import make


def released(kinematics: str) -> abut.Model:
    """A block that is pressed and pushed until it slips, and taken back to where it was."""
    steel, there_and_back = abut.LinearElastic(1000.0, 0.3), abut.Amplitude(((0.0, 0.0), (0.5, 1.0), (1.0, 0.0)))
    lower, upper = make.rectangle([0, 4], [0, 1], (7, 3)), make.rectangle([0.5, 3.5], [1, 2], (5, 4))
    return abut.Model(
        make.join({"lower": lower, "upper": upper}), plane="strain", kinematics=kinematics,
        solids=[abut.Solid("lower", steel), abut.Solid("upper", steel)],
        supports=[
            abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=0.03, y=-0.02, amplitude=there_and_back),
        ],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", friction=0.3)],
        solve=abut.SolveOptions(times=[0.5, 1.0]),
    )  # fmt: skip


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_rounding_of_the_pressure_has_no_share(kinematics: str) -> None:
    """The pressures left are rounding of those before, and tractions may be a hundred times them."""
    pressed, *_, last = (step.contacts[0] for step in abut.solve(released(kinematics)).steps)
    assert last.max_pressure < 1e-9 * pressed.max_pressure
    assert pressed.friction is not None
    assert pressed.friction.largest_share == pytest.approx(1.0, abs=1e-9)
    assert last.friction is not None
    assert math.isnan(last.friction.largest_share)
