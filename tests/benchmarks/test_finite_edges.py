"""Models that once stopped on the way: over sharp edges, by sharp ends, stacks of leaves, a rough pad, a wheel in its
backlash, rollers in races, slip that begins."""

from __future__ import annotations

import numpy as np
import pytest

from abut.benchmarks import BENCHMARKS, finite_edges, finite_stacks, once_stopped, run
from abut.benchmarks.finite_beams import elastica

QUICK = (
    "over-edge-quad4-ground",
    "rough-pad",
    "wheel-backlash",
    "rollers-in-races-quad4",
    "bar-drawn-2",
    "press-fit-pulled",
)
NAMES = [
    benchmark.name for benchmark in (*finite_edges.BENCHMARKS, *finite_stacks.BENCHMARKS, *once_stopped.BENCHMARKS)
]


@pytest.mark.parametrize(
    "name", [name if name in QUICK else pytest.param(name, marks=pytest.mark.long) for name in NAMES]
)
def test_known_answer(name: str) -> None:
    assert [outcome for outcome in run(BENCHMARKS[name]) if not outcome.passed] == []


def test_cantilever() -> None:
    """Integrated step by step as by elliptic integrals."""
    end, _ = finite_edges.cantilever(10.0, 1000.0, np.array([0.0, -100.0]), 0.0)
    across, along = elastica(10.0)
    assert (-end[1] / 10.0, 1.0 - end[0] / 10.0) == pytest.approx((across, along), rel=1e-6)


@pytest.mark.long
def test_forces_of_beams() -> None:
    """The kept numbers are those that the elastica gives."""
    assert finite_edges.pressed_alike() == pytest.approx(finite_edges.ALIKE, rel=1e-5)
    assert finite_edges.pressed_by_its_end(1.0, 8.0) == pytest.approx(finite_edges.BY_ITS_END, rel=1e-5)
