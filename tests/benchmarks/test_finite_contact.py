"""Large sliding from default settings: forces, and what it takes to get there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.benchmarks import BENCHMARKS, run
from abut.benchmarks.finite_contact import ironing


@pytest.mark.long
@pytest.mark.parametrize(
    "name",
    [
        "shallow-ironing", "crushed-ring", "crushed-ring-friction", "crushed-ring-isochoric", "gears", "die-drawn-hex8",
        *(pytest.param(name, marks=pytest.mark.long) for name in ("die-drawn-hex20", "wires")),
        pytest.param("die-drawn-tet10", marks=pytest.mark.exhaustive),
    ],
)  # fmt: skip
def test_known_answer(name: str) -> None:
    missed = [outcome for outcome in run(BENCHMARKS[name]) if not outcome.passed]
    assert missed == []


def test_ironing_in_plane_stress() -> None:
    """The same prototype's forces in plane stress, pressed down only: 0.835e8, 2.80e8, of a die that is a polygon."""
    solution = abut.solve(replace(ironing(0), plane="stress", solve=abut.SolveOptions(times=(1 / 6, 1 / 3))))
    half, down = (
        next(step.reactions["die.top"][1] for step in solution.steps if np.isclose(step.factor, time))
        for time in (1 / 6, 1 / 3)
    )
    assert -half == pytest.approx(0.835e8, rel=0.015)
    assert -down == pytest.approx(2.80e8, rel=0.01)
