"""Where yield begins under balls and cylinders: Hertz's pressure over the largest von Mises stress, still elastic."""

from __future__ import annotations

import numpy as np

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.materials.invariants import von_mises
from abut.mesh.make import join, rectangle, ring
from abut.model import Contact, Model, Rigid, Solid, Support
from abut.solution import Solution


def _onset(shape: str, poisson: float, ratio: float) -> Benchmark:
    """shape: "ball" or "cylinder"; ratio: largest pressure over largest stress."""
    young, radius = 1.0, 1.0  # of contact, of the ball 100
    ball = shape == "ball"
    depth = radius**2 / 100.0 * (1.0 if ball else 3.3)  # a cylinder's by the logarithm of the size of the ground

    def model(level: int) -> Model:
        h = radius / 10.0 / 2**level
        n = round(1.2 * radius / h)
        fine = {"x": [0.0, 1.2 * radius], "y": [-1.2 * radius, 0.0]}
        ground = rectangle((0.0, 300.0), (-300.0, 0.0), (n, n), "quad8", fine, 1.3)
        roller = ring((95.0, 100.0), (-90.0, -90.0 + np.rad2deg(0.015)), (0.0, 100.0), (1, 2 * n))
        return Model(
            join({"ground": ground, "ball": roller}),
            [Solid("ground", LinearElastic(young, poisson), integration="reduced")],
            [Support("ground.bottom", y=0), Support("ground.left", x=0), Support("ground.right", x=0)],
            contacts=[Contact("ground.top", "ball.outer")],
            rigid=[Rigid("ball", y=-depth) if ball else Rigid("ball", x=0.0, y=-depth, rz=0.0)],
            plane="axisymmetric" if ball else "strain",
        )

    def measure(solution: Solution) -> dict[str, float]:
        force = abs(float(solution.contacts[0].force[1]))
        star = young / (1.0 - poisson**2)
        if ball:
            peak = (6.0 * force * star**2 / (np.pi**3 * 100.0**2)) ** (1.0 / 3.0)
        else:
            peak = np.sqrt(2.0 * force * star / (np.pi * 100.0))  # half of it is meshed
        return {"pressure over stress": peak / float(von_mises(solution.steps[-1].stress).max())}

    source = "Hertz's stresses along the axis, the largest of von Mises"
    return Benchmark(
        f"onset-{shape}-{poisson:g}",
        f"where yield begins under a {shape}, Poisson's ratio {poisson:g}",
        model,
        measure,
        {"pressure over stress": Reference(ratio, 0.01, source, "quadratic cells of a tenth of the contact radius")},
    )


BENCHMARKS = (
    *(
        _onset("ball", *pair)
        for pair in ((0.0, 1.2993), (0.25, 1.5543), (0.3, 1.6128), (0.33, 1.6492), (0.4, 1.7385), (0.499, 1.8758))
    ),
    *(_onset("cylinder", *pair) for pair in ((0.25, 1.7250), (0.3, 1.7937), (0.4, 1.8895))),
)
