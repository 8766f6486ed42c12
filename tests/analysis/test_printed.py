"""Results as they are printed, and by node."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut import diagnosis
from abut.brief import LINES
from abut.mesh import make
from models.friction import pushed


@pytest.fixture(scope="module")
def solution() -> abut.Solution:
    model = pushed()
    return abut.solve(replace(model, probes=[abut.Probe("edge", on="upper.bottom")]))


def test_ten_lines_at_most(solution: abut.Solution) -> None:
    """A terminal's worth, whatever it holds, with the numbers that one looks for first."""
    step, contact = solution.steps[-1], solution.contacts[0]
    for record in (
        solution,
        step,
        contact,
        contact.friction,
        contact.contactor,
        solution.model.mesh,
        solution.probes[0],
    ):
        text = repr(record)
        assert len(text.splitlines()) <= LINES, text
        assert max(map(len, text.splitlines())) < 200, text
        assert "array([" not in text
    assert f"largest pressure {contact.max_pressure:.6g}" in repr(solution)
    assert f"all {len(solution.certificate)} checks pass" in repr(solution)
    many = replace(step, contacts=(contact,) * 40)
    failed = replace(solution, steps=(replace(many, converged=False, reaction=step.reaction + 1.0),))
    assert len(repr(failed).splitlines()) <= LINES
    assert "not converged" in repr(failed)
    assert "and 36 more contacts" in repr(failed)
    assert "checks FAIL: model balance" in repr(failed)


def test_pressure_by_node(solution: abut.Solution) -> None:
    """The pressure of each facet's nodes, in the mesh's numbers; the mean where facets differ."""
    contact, side = solution.contacts[0], solution.contacts[0].contactor
    assert contact.nodes.tolist() == solution.model.mesh.nodes_of("upper.bottom").tolist()
    for node, value, gap in zip(contact.nodes, contact.nodal_pressure, contact.nodal_gap):
        at = side.nodes == node
        assert value == pytest.approx(contact.pressure[at].mean(), rel=1e-12)
        assert gap == pytest.approx(contact.gap[at].mean(), abs=1e-15)
    halves = replace(contact, pressure=np.where(np.arange(len(side))[:, None] < 5, 2.0, 4.0) + 0.0 * contact.pressure)
    assert sorted(set(halves.nodal_pressure)) == [2.0, 3.0, 4.0]
    none = replace(contact, pressure=np.full_like(contact.pressure, np.nan))
    assert np.isnan(none.nodal_pressure).all()


def test_the_check_is_public() -> None:
    mesh = make.join({"block": make.rectangle([0, 1], [0, 1], cells=[2, 2])})
    held = [abut.Support("block.bottom", x=0, y=0)]
    model = abut.Model(mesh, [abut.Solid("block", abut.LinearElastic(1.0, 0.3))], held, plane="strain")
    assert abut.check is diagnosis.check
    assert abut.check(model).status == 0
