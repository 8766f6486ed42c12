"""Numbers of a contact: pressure over the loaded area, centre of pressure, moments, nodal forces; each against theory."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from patch import CELL_OF, model, two_blocks

import abut
from abut.analysis.statistics import quantile, resultant
from abut.benchmarks.hertz import HALF_WIDTH, LINE_FORCE, LINE_PEAK
from abut.cli import main
from abut.io.contact_rows import contact_summary
from abut.io.grids import CONTACTOR, TARGET, contact_grid
from abut.job import load_job
from abut.mesh import make
from abut.report.contact_words import lines
from abut.report.scene import scene

ROOT = Path(__file__).parents[1]
STEEL = abut.LinearElastic(1000.0, 0.3)
EXACT = 1e-12
LINEAR_SPACES = ("auto", "P0", "P1", "P1-discontinuous", "dual", "dual-P1")


def assert_balanced(step: abut.Step) -> None:
    """Nodal forces of both sides add up to the resultant and to nothing, moments too, and bodies share the target's."""
    for contact in step.contacts:
        size = np.linalg.norm(contact.contactor_forces, axis=1).sum()
        assert size > 0.0
        assert np.abs(contact.contactor_forces.sum(axis=0) - contact.force).max() <= EXACT * size
        assert np.abs(contact.target_forces.sum(axis=0) + contact.force).max() <= EXACT * size
        assert np.abs(sum(contact.body_forces.values()) + contact.force).max() <= EXACT * size
        for side, sign, forces in ((CONTACTOR, 1.0, contact.contactor_forces), (TARGET, -1.0, contact.target_forces)):
            grid = contact_grid(step, contact, (side,))
            surface = contact.contactor if side == CONTACTOR else contact.target
            node, first = np.unique(grid.point_data["node"], return_index=True)
            assert (node == surface.node_ids).all()
            dim = surface.dim
            assert (grid.point_data["contact_force"][first, :dim] == forces).all()
            total = grid.point_data["contact_force"][first].sum(axis=0)[:dim]
            assert np.abs(total - sign * contact.force).max() <= EXACT * size


@pytest.mark.parametrize("facet", ["line2", "line3", "quad4", "quad8", "tri3", "tri6", "quad9"])
def test_uniform_pressure(facet: str) -> None:
    """Mean, percentile and largest are the pressure, the centre is that of the unit interface, and the moment is its arm
    times the force: all of the resultant is known, the blocks' sizes and positions being so."""
    if facet.startswith("line"):
        cell = {"line2": "quad4", "line3": "quad8"}[facet]
        built = model(two_blocks(cell, cell, ((5, 3), (4, 3))))
        turn, centre = np.eye(2), np.array([0.5, 1.0])
    else:
        built = model(two_blocks(CELL_OF[facet], CELL_OF[facet], ((3, 3, 2), (2, 2, 2))), rotate=False)
        turn, centre = np.eye(3), np.array([0.5, 0.5, 1.0])
    step = abut.solve(built).steps[-1]
    contact, p = step.contacts[0], built.loads[0].value
    s = contact.statistics
    assert [s.largest, s.mean, s.percentile_95, contact.max_pressure] == pytest.approx([p] * 4, rel=1e-9)
    assert s.area == pytest.approx(1.0, rel=1e-9)
    assert np.isnan(s.partly_covered)
    force = turn @ np.eye(built.mesh.dim)[-1] * -p
    assert contact.resultant.force == pytest.approx(force, abs=1e-9 * p)
    assert contact.resultant.centre == pytest.approx(centre, abs=1e-9)
    moment = np.cross(centre, force) if len(centre) == 3 else [centre[0] * force[1] - centre[1] * force[0]]
    assert contact.resultant.moment == pytest.approx(np.atleast_1d(moment), abs=1e-9 * p)
    assert_balanced(step)


def bent(pressure: str = "auto", cell: str = "quad8", kind: str = "contact", scale: float = 1.0) -> abut.Solution:
    """A column on a column of the same width under p(x) = 3 - 2 x on [0, 1], closed throughout: statically determinate."""
    parts = {
        "lower": make.rectangle([0, scale], [0, scale], cells=[6, 6], cell=cell),
        "upper": make.rectangle([0, scale], [scale, 2 * scale], cells=[6, 6], cell=cell),
    }
    young = 1000.0 / scale**2
    steel = abut.LinearElastic(young, 0.0)
    return abut.solve(
        abut.Model(
            make.join(parts),
            [abut.Solid(body, steel) for body in parts],
            [abut.Support("lower.bottom", y=0), abut.Support("lower.left", x=0), abut.Support("upper.left", x=0)],
            [abut.Pressure("upper.top", lambda x: (3.0 - 2.0 * x[:, 0] / scale) / scale**2)],
            [abut.Contact("upper.bottom", "lower.top", kind=kind, pressure=pressure)],
            plane="strain",
        )
    )
