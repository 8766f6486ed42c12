"""Numbers of a contact at large rotations: they turn with the bodies."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.mesh import make

DEPTH = 0.02  # by which a column is squeezed along its axis


def squeezed(kind: str, angle: float) -> abut.Step:
    """Two unlike blocks on each other, 2 high, without lateral strain; both turn by ``angle`` about x."""
    lower = make.box((0, 1), (0, 1), (0, 1), cells=(1, 1, 1))
    upper = make.box((0, 1), (0, 1), (1, 2), cells=(2, 2, 1))
    mesh = make.join({"lower": lower, "upper": upper})
    c, s = np.cos(angle), np.sin(angle)
    down = DEPTH * np.array([s, -c])  # in y and z; a turn about this centre carries the top that way too
    centre = np.linalg.solve(np.eye(2) - [[c, -s], [s, c]], down)
    ends = {"lower.bottom": (0.0, 0.0, 0.0), "upper.top": (0.0, *centre)}
    steel = abut.LinearElastic(1000.0, 0.0)
    built = abut.Model(
        mesh, kinematics="finite", solids=[abut.Solid("lower", steel), abut.Solid("upper", steel)],
        rotations=[abut.Rotation(end, angle, at, (1.0, 0.0, 0.0)) for end, at in ends.items()],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", kind=kind)],
    )  # fmt: skip
    return abut.solve(built).steps[-1]


@pytest.mark.parametrize("kind", ["contact", "tied"])
def test_they_turn_with_the_bodies(kind: str) -> None:
    """All is known of a column of uniform strain: Green's strain e = (l^2 - 1) / 2 of the stretch l is pressed by
    S l = E e l along its axis, which goes through its middle. What is left is the tolerance of equilibrium."""
    contact = squeezed(kind, 0.5 * np.pi).contacts[0]
    stretch = 1.0 - 0.5 * DEPTH
    pressure = 1000.0 * 0.5 * (1.0 - stretch**2) * stretch
    force, centre = np.array([0.0, -pressure, 0.0]), np.array([0.5, -stretch, 0.5])
    s, own = contact.statistics, contact.resultant
    assert [s.largest, s.mean, s.percentile_95, contact.max_pressure] == pytest.approx([pressure] * 4, rel=1e-7)
    assert s.place[1] == pytest.approx(-stretch, rel=1e-7)
    assert own.force == pytest.approx(force, abs=1e-7 * pressure)
    assert own.centre == pytest.approx(centre, abs=1e-7)
    assert own.moment == pytest.approx(np.cross(centre, force), abs=1e-7 * pressure)
