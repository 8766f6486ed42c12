"""Finite deformation against closed forms: every record that ``abut verify`` runs, and Cook's membrane by mesh."""

from __future__ import annotations

import pytest

import abut
from abut.benchmarks import BENCHMARKS, run
from abut.benchmarks.finite_beams import elastica
from abut.benchmarks.finite_rubber import cook, cook_tip

FINITE = [name for name in BENCHMARKS if name.startswith("finite")]


@pytest.mark.parametrize("name", FINITE)
def test_closed_forms(name: str) -> None:
    missed = [outcome for outcome in run(BENCHMARKS[name]) if not outcome.passed]
    assert missed == []


@pytest.mark.parametrize("name", ["finite-cylinder", "finite-tube", "finite-sphere"])
def test_second_order(name: str) -> None:
    assert [outcome for outcome in run(BENCHMARKS[name], levels=2) if not outcome.passed] == []


@pytest.mark.parametrize(("n", "tip"), [(4, 6.173), (8, 6.674), (16, 6.834)])
def test_cook_by_mesh(n: int, tip: float) -> None:
    """Values of another implementation of F-bar, with four digits."""
    assert cook_tip(abut.solve(cook(n))) == pytest.approx(tip, abs=5.1e-4)


@pytest.mark.parametrize(("push", "across", "along"), [(1.0, 0.30172, 0.05643), (10.0, 0.81061, 0.55500)])
def test_elastica(push: float, across: float, along: float) -> None:
    """The table of Mattiasson 1981, to its digits."""
    assert elastica(push) == pytest.approx((across, along), abs=6e-6)
