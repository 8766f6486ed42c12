"""Benchmarks of what job files join and begin with: references, equations, stops, modes, jobs after each other."""

from __future__ import annotations

import pytest

from abut.benchmarks import BENCHMARKS, run, started
from abut.errors import AbutError

NAMES = (
    "start-plastic",
    "start-fit",
    "start-holds",
    "coupled-beam",
    "coupled-shaft",
    "lever",
    "stop",
    "bars-ring",
    "strut",
)


@pytest.mark.parametrize("name", NAMES)
def test_closed_form(name: str) -> None:
    for outcome in run(BENCHMARKS[name]):
        assert outcome.passed, outcome


def test_steps_solved_again_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """A second job that solves the steps of the first one itself has the same results, and shows nothing."""
    monkeypatch.setattr(started, "load_start", lambda *_: ())
    with pytest.raises(AbutError, match=r"steps after 0\.5 only, got some at 0\.25"):
        run(BENCHMARKS["start-plastic"])
