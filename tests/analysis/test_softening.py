"""A constraint function softened by a large epsilon is told by how much it lowers the pressure."""

from __future__ import annotations

import pytest

import abut
from abut.diagnosis.cures import cure
from models.certificate import ball, line


def told(solution: abut.Solution) -> str:
    return next((check.verdict for check in solution.certificate if check.name == "softening"), "")


@pytest.mark.parametrize(("epsilon", "verdict"), [(1e-12, ""), (1e-3, ""), (1.0, "warn"), (10.0, "FAIL")])
def test_the_verdict_follows_the_peak(epsilon: float, verdict: str) -> None:
    """Of a Hertz contact: beside complementarity the peak is lower by less than 2 % where nothing is said, by 2 to 20 %
    where it
    warns, by more where it fails; more than all of it cannot be lost."""
    right = abut.solve(ball("quad4", 10)).contacts[0].max_pressure
    solution = abut.solve(ball("quad4", 10, law="constraint-function", epsilon=epsilon))
    lost = 1.0 - solution.contacts[0].max_pressure / right
    assert told(solution) == verdict
    low, high = {"": (-0.02, 0.02), "warn": (0.02, 0.2), "FAIL": (0.2, 1.0)}[verdict]
    assert low < lost < high
    for check in solution.certificate:
        if check.name == "softening":
            assert 0.25 < lost / min(check.value, 1.0) < 1.5
            assert "complementarity" in cure(check, solution)


def test_complementarity_has_no_such_line() -> None:
    assert told(abut.solve(line("quad4", (6, 6)))) == ""
