"""Multigrid at large displacements and sliding: the states of the direct solver, one hierarchy a load step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.linear import iterative
from abut.mesh import make
from models.sliding import FIRST, SOFT, THEN, arched, bent

TWO_STEPS = abut.SolveOptions(times=(0.4, 1.0))
AGREE = 1e-6  # equilibrium is met to 1e-9 of the largest force, and pressures and slip are worse conditioned


def both(model: abut.Model) -> tuple[abut.Solution, abut.Solution]:
    """By multigrid and directly, in the same load steps."""
    found, times = [], []
    for kind in ("amg", "direct"):
        ends: list[float] = []
        own = replace(model, solve=replace(model.solve, linear=kind))
        found.append(abut.solve(own, on_step=lambda _, saved, ends=ends: ends.append(saved.state.time)))
        times.append(ends)
    assert all(solution.converged for solution in found)
    assert "multigrid" in found[0].solver
    assert not any("takes this step" in note for note in found[0].notes)
    assert times[0] == pytest.approx(times[1])
    return found[0], found[1]


def assert_same(model: abut.Model) -> abut.Solution:
    ours, direct = both(model)
    for step, other in zip(ours.steps, direct.steps):
        size = np.abs(other.displacement).max()
        assert np.abs(step.displacement - other.displacement).max() < AGREE * size
        for contact, reference in zip(step.contacts, other.contacts):
            largest = np.nanmax(np.abs(reference.pressure), initial=1e-300)
            assert np.nanmax(np.abs(contact.pressure - reference.pressure), initial=0.0) < AGREE * largest
    return ours


def cushion(friction: float, cell: str, cells: tuple[int, int]) -> abut.Model:
    """A block with a curved underside pressed 0.04 into a plate, then slid by 0.12, aslant."""
    n, m = cells
    lower = make.box([0, 1.2], [0, 1], [0, 0.6], cells=[n, n, 1], cell=cell)
    upper = bent(
        make.box([0.2, 0.8], [0.2, 0.8], [0.6, 1.1], cells=[m, m, 1], cell=cell),
        lambda x: x + np.outer(0.2 * (1.1 - x[:, 2]) * ((x[:, 0] - 0.5) ** 2 + (x[:, 1] - 0.5) ** 2), [0, 0, 1]),
    )
    return abut.Model(
        make.join({"lower": lower, "upper": upper}), kinematics="finite",
        solids=[abut.Solid("lower", SOFT), abut.Solid("upper", abut.NeoHooke(200.0, 0.3))],
        supports=[
            abut.Support("lower.bottom", x=0, y=0, z=0), abut.Support("upper.top", z=-0.04, amplitude=FIRST),
            abut.Support("upper.top", x=0.12, y=0.05, amplitude=THEN),
        ],
        contacts=[abut.Contact("upper.bottom", "lower.top", friction=friction)], solve=TWO_STEPS,
    )  # fmt: skip


@pytest.mark.parametrize(("cell", "friction", "cells"), [("hex8", 0.3, (4, 3)), ("tet10", 0.3, (2, 1))])
def test_pressed_and_slid_in_space(cell: str, friction: float, cells: tuple[int, int]) -> None:
    solution = assert_same(cushion(friction, cell, cells))
    rows = solution.steps[-1].iterations[-1]
    assert rows.slipping
    assert rows.slipping > 3


def test_in_the_plane() -> None:
    assert_same(arched(0.3, "quad8", slide=0.1, solve=TWO_STEPS))
