"""Supports and loads in local axes: a sector of a hollow ball, cut at any angle, and a shaft that is twisted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from abut.axes import Axes
from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import box, cylinder, join
from abut.model import Model, Solid, Support, Traction
from abut.solution import Solution
from abut.types import Array

YOUNG, POISSON, PRESSURE = 1000.0, 0.3, 10.0
INNER, OUTER, CENTRE = 1.0, 2.0, (3.0, -1.0, 2.0)
RADIUS, LENGTH, SHEAR = 2.0, 10.0, 5.0


def _in_ball(points: Array) -> Array:
    """Grid lines of a box as radius, angle around and angle toward the pole."""
    r, around, up = points.T
    return np.column_stack([r * np.cos(up) * np.cos(around), r * np.cos(up) * np.sin(around), r * np.sin(up)]) + CENTRE


def _sector(level: int) -> Model:
    """All nodes held in the two directions around; the pressure inside is a traction along the radius."""
    n = 2**level
    grid = join({"ball": box((INNER, OUTER), (0.2, 0.7), (-0.3, 0.3), (4 * n, 2 * n, 2 * n), "hex20")})
    mesh = replace(grid, points=_in_ball(grid.points), node_sets={"all": np.arange(len(grid.points))})
    axes = Axes("spherical", origin=CENTRE)
    return Model(
        mesh,
        [Solid("ball", LinearElastic(YOUNG, POISSON))],
        [Support("all", y=0, z=0, axes=axes)],
        [Traction("ball.left", (PRESSURE, 0.0, 0.0), axes=axes)],
    )


def _growth(solution: Solution) -> dict[str, float]:
    mesh, moved = solution.model.mesh, solution.steps[-1].displacement
    found = {}
    for name, side in (("bore", "ball.left"), ("outside", "ball.right")):
        nodes = mesh.nodes_of(side)
        found[f"growth of the {name}"] = float(np.linalg.norm(moved[nodes], axis=1).mean())
    return found


def _lame(radius: float) -> float:
    a3, b3 = INNER**3, OUTER**3
    along = (1.0 - 2.0 * POISSON) * radius + (1.0 + POISSON) * b3 / (2.0 * radius**2)
    return PRESSURE * a3 / (YOUNG * (b3 - a3)) * along


def _shaft(level: int) -> Model:
    """Held at one end, at the other tractions around the axis that grow with the radius."""
    n = 2**level
    mesh = join({"shaft": cylinder(RADIUS, (0.0, LENGTH), (4 * n, 6 * n), "hex20")})
    around = (0.0, f"{SHEAR}*sqrt(x**2 + y**2)/{RADIUS}", 0.0)
    return Model(
        mesh,
        [Solid("shaft", LinearElastic(YOUNG, POISSON))],
        [Support("shaft.bottom", x=0, y=0, z=0)],
        [Traction("shaft.top", around, axes=Axes("cylindrical"))],
    )


def _twist(solution: Solution) -> dict[str, float]:
    mesh, moved = solution.model.mesh, solution.steps[-1].displacement
    nodes = mesh.nodes_of("shaft.top")
    x, u = mesh.points[nodes], moved[nodes]
    rim = np.hypot(x[:, 0], x[:, 1]) > 0.9 * RADIUS
    turn = (x[rim, 0] * u[rim, 1] - x[rim, 1] * u[rim, 0]) / (x[rim, 0] ** 2 + x[rim, 1] ** 2)
    return {"twist of the end": float(turn.mean())}


TWIST = SHEAR / RADIUS * LENGTH * 2.0 * (1.0 + POISSON) / YOUNG
CURVED = "quadratic cells, four through the wall"
ROUND = "facets of second order on the round face"
BENCHMARKS = (
    Benchmark(
        "ball-sector", "sector of a hollow ball between spherical supports, pressed from inside", _sector, _growth,
        {
            f"growth of the {name}": Reference(_lame(radius), 5e-4, "Lame's hollow sphere", CURVED)
            for name, radius in (("bore", INNER), ("outside", OUTER))
        },
    ),
    Benchmark(
        "shaft-twist", "shaft twisted by tractions around its axis", _shaft, _twist,
        {"twist of the end": Reference(TWIST, 1e-3, "Coulomb's torsion of a round bar", ROUND)},
    ),
)  # fmt: skip
