"""Quadratic convergence of every load step at large sliding: the last three residuals."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

import abut
from abut.benchmarks.finite_contact import _crushed, ironing
from models.convergence import quadratic_falls
from models.sliding import arched, pressed_in_space


def _half_ring() -> abut.Model:
    """In steps of at most a twentieth: those that follow the onset of slip are so short that they begin near the end."""
    return replace(_crushed(0.5), solve=abut.SolveOptions(steps=20))


def _ironed() -> abut.Model:
    """In steps of at most a sixtieth."""
    return replace(ironing(0), solve=abut.SolveOptions(steps=60))


@pytest.mark.long
@pytest.mark.parametrize(
    "model",
    [
        pytest.param(lambda: arched(0.3), id="friction"),
        pytest.param(lambda: arched(0.0, "quad8"), id="quadratic cells"),
        pytest.param(lambda: pressed_in_space(0.3), id="in space, with friction"),
        pytest.param(_half_ring, id="half ring"),
        pytest.param(_ironed, id="ironing", marks=pytest.mark.long),
    ],
)
def test_the_last_residuals_fall_quadratically(model: Callable[[], abut.Model]) -> None:
    solution = abut.solve(model())
    assert solution.converged
    falls, slow = quadratic_falls(solution)
    assert falls >= len(solution.steps)
    assert slow == []
