"""What load steps show of tractions that rise to the limit of friction, theory (R21), (R22)."""

from __future__ import annotations

import math

import numpy as np
import pytest

from abut.problem.onset import Most, ahead, missed_by_chord, until_slip

SHARES = np.linspace(0.0, 1.0, 4001)  # of a step


@pytest.mark.parametrize("corner", [0.1, 0.25, 0.5, 0.9])
@pytest.mark.parametrize("rate", [0.3, 2.0])
def test_what_a_chord_misses_of_a_corner(corner: float, rate: float) -> None:
    """A traction that rises at a constant rate to its limit, at a share of the step, and stays: what is furthest from the
    line from its first value to its last."""
    rise, off = rate * corner, rate * (1.0 - corner)
    traction = np.minimum(rate * SHARES, rise)
    furthest = (traction - rise * SHARES).max()
    assert missed_by_chord(np.array([rise]), np.array([off]))[0] == pytest.approx(furthest, abs=1e-3 * rate)


def test_a_step_that_ends_where_slip_begins_misses_nothing() -> None:
    assert missed_by_chord(np.array([0.7, 0.0]), np.array([0.0, 0.0])).tolist() == [0.0, 0.0]


def test_when_tractions_in_the_plane_reach_their_limit() -> None:
    """In any direction, turning back from the limit among them; what does not change never does."""
    rng = np.random.default_rng(5)
    now, change = 0.7 * rng.uniform(-1.0, 1.0, (2, 20, 2))
    now[0], change[0] = [0.6, 0.8], [-0.3, 0.0]
    change[1] = 0.0
    size, steps = until_slip(now, change)
    assert size == pytest.approx(np.linalg.norm(change, axis=1))
    assert steps[1] == math.inf
    rest = np.arange(20) > 1
    assert np.linalg.norm(now[rest] + steps[rest, None] * change[rest], axis=1) == pytest.approx(1.0, abs=1e-12)
    assert (steps[rest] > 0.0).all()


@pytest.mark.parametrize("seed", range(6))
def test_the_longest_step_whose_line_is_near_enough(seed: int) -> None:
    """Points that rise from various shares at various rates: what the line misses of their tractions, each where it is
    furthest, is what is allowed; half of them may not slip before."""
    rng = np.random.default_rng(seed)
    limits, now, rate = rng.uniform(0.2, 1.0, 9), rng.uniform(0.0, 0.9, 9), rng.uniform(0.05, 0.6, 9)
    most = Most(fresh=1e-9, bent=0.02)
    size, steps = until_slip(now[:, None], rate[:, None])
    longest = ahead(most, limits.sum(), limits, size, steps)
    traction = np.minimum(now[:, None] + rate[:, None] * longest * SHARES, 1.0)
    line = now[:, None] + (traction[:, -1:] - now[:, None]) * SHARES
    missed = limits @ (traction - line).max(axis=1) / limits.sum()
    assert missed == pytest.approx(most.bent, rel=5e-3)
    half = ahead(Most(fresh=0.5, bent=0.02), limits.sum(), limits, size, steps)
    order = np.argsort(steps)
    assert half == pytest.approx(max(longest, steps[order][np.cumsum(limits[order]) > 0.5 * limits.sum()][0]))


def test_nothing_ahead() -> None:
    """Where tractions do not change, or so little slips that no line can miss more."""
    nothing = np.zeros(0)
    assert ahead(Most(0.1, 0.01), 1.0, nothing, nothing, nothing) == math.inf
    assert ahead(Most(0.1, 0.01), 1.0, np.array([0.9]), np.zeros(1), np.array([math.inf])) == math.inf
    assert ahead(Most(0.1, 0.01), 1.0, np.array([0.05]), np.array([0.1]), np.array([2.0])) == math.inf
