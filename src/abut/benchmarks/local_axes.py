"""Supports, loads and probes in local axes: a sector of a hollow ball, cut at any angle, and a shaft that is twisted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from abut.axes import Axes
from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import box, cylinder, join
from abut.model import Model, Probe, Solid, Support, Traction
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
        probes=[Probe("wall", line=(_at(INNER), _at(OUTER)), points=3, axes=axes)],
    )


def _at(radius: float) -> tuple[float, ...]:
    """A point inside the sector."""
    return tuple(_in_ball(np.array([[radius, 0.45, 0.1]]))[0])


def _read(solution: Solution) -> dict[str, float]:
    """In the middle of the wall, radial, around and toward the pole."""
    values = solution.probes[0].values
    moved, stress = values["displacement"][1], values["stress"][1]
    return {
        "radial displacement": float(moved[0]),
        "displacement across": float(np.hypot(*moved[1:])),
        "radial stress": float(stress[0]),
        "stress around": float(stress[1]),
        "stress toward the pole": float(stress[2]),
        "shear": float(np.abs(stress[3:]).max()),
    }


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


def stresses(radius: float) -> tuple[float, float]:
    """Radial, and at right angles to that."""
    a3, b3, r3 = INNER**3, OUTER**3, radius**3
    return PRESSURE * a3 * (r3 - b3) / (r3 * (b3 - a3)), PRESSURE * a3 * (2.0 * r3 + b3) / (2.0 * r3 * (b3 - a3))


def _read_wanted() -> dict[str, Reference]:
    middle = 0.5 * (INNER + OUTER)
    radial, around = stresses(middle)
    source, near = "Lame's hollow sphere", "recovered stresses of four quadratic cells through the wall"
    return {
        "radial displacement": Reference(_lame(middle), 5e-4, source, CURVED),
        "displacement across": Reference(0.0, 1e-5 * _lame(middle), source, "supports hold all nodes across"),
        "radial stress": Reference(radial, 1e-2, source, near),
        "stress around": Reference(around, 1e-2, source, near),
        "stress toward the pole": Reference(around, 1e-2, source, near),
        "shear": Reference(0.0, 1e-2 * PRESSURE, source, near),
    }


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


CURVED = "quadratic cells, four through the wall"
TWIST = SHEAR / RADIUS * LENGTH * 2.0 * (1.0 + POISSON) / YOUNG
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
        "ball-probe", "the same, read by a probe in spherical axes", _sector, _read, _read_wanted(),
    ),
    Benchmark(
        "shaft-twist", "shaft twisted by tractions around its axis", _shaft, _twist,
        {"twist of the end": Reference(TWIST, 1e-3, "Coulomb's torsion of a round bar", ROUND)},
    ),
)  # fmt: skip
