"""Hertz's line contact from the example's own job files (NAFEMS R0094), and units. The ball is among the benchmarks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import abut
from abut.job import load_job

EXAMPLES = Path(__file__).parents[2] / "examples"
HALF_WIDTH, PEAK = 6.2146, 3585.36


def pressure_line(contact: abut.solution.ContactResult) -> tuple[np.ndarray, np.ndarray]:
    surface = contact.contactor
    used = (surface.nodes >= 0) & (np.arange(surface.nodes.shape[1]) < 2)  # corners: linear between them
    x, first = np.unique(np.round(surface.points[surface.nodes[used], 0], 9), return_index=True)
    return x, contact.pressure[used][first]


# Inside 0.9 a errors vary with where the edge lies within its facet: quad8, facets of a / 5 to a / 20, from 0.1 to 1.7 %.
@pytest.mark.parametrize(("kind", "tolerance"), [("quad8", 0.02), ("quad4", 0.01)])
def test_line_contact(kind: str, tolerance: float) -> None:
    job = load_job(EXAMPLES / "hertz-line" / f"{kind}.toml")
    solution = abut.solve(job.model)
    assert solution.converged
    assert solution.dofs < 40_000
    contact = solution.contacts[0]
    assert contact.force[1] == pytest.approx(-35e3, rel=1e-9)
    assert contact.max_pressure == pytest.approx(PEAK, rel=tolerance)
    x, p = pressure_line(contact)
    facet = 8.0 / 12 if kind == "quad8" else 8.0 / 32
    edge = np.abs(x[p > 0.02 * PEAK]).max()
    assert edge == pytest.approx(HALF_WIDTH, abs=facet)
    # Hertz's ellipse is concave: inside contact no second difference is positive.
    slopes = np.diff(p) / np.diff(x)
    inside = np.abs(x[1:-1]) < HALF_WIDTH - 0.5 * facet  # the kink of Hertz's own pressure is within half a facet
    assert np.diff(slopes)[inside].max() < 0.0
    exact = PEAK * np.sqrt(np.maximum(0.0, 1.0 - (x / HALF_WIDTH) ** 2))
    assert np.abs(p - exact)[np.abs(x) < 0.9 * HALF_WIDTH].max() < tolerance * PEAK


def test_units_do_not_matter() -> None:
    """The same two blocks in metres, millimetres and nanometres: equal dimensionless pressure and force."""
    from dataclasses import replace

    job = load_job(EXAMPLES / "two-blocks" / "job.toml")
    model = job.model
    results = []
    for unit in (1e-3, 1.0, 1e6):  # length unit per millimetre
        scaled = abut.Model(
            replace(model.mesh, points=model.mesh.points * unit),
            [abut.Solid(s.body, abut.LinearElastic(s.material.young / unit**2, 0.3)) for s in model.solids],
            [model.supports[0], replace(model.supports[1], z=model.supports[1].z * unit)],
            contacts=model.contacts,
        )
        contact = abut.solve(scaled).contacts[0]
        results.append((contact.max_pressure * unit**2, contact.force[2]))
    assert results[0] == pytest.approx(results[1], rel=1e-9)
    assert results[2] == pytest.approx(results[1], rel=1e-9)
