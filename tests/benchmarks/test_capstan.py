"""A belt over a pulley: the closed form, in any units and for other coefficients."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import abut
from abut.benchmarks import BENCHMARKS, finite_capstan, run
from abut.benchmarks.finite_capstan import MIDDLE, RADIUS, Capstan, belt

CELLS = 24  # too few for the pressure, enough for the ratio of the forces to follow the coefficient


@pytest.mark.long
@pytest.mark.parametrize(
    "name",
    [
        "capstan", pytest.param("capstan-pulley", marks=pytest.mark.long),
        *(pytest.param(name, marks=pytest.mark.exhaustive) for name in ("capstan-tri6", "capstan-quad4")),
    ],
)  # fmt: skip
def test_closed_form(name: str) -> None:
    assert [outcome for outcome in run(BENCHMARKS[name]) if not outcome.passed] == []


@cache
def solved(length: float = 1.0, young: float = 1e3, friction: float = 0.3) -> abut.Solution:
    model = belt(0, "quad4", CELLS, length=length, young=young)
    solution = abut.solve(replace(model, contacts=[replace(model.contacts[0], friction=friction)]))
    assert solution.converged
    return solution


def pulls(solution: abut.Solution) -> np.ndarray:
    """At the slack end and at the tight end."""
    return np.array([-solution.steps[-1].reactions[end][1] for end in ("slack", "tight")])


@pytest.mark.long
def test_units() -> None:
    """Lengths in mm and moduli in MPa against metres and pascals: the same numbers, in the same steps, to rounding."""
    small, large = solved(), solved(length=1e-3, young=1e9)
    assert [len(step.iterations) for step in small.steps] == [len(step.iterations) for step in large.steps]
    np.testing.assert_allclose(1e-3 * pulls(large), pulls(small), rtol=1e-9)
    assert 1e-6 * large.contacts[0].max_pressure == pytest.approx(small.contacts[0].max_pressure, rel=1e-9)


@pytest.mark.long
def test_another_coefficient() -> None:
    """A belt with a coefficient of 0.27 is told from one with 0.3: the ratio falls with the closed form's exponential, to
    what the resistance to bending of so few linear cells changes in it."""
    rough, smooth = pulls(solved()), pulls(solved(friction=0.27))
    wanted = np.exp(-0.03 * np.pi * RADIUS / MIDDLE)  # 0.913
    assert smooth[1] / smooth[0] / (rough[1] / rough[0]) == pytest.approx(wanted, rel=1e-2)


def test_a_thin_belt_is_a_string(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without thickness the closed form is Euler's; with it, and without resistance to bending, that of moments about the
    axis, exp(mu pi R / r), to second order in mu t / R."""
    monkeypatch.setattr(finite_capstan, "STIFFNESS", 1e-12)
    moments = np.exp(finite_capstan.FRICTION * np.pi * RADIUS / MIDDLE)
    assert Capstan.of(1.0, 2.5).ratio == pytest.approx(moments, rel=3e-3)
    monkeypatch.setattr(finite_capstan, "THICKNESS", 1e-9)
    monkeypatch.setattr(finite_capstan, "MIDDLE", RADIUS)
    assert Capstan.of(1.0, 2.5).ratio == pytest.approx(np.exp(0.3 * np.pi), rel=1e-6)
