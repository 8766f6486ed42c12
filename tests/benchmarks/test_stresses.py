"""Stresses at contact nodes beside closed forms (``bench/stress/table.py`` has all cells)."""

from __future__ import annotations

import pytest

import abut
from models.stresses import ball_errors, fit_errors, hertz_ball, hertz_line, line_errors, press_fit

LINEAR, SECOND = 0.05, 0.015  # of the largest pressure or von Mises stress: what an engineer reads stresses to
SHEAR = 0.02
BALL = 0.005  # of the half space that the ball is taken for: a / R = 0.013, of which stresses along the surface feel a part


@pytest.mark.parametrize(
    ("cell", "n", "limit"), [("tri3", 8, LINEAR), ("quad4", 8, LINEAR), ("tri6", 8, SECOND), ("quad8", 8, SECOND)]
)
def test_hertz_line(cell: str, n: int, limit: float) -> None:
    errors = line_errors(abut.solve(hertz_line(cell, n)))
    assert errors["normal"] < limit
    assert errors["von Mises"] < limit
    assert abs(errors["shear"]) < SHEAR


@pytest.mark.parametrize(
    ("cell", "n", "limit"),
    [
        ("tri3", 6, LINEAR),
        ("tri3", 12, LINEAR),
        ("quad4", 6, LINEAR),
        ("hex8", 6, LINEAR),
        ("tri6", 6, SECOND),
        ("quad8", 6, SECOND),
        ("quad8", 12, SECOND),
    ],
)
def test_hertz_ball(cell: str, n: int, limit: float) -> None:
    """The largest shear is told by nodes only where a cell is small beside its depth: not of hex8, whose layers double."""
    errors = ball_errors(abut.solve(hertz_ball(cell, n)))
    assert errors["normal"] < limit
    assert errors["von Mises"] < limit + BALL
    assert abs(errors["shear"]) < SHEAR or cell == "hex8"


@pytest.mark.long
def test_largest_shear_under_an_octant() -> None:
    """Of hex8 in layers that grow by a quarter."""
    assert abs(ball_errors(abut.solve(hertz_ball("hex8", 6, 1.25)))["shear"]) < SHEAR


@pytest.mark.parametrize(
    ("cell", "n", "limit"), [("tri3", 8, SECOND), ("quad4", 8, LINEAR), ("quad8", 6, SECOND), ("tri6", 6, SECOND)]
)
def test_lame_press_fit(cell: str, n: int, limit: float) -> None:
    """On the planes of symmetry too, where the chord of the last facet is not normal to the radius."""
    errors = fit_errors(abut.solve(press_fit(cell, n)))
    assert errors["normal"] < limit
    assert errors["von Mises"] < limit
