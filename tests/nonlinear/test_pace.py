"""Automatic load steps: lengths, goals, cuts."""

from __future__ import annotations

import pytest

from abut.errors import InputError
from abut.model import Amplitude, SolveOptions
from abut.nonlinear.pace import Pace, given_pace, pace_of
from abut.nonlinear.settings import DEFAULT

STEPS = DEFAULT.steps
FIRST, EASY, GROWTH, SMALLEST = STEPS.first, STEPS.easy, STEPS.growth, STEPS.smallest
HARD, SHRINK = 2 * EASY, STEPS.shrink


def ends(pace: Pace, iterations: int) -> list[float]:
    result = []
    while (end := pace.end) is not None:
        result.append(end)
        pace.take(iterations)
    return result


def test_easy_steps_grow_and_end_at_the_goal() -> None:
    found = ends(Pace([1.0]), 3)
    assert found[0] == 0.1
    assert abs(found[1] - FIRST * (1.0 + GROWTH)) < 1e-12
    assert found[-1] == 1.0
    lengths = [b - a for a, b in zip([0.0, *found], found)]
    assert min(lengths) >= 0.1 - 1e-12  # the way left is shared out: no crumb at the end


def test_hard_steps_shrink() -> None:
    pace = Pace([1.0])
    pace.take(20)
    assert abs(pace.end - (FIRST + SHRINK * FIRST)) < 1e-12


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


@pytest.mark.parametrize("time", [1e-15, 1e-12, 0.9999999999999, 0.9999999999999998])
@pytest.mark.parametrize(
    ("steps", "times"), [("auto", None), (4, None), ("auto", (0.5, 1.0)), ("auto", (0.5, 1 - 1e-16))]
)
def test_points_of_a_history_at_its_ends_but_for_rounding(
    time: float, steps: int | str, times: tuple[float, ...] | None
) -> None:
    """As dividing by the last time gives them: they are the ends, so that steps are those of a history without them."""
    rounded = Amplitude(((-1e-13, 0.0), (time, 1.0), (1.0, 1.5)))
    found = ends(pace_of(steps, times, (rounded,)), 3)
    assert found == ends(pace_of(steps, times, (None,)), 3)


def test_points_of_histories_that_are_one_but_for_rounding() -> None:
    """7 times 0.1 of one is 0.7 of another: one step ends there, the way ahead is new, and a time that is given counts."""
    other = 7 * 0.1
    assert other != 0.7
    turns = [Amplitude(((0.0, 0.0), (time, 1.0), (1.0, 0.0))) for time in (0.7, other)]
    pace = pace_of(1, None, turns)
    assert ends(pace, 3) == [min(0.7, other), 1.0]
    pace = pace_of("auto", (0.7, 1.0), turns)
    pace.take(3)
    assert (pace.time, pace.turned) == (0.7, True)


def test_a_jump_of_a_history_is_one_goal() -> None:
    jump = Amplitude(((0.0, 0.0), (0.5, 0.0), (0.5 + 1e-10, 1.0), (1.0, 1.0)))
    assert ends(pace_of(1, None, (jump,)), 3) == [0.5, 1.0]


@pytest.mark.parametrize("times", [(1e-12, 1.0), (0.5, 0.5 + 1e-12, 1.0), (0.5, 1.0 - 1e-12, 1.0)])
def test_times_that_are_one_are_refused(times: tuple[float, ...]) -> None:
    with pytest.raises(InputError, match="are one time, as they differ by 1e-09 at most; leave one out"):
        SolveOptions(times=times)


@pytest.mark.parametrize(("iterations", "factor"), [(EASY, GROWTH), (EASY + 1, 1.0), (HARD, 1.0), (HARD + 1, SHRINK)])
def test_how_iterations_count(iterations: int, factor: float) -> None:
    pace = Pace([1.0])
    pace.take(iterations)
    assert pace.end - pace.time == pytest.approx(factor * FIRST)
    capped = Pace([1.0], longest=0.12)
    capped.take(1)
    assert capped.end - capped.time == pytest.approx(0.12)


