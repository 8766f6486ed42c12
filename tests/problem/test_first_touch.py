"""Where points touch that were apart: bodies that roll on each other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from abut.contact.coupling import CouplingOptions
from abut.contact.geometry import nodal_normals
from abut.contact.slip_points import SlipPoints
from abut.mesh import make
from abut.mesh.mesh import Mesh
from abut.problem.first_touch import Sides, apart
from abut.problem.turns import rotation

RADIUS, ANGLE = 2.0, 0.4


def rolled(dim: int) -> Mesh:
    """A roller's tread from its lowest line up to an angle, and a plane below it."""
    if dim == 2:
        tread = make.rectangle((0, ANGLE), (0, 0.5), (40, 1), "quad8")
        plane = make.rectangle((-0.1, 1.0), (-1, 0), (3, 1), "quad8")
    else:
        tread = make.box((0, ANGLE), (0, 0.2), (0, 0.5), (40, 1, 1), "hex20")
        plane = make.box((-0.1, 1.0), (-0.1, 0.3), (-1, 0), (3, 1, 1), "hex20")
    up, angle = tread.points[:, -1], tread.points[:, 0]
    bent = tread.points.copy()
    bent[:, 0], bent[:, -1] = (RADIUS - up) * np.sin(angle), RADIUS - (RADIUS - up) * np.cos(angle)
    return make.join({"tread": replace(tread, points=bent), "plane": plane})


def offsets(mesh: Mesh, below: str, above: str) -> NDArray[np.float64]:
    """Mean over each facet of what its points are apart, as slip; (n_facets, c)."""
    contactor, target = mesh.surface(below), mesh.surface(above)
    points = SlipPoints.of(contactor, target, 2, CouplingOptions(reach=2.0))
    moved = apart(points, Sides(contactor, target, nodal_normals(contactor), nodal_normals(target)))
    area = points.moments(len(contactor)).reshape(len(contactor), 9).sum(axis=1)
    return np.asarray(moved.reshape(len(contactor), 9, -1).sum(axis=1) / area[:, None])


def test_a_roller_touches_where_arc_lengths_agree() -> None:
    """The ray of a point at the angle a meets the plane R (tan a - a) beyond where the point comes down; theory (G19) leaves
    a fifth order of the angle, 2 % of it here."""
    moved = np.abs(offsets(rolled(2), "tread.bottom", "plane.top")[:, 0])
    angle = ANGLE * (np.arange(40) + 0.5) / 40
    exact = RADIUS * (np.tan(angle) - angle)
    assert moved == pytest.approx(exact, rel=0.02, abs=1e-4 * exact.max())


def test_in_space_and_turned() -> None:
    """As in 2D, whatever the bodies' common place: all angles turn with them."""
    flat = np.abs(offsets(rolled(2), "tread.bottom", "plane.top")[:, 0])
    mesh = rolled(3)
    turn = rotation(np.array([0.3, -0.5, 0.6]))
    there = replace(mesh, points=mesh.points @ turn.T + [1.0, 2.0, -3.0])
    moved, again = (offsets(each, "tread.bottom", "plane.top") for each in (mesh, there))
    assert np.linalg.norm(moved, axis=1) == pytest.approx(flat, rel=1e-5)  # other points of integration
    assert again == pytest.approx(moved @ turn.T, abs=1e-10)
    assert np.abs(moved[:, 1]).max() < 1e-10
