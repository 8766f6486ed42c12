"""Bodies that contact alone holds are not thrown out of it by rounding."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.benchmarks import BENCHMARKS
from abut.benchmarks.penetration import RADIUS, SQUEEZE, THRUST


@pytest.mark.parametrize(
    "seed", [1, *(pytest.param(seed, marks=pytest.mark.long) for seed in (0, 2, 3, 4, 5, 6, 7, 8, 11, 15))]
)
def test_rounding_throws_no_ring_out(seed: int) -> None:
    """Points moved in the last digits: the seal of a fluid has the thrust that statics say, and is where it was squeezed, as
    without. It lies on a flat land: an iteration in which the wall is open has a singular system, which took every fifth
    such ring some million radii along the land, one of them without a word."""
    model = BENCHMARKS["o-ring"].model(0)
    noise = np.random.default_rng(seed).standard_normal(model.mesh.points.shape)
    mesh = replace(model.mesh, points=model.mesh.points * (1.0 + 1e-14 * noise))
    solution = abut.solve(replace(model, mesh=mesh))
    assert solution.converged
    assert np.abs(solution.displacement).max() < SQUEEZE + 0.1 * RADIUS
    assert -solution.steps[-1].rigid["wall"].force[0] == pytest.approx(THRUST, rel=5e-3)