def test_what_is_left_of_the_way() -> None:
    """A last step that would be shorter than the one before is shared with it; one that is as long is taken whole."""
    pace = Pace([1.0], longest=0.4, first=1.0)
    pace.take(HARD)
    assert pace.end == pytest.approx(0.7)
    pace.take(HARD)
    assert pace.end == 1.0


def test_steps_that_become_too_short() -> None:
    """``last`` is told one failure before ``stuck``, both by the way from goal to goal."""
    for legs, way in (((), 1.0), ((0.25,), 0.25)):
        pace, cuts = Pace([*legs, 1.0], legs=legs), 0
        while not pace.last:
            assert not pace.stuck
            pace.halve()
            cuts += 1
        pace.halve()
        assert pace.stuck
        assert pace.end <= SMALLEST * way < 2.0 * pace.end
        assert FIRST * 0.5 ** (cuts + 1) < SMALLEST <= FIRST * 0.5**cuts


def test_a_stride_is_followed() -> None:
    """Of an earlier run, that went on after failures with a share of the way."""
    pace, followed = Pace([1.0], legs=(0.5,)), Pace([1.0], legs=(0.5,))
    pace.stride(0.3)
    time = pace.end
    assert time == pytest.approx(0.15)  # of the way to the next leg
    pace.take(EASY)
    followed.repeat(time, EASY, stride=0.3)
    assert (followed.time, followed.end) == (time, pace.end)
    pace, followed = Pace([1.0]), Pace([1.0])
    pace.take(EASY)
    followed.repeat(FIRST, EASY, stride=0.3)  # it was another one
    assert (followed.time, followed.end) == (FIRST, pace.end)


def test_where_the_way_ahead_is_new() -> None:
    """Nor does anything go on as in a step before where there was none."""
    pace = Pace([0.1, 1.0], kinks=(0.1,))
    assert not pace.turned
    assert not pace.goes_on
    pace.take(1)
    assert pace.time == 0.1
    assert pace.turned
    assert not pace.goes_on
    pace.take(1)
    assert not pace.turned
    assert pace.goes_on


def test_given_numbers_and_times() -> None:
    assert ends(pace_of(4, None, (None,)), 2) == [0.25, 0.5, 0.75, 1.0]
    assert ends(pace_of(1, None, (None,)), 2) == [1.0]
    assert ends(pace_of("auto", (0.2, 0.9), (None,)), 2) == [0.2, 0.9]


def test_a_goal_on_the_way_does_not_shorten_the_steps_after_it() -> None:
    pace = Pace([0.3 * FIRST, 1.0])
    pace.take(EASY)
    assert pace.time == 0.3 * FIRST
    assert pace.end == pytest.approx(0.3 * FIRST + GROWTH * FIRST)


@pytest.mark.parametrize("steps", [3, 6, 7, 10, 30, 49, 100])
def test_as_many_steps_as_were_asked_for(steps: int) -> None:
    """Sums of their length differ from the end by rounding, which makes no further step."""
    found = ends(pace_of(steps, None, (None,)), EASY + 1)
    assert found == pytest.approx([k / steps for k in range(1, steps + 1)], rel=1e-12)
    assert found[-1] == 1.0


def test_a_stride_is_no_longer_than_the_longest_step() -> None:
    pace = Pace([1.0], longest=0.25)
    pace.stride(0.5)
    assert pace.end == 0.25


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
    assert lengths == pytest.approx([FIRST * GROWTH, 0.1 * 0.5**0.5, 0.05, 0.1])


def test_given_steps_are_taken_in_parts_and_grow_again() -> None:
    """Half as far where they fail, twice as far again after each part; what ends at a given time is a step."""
    pace, found = given_pace([0.5, 1.0]), []
    pace.halve()
    pace.halve()
    while (end := pace.end) is not None:
        found.append((end, pace.whole(end)))
        pace.take(50)
    assert found == [(0.125, False), (0.3125, False), (0.5, True), (1.0, True)]


def test_given_steps_end_at_last() -> None:
    pace = given_pace([1.0])
    for k in range(6):
        assert not pace.last
        pace.halve()
        assert pace.end == 0.5 ** (k + 1)
    assert pace.last
    assert given_pace([0.5, 1.0], parts=False).last
