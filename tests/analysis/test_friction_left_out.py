"""Friction that a step leaves out, since points have only just come opposite the other side, is said."""

from __future__ import annotations

import pytest

import abut
from abut.problem.current import Current
from models.sliding import sharp


def left_out(model: abut.Model) -> list[float]:
    solution = abut.solve(model)
    assert solution.converged
    return [check.value for check in solution.certificate if check.name.endswith("friction left out")]


@pytest.mark.long
def test_nodes_that_come_under_a_sharp_edge(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where slips cannot be looked at in what is covered late, as when the step does not converge with them, a plate's nodes
    carry no friction in the step in which they come under the block's edge, where the pressure peaks."""
    assert left_out(sharp(0.3, 9)) == []
    monkeypatch.setattr(Current, "with_late", lambda _, past, *rest: past)
    (share,) = left_out(sharp(0.3, 9))
    assert share > 0.02  # the limit of the line
