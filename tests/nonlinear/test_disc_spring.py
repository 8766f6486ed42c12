"""A disc spring between two plates: sharp edges that press, beside walls that turn with the disc."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.mesh import make
from abut.model import Contact, Model, Solid, Support

INNER, OUTER, THICK, HIGH = 12.7, 25.0, 2.0, 2.0  # radii, thickness, free height of the cone


def disc_spring(lower: str, upper: str) -> Model:
    """lower, upper: the surfaces of the disc that touch the plates."""
    turn = np.arctan2(HIGH, OUTER - INNER)
    length = np.hypot(HIGH, OUTER - INNER)
    flat = make.rectangle([0, length], [0, THICK], (40, 6), "quad8")
    along, across = flat.points.T
    points = np.stack(
        [INNER + along * np.cos(turn) + across * np.sin(turn), HIGH - along * np.sin(turn) + across * np.cos(turn)],
        axis=1,
    )
    top = HIGH + THICK * np.cos(turn)
    mesh = make.join(
        {
            "disc": replace(flat, points=points),
            "lower": make.rectangle([20, 30], [-5, 0], (17, 5), "quad8"),
            "upper": make.rectangle([10, 20], [top, top + 5], (16, 5), "quad8"),
        }
    )
    steel = abut.Hencky(young=206e3, poisson=0.3)
    return Model(
        mesh,
        [Solid(body, steel) for body in ("disc", "lower", "upper")],
        [Support("lower.bottom", x=0, y=0), Support("upper.top", x=0, y=-1.5)],
        contacts=[Contact(lower, "lower.top", name="outer"), Contact(upper, "upper.bottom", name="inner")],
        plane="axisymmetric",
        kinematics="finite",
    )


@pytest.mark.long
def test_a_whole_disc_is_pressed_flat_as_its_faces_are() -> None:
    """Walls at right angles to the faces that touch carry nothing, however the disc turns: with the whole disc as a side of
    both contacts the force is that with its faces alone, up to where Newton's method ends."""
    force = []
    for lower, upper in (("disc", "disc"), ("disc.bottom", "disc.top")):
        solution = abut.solve(disc_spring(lower, upper))
        assert solution.converged
        force.append(solution.steps[-1].reactions["upper.top"][1])
    assert force[0] == pytest.approx(force[1], rel=1e-6)
