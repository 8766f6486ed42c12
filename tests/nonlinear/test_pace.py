"""Automatic load steps: lengths, goals, cuts."""

from __future__ import annotations

import pytest

from abut.model import Amplitude
from abut.nonlinear.pace import Pace, pace_of


def ends(pace: Pace, iterations: int) -> list[float]:
    result = []
    while (end := pace.end) is not None:
        result.append(end)
        pace.take(iterations)
    return result


def test_easy_steps_grow_and_end_at_the_goal() -> None:
    found = ends(Pace([1.0]), 3)
    assert found[0] == 0.1
    assert abs(found[1] - 0.25) < 1e-12
    assert found[-1] == 1.0
    lengths = [b - a for a, b in zip([0.0, *found], found)]
    assert min(lengths) >= 0.1 - 1e-12  # the way left is shared out: no crumb at the end


def test_hard_steps_shrink() -> None:
    pace = Pace([1.0])
    pace.take(20)
    assert abs(pace.end - 0.17) < 1e-12


def test_a_cut_halves_and_gives_up_at_last() -> None:
    pace, halved = Pace([1.0]), 0
    pace.halve()
    assert pace.end == 0.05
    while not pace.stuck:
        pace.halve()
        halved += 1
    assert 5 < halved < 15


def test_kinks_are_met_and_begun_anew() -> None:
    turn = Amplitude(((0.0, 0.0), (0.3, 1.0), (1.0, 1.0)))
    found = ends(pace_of("auto", None, (None, turn)), 2)
    assert 0.3 in found
    after = found[found.index(0.3) + 1]
    assert abs(after - 0.37) < 1e-12


def test_points_of_a_straight_history_are_met_in_passing() -> None:
    straight = Amplitude(((0.0, 0.0), (0.5, 0.5), (1.0, 1.0)))
    pace = pace_of("auto", None, (straight,))
    found, lengths = [], []
    while (end := pace.end) is not None:
        found.append(end)
        lengths.append(end - pace.time)
        pace.take(2)
        assert not pace.turned
    assert 0.5 in found
    assert lengths[found.index(0.5) + 1] > lengths[0]


def test_given_numbers_and_times() -> None:
    assert ends(pace_of(4, None, (None,)), 2) == [0.25, 0.5, 0.75, 1.0]
    assert ends(pace_of(1, None, (None,)), 2) == [1.0]
    assert ends(pace_of("auto", (0.2, 0.9), (None,)), 2) == [0.2, 0.9]


def test_an_earlier_run_is_followed() -> None:
    pace, followed = Pace([1.0]), Pace([1.0])
    done = []
    for iterations in (3, 20, 4):
        pace.halve()
        done.append((pace.end, iterations))
        pace.take(iterations)
    for time, iterations in done:
        followed.repeat(time, iterations)
    assert followed.end == pace.end


def test_steps_in_which_friction_lands_are_followed_by_shorter_ones() -> None:
    """Automatic ones only: as the share goes with more than the square of the step, by its root, and by half at most."""
    easy, hard, much, given = Pace([1.0]), Pace([1.0]), Pace([1.0]), Pace([1.0], 0.1, first=1.0)
    for pace, share in ((easy, 0.001), (hard, 0.02), (much, 1.0), (given, 1.0)):
        pace.take(3, share)
    lengths = [pace.end - pace.time for pace in (easy, hard, much, given)]
    assert lengths == pytest.approx([0.15, 0.1 * 0.5**0.5, 0.05, 0.1])
