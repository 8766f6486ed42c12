"""What load steps leave open of friction: points that touch and stick in the same step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.diagnosis.cures import cures
from abut.problem.step_error import PairEnd, landed
from models.sliding import arched, finite

FRICTION = 0.3


def test_only_points_that_touch_and_stick_count() -> None:
    """Three points of six: one was closed, one slips, one sticks. Its shift makes the traction E/h times it, up to the
    limit."""
    problem = finite(arched(FRICTION))
    (pair,) = problem.pairs
    n, weight, pressure = len(pair.space), pair.weight[pair.normal], 2.0
    multipliers = np.where(np.arange(len(pair)) < n, pressure, 0.0)

    def share(shift: float, was_open: tuple[int, ...], slips: tuple[int, ...] = ()) -> float:
        def marked(functions: tuple[int, ...]) -> NDArray[np.bool_]:
            return pair.of_functions(np.isin(np.arange(n), functions))

        end = PairEnd(
            multipliers, np.ones(len(pair), bool), marked(slips), marked(was_open),
            np.full(len(pair) - n, shift) * pair.weight[pair.tangential],
        )  # fmt: skip
        return landed(pair, end, np.ones(len(problem.model.histories))).share

    limit = FRICTION * pressure
    small = 0.25 * limit / pair.stiffness
    assert share(small, (2,)) == pytest.approx(0.25 * weight[2] / weight.sum(), rel=1e-12)
    assert share(small, (2, 3), slips=(3,)) == pytest.approx(0.25 * weight[2] / weight.sum(), rel=1e-12)
    assert share(1e3 * small, (2,)) == pytest.approx(weight[2] / weight.sum(), rel=1e-12)
    assert share(small, ()) == 0.0


@pytest.mark.long
def test_more_steps_leave_less_open_and_the_certificate_says_so() -> None:
    """A round block that is pressed down: in one step all of it touches and sticks, in 16 a node at a time. The line is
    of all steps together."""
    model = arched(FRICTION, slide=0.0)
    one, many = (abut.solve(replace(model, solve=abut.SolveOptions(steps=n))) for n in (1, 16))
    few, fine = (next(c for c in each.certificate if c.name == "load steps") for each in (one, many))
    assert few.value > 0.015
    assert fine.passed
    assert fine.value < 0.2 * few.value
    half = replace(one, steps=tuple(replace(step, landed=(0.1 * (step is one.steps[0]), 1.0)) for step in one.steps))
    line = next(c for c in half.certificate if c.name == "load steps")
    assert line.value == pytest.approx(0.1 / len(one.steps))
    off = replace(one, steps=tuple(replace(step, landed=(0.06, 1.0)) for step in one.steps))
    (failed,) = (text for check, text in cures(off) if check.name == "load steps")
    assert "solve.steps" in failed
