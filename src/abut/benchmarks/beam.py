"""A beam cut across by a non-matching interface under pure bending: tied, and in contact under compression."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.benchmarks.measures import displacement_error, pressure_error
from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import join, rectangle
from abut.model import Contact, Model, Solid, Support
from abut.solution import Solution

YOUNG, POISSON, HEIGHT, LENGTH = 1.0, 0.3, 1.0, 2.0
CURVATURE, SQUEEZE = 1e-3, 2e-3  # M / (E I); the compression that keeps a contact closed all over: above CURVATURE / 2
SOURCE = "beam theory, exact in plane stress: sigma = -M y / I (and a uniform compression)"


def _exact(x: NDArray[np.float64], squeeze: float) -> NDArray[np.float64]:
    along, up = x[:, 0], x[:, 1]
    return np.column_stack(
        [
            -CURVATURE * along * up - squeeze * along,
            0.5 * CURVATURE * (along**2 + POISSON * up**2) + POISSON * squeeze * up,
        ]
    )


def _beam(kind: str, squeeze: float) -> Benchmark:
    def model(level: int) -> Model:
        n = 2**level
        half = 0.5 * HEIGHT
        parts = {
            "left": rectangle((0.0, 0.5 * LENGTH), (-half, half), (3 * n, 3 * n), "quad9"),
            "right": rectangle((0.5 * LENGTH, LENGTH), (-half, half), (3 * n, 4 * n), "quad9"),
        }
        ends = [
            Support(on, x=lambda x: _exact(x, squeeze)[:, 0], y=lambda x: _exact(x, squeeze)[:, 1])
            for on in ("left.left", "right.right")
        ]
        return Model(
            join(parts),
            [Solid(body, LinearElastic(YOUNG, POISSON)) for body in parts],
            ends,
            contacts=[Contact("left.right", "right.left", kind=kind)],
            plane="stress",
        )

    def measure(solution: Solution) -> dict[str, float]:
        largest = YOUNG * (0.5 * CURVATURE * HEIGHT + squeeze)
        return {
            "displacement": displacement_error(solution, lambda x: _exact(x, squeeze)),
            "pressure": pressure_error(solution, lambda x: YOUNG * (CURVATURE * x[:, 1] + squeeze)) / largest,
        }

    reason = "rounding only: displacement and pressure are quadratic and linear, and lie in the spaces"
    error = Reference(0.0, 1e-10, SOURCE, reason)
    return Benchmark(
        f"beam-{kind}",
        f"beam cut across by a non-matching interface, {kind}, pure bending",
        model,
        measure,
        {"displacement": error, "pressure": error},
    )


BENCHMARKS = (_beam("tied", 0.0), _beam("contact", SQUEEZE))
