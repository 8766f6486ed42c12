"""Stress that bodies have before anything moves them: a strip that is cut out springs back to what balances itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import join, rectangle
from abut.model import Model, Solid, Support
from abut.solution import Solution

YOUNG, POISSON = 200.0e3, 0.3
HEIGHT, LENGTH, STRESS = 1.0, 10.0, 100.0


def _strip(level: int) -> Model:
    """Half of a strip with the stress STRESS (2 y / HEIGHT)^3 along it, which has a moment."""
    n = 2**level
    mesh = join({"strip": rectangle((0.0, LENGTH), (-0.5 * HEIGHT, 0.5 * HEIGHT), (10 * n, 4 * n), "quad8")})
    middle = int(np.linalg.norm(mesh.points, axis=1).argmin())
    return Model(
        replace(mesh, node_sets={"middle": np.array([middle])}),
        [Solid("strip", LinearElastic(YOUNG, POISSON), initial_stress=(f"{STRESS}*(2*y/{HEIGHT})**3", 0.0, 0.0, 0.0))],
        [Support("strip.left", x=0), Support("middle", y=0)],
        plane="stress",
    )


def _left(solution: Solution) -> dict[str, float]:
    """Halfway to the free end, far enough from it."""
    mesh, step = solution.model.mesh, solution.steps[-1]

    def at(x: float, y: float) -> int:
        return int(np.linalg.norm(mesh.points - (x, y), axis=1).argmin())

    rim, halfway = 0.5 * HEIGHT, 0.5 * LENGTH
    return {
        "deflection": float(step.displacement[at(halfway, 0.0), 1]),
        "stress on the surface": float(step.stress[at(halfway, rim), 0]),
        "stress in a quarter of the height": float(step.stress[at(halfway, 0.5 * rim), 0]),
    }


def _balanced(depth: float) -> float:
    """What is left of the stress: without its moment, as Euler and Bernoulli's beam bends; depth: 2 y / HEIGHT."""
    return STRESS * (depth**3 - 0.6 * depth)


BEAM = "Euler and Bernoulli's beam that springs back"
CURVATURE = 1.2 * STRESS / (YOUNG * HEIGHT)
BENCHMARKS = (
    Benchmark(
        "spring-back", "strip with stresses from before, which springs back where these have a moment", _strip, _left,
        {
            "deflection": Reference(0.5 * CURVATURE * (0.5 * LENGTH) ** 2, 1e-5, BEAM, "the free end is ten heights away"),
            "stress on the surface": Reference(_balanced(1.0), 1e-3, BEAM, "a cubic, recovered from four quadratic cells"),
            "stress in a quarter of the height": Reference(_balanced(0.5), 5e-3, BEAM, "the same"),
        },
    ),
)  # fmt: skip
