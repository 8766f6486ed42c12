"""Pressure on deformed surfaces: its derivative, closed surfaces, and the dead load that it begins as."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from abut.bodies.follower import follower_pressure
from abut.bodies.loads import pressure_load
from abut.mesh.make import box, rectangle
from abut.mesh.surface import Surface

CELLS_OF = {"line2": "quad4", "line3": "quad8", "tri3": "tet4", "tri6": "tet10", "quad4": "hex8", "quad8": "hex20",
            "quad9": "hex27"}  # fmt: skip
STEP = 1e-5
PRESSURE = 1.7


def surface(facet: str, axisymmetric: bool = False) -> Surface:
    cell = CELLS_OF[facet]
    mesh = rectangle((1.0, 2.0), (0.0, 1.0), (2, 2), cell) if facet[0] == "l" else box(cells=(1, 2, 2), cell=cell)
    noise = 0.03 * np.random.default_rng(4).standard_normal(mesh.points.shape)
    return replace(mesh, points=mesh.points + noise, axisymmetric=axisymmetric).surface("right")


@pytest.mark.parametrize(
    ("facet", "axisymmetric"), [*((facet, False) for facet in CELLS_OF), ("line2", True), ("line3", True)]
)
def test_derivative(facet: str, axisymmetric: bool) -> None:
    """Forces are cubic in the positions at most, so that differences err by their rounding."""
    own = surface(facet, axisymmetric)
    force, slope = follower_pressure(own, PRESSURE)
    assert np.abs(force - pressure_load(own, PRESSURE)).max() < 1e-14
    along = np.random.default_rng(5).standard_normal(own.points.shape)
    sides = [follower_pressure(replace(own, points=own.points + s * STEP * along), PRESSURE)[0] for s in (1, -1)]
    difference = (sides[0] - sides[1]) / (2.0 * STEP)
    assert np.abs(slope @ along.ravel() - difference).max() < 1e-9 * np.abs(difference).max()


@pytest.mark.parametrize("cell", ["tet10", "hex8", "hex27"])
def test_closed_surface(cell: str) -> None:
    """Pressure all round neither pushes nor turns a body, whatever its shape."""
    mesh = box(cells=(2, 2, 2), cell=cell)
    points = mesh.points + 0.1 * np.sin(3.0 * mesh.points[:, [1, 2, 0]])
    moved = replace(mesh, points=points)
    force = sum(follower_pressure(moved.surface(side), PRESSURE)[0] for side in mesh.surfaces)
    nodal = np.asarray(force).reshape(-1, 3)
    assert np.abs(nodal.sum(axis=0)).max() < 1e-14
    assert np.abs(np.cross(points, nodal).sum(axis=0)).max() < 1e-13
