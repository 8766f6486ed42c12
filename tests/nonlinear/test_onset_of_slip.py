"""Load steps that abut finds follow contact that begins to slip, theory (R21): force over displacement has points."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.benchmarks.once_stopped import FIT_FRICTION, FULL, REACH, bar, pulled
from abut.mesh import make
from abut.nonlinear.pace import Pace, Slips
from abut.nonlinear.settings import DEFAULT
from abut.problem.onset import Onset

POINTS, AIM, SMALLEST = DEFAULT.steps.points, DEFAULT.steps.aim, DEFAULT.steps.smallest
FINER = 1.0 / POINTS  # of a step that jumps over the onset


def curve(solution: abut.Solution) -> tuple[np.ndarray, np.ndarray]:
    """Times, and forces along the surface."""
    return np.array([[step.factor, abs(step.contacts[0].force[0])] for step in solution.steps]).T


@pytest.mark.parametrize(
    ("kinematics", "times"), [("small", 2.0), ("small", 200.0), pytest.param("finite", 20.0, marks=pytest.mark.long)]
)
def test_bar_drawn_along_a_block(kinematics: str, times: float) -> None:
    """It slips from the end on over a length s: force q s, displacement q s^2 / 2 E A, with q the friction per length (the
    pull-out of fibres: Hutchinson and Jensen 1990, Mech. Mater. 9). Finite strains change lengths by FULL / E A = .12 %;
    the block gives way by a hundredth of what the bar does, and the bar's end cells are of 1 / 24 of its length."""
    solution = abut.solve(bar(kinematics, times * REACH))
    assert solution.converged
    time, force = curve(solution)
    displacement = times * REACH * np.clip((time - 0.3) / 0.7, 0.0, 1.0)
    exact = np.minimum(np.sqrt(displacement / REACH), 1.0) * FULL
    assert np.abs(force - exact).max() < 0.015 * FULL
    assert ((displacement > 0.0) & (force < 0.99 * FULL)).sum() >= POINTS
    assert len(time) < 5 * POINTS


@pytest.mark.parametrize("kinematics", ["small", pytest.param("finite", marks=pytest.mark.long)])
def test_press_fit_pulled_out_in_one_ramp(kinematics: str) -> None:
    """The interference is there from the outset: the first step shows the fit alone, and what the whole of it carries at
    last is mu times the pressure."""
    solution = abut.solve(pulled(kinematics))
    assert solution.converged
    time, _ = curve(solution)
    force = np.array([step.contacts[0].force[1] for step in solution.steps])
    full = FIT_FRICTION * solution.contacts[0].force_by_area
    assert time[0] < 1e-3
    assert abs(force[0]) < 0.25 * full
    assert abs(force[-1] - full) < 1e-6 * full if kinematics == "small" else abs(force[-1] - full) < 0.03 * full
    assert ((time > time[0]) & (force < 0.99 * full)).sum() >= POINTS - 2  # of the limit a part slips in the fit alone
    assert (np.diff(force) > -2e-3 * full).all()


def test_what_slips_all_at_once_ends_in_few_steps() -> None:
    """A short block: its points slip nearly together, which no step resolves; they do not become shorter for ever."""
    mesh = make.join(
        {"block": make.rectangle([0, 2], [0, 1], cells=[2, 1]), "floor": make.rectangle([-1, 4], [-1, 0], cells=[5, 1])}
    )
    pressed, pushed = abut.Amplitude(((0, 0), (0.5, 1), (1, 1))), abut.Amplitude(((0, 0), (0.5, 0), (1, 1)))
    model = abut.Model(
        mesh,
        plane="strain",
        solids=[abut.Solid("block", abut.LinearElastic(1e5, 0)), abut.Solid("floor", abut.LinearElastic(1e5, 0))],
        supports=[abut.Support("floor.bottom", x=0, y=0), abut.Support("block.top", x=0.01, amplitude=pushed)],
        loads=[abut.Pressure("block.top", 1.0, amplitude=pressed)],
        contacts=[abut.Contact("block.bottom", "floor.top", friction=0.2)],
    )
    solution = abut.solve(model)
    time, force = curve(solution)
    assert solution.converged
    assert abs(force[-1] - 0.4) < 1e-9
    assert len(time) <= 2 * POINTS


def test_steps_that_jump_are_taken_again_and_no_shorter_than_the_smallest() -> None:
    all_at_once = Onset(fresh=1.0, bent=1.0, limit=1.0)
    pace, ends = Pace([1.0], first=1.0, slips=Slips()), [1.0]
    while pace.refine(all_at_once):
        assert pace.end is not None
        ends.append(pace.end)
    assert len(ends) == 5
    assert ends[-1] >= SMALLEST
    assert ends[1] == FINER
    assert not Pace([1.0], first=1.0).refine(all_at_once)


def test_a_step_that_all_slips_is_followed_by_one_of_any_length() -> None:
    pace = Pace([1.0], first=1.0, slips=Slips())
    assert pace.refine(Onset(fresh=1.0, bent=1.0, limit=1.0))
    pace.take(5, onset=Onset(fresh=0.1, bent=1e-4, sticks=0.5, limit=1.0))
    assert abs(pace.end - 3 * FINER) < 1e-12
    pace.take(5, onset=Onset(limit=1.0))
    assert pace.end == 1.0


def test_where_nothing_slips_the_next_step_ends_where_something_will() -> None:
    """No further than a fit of the length to a fourth root of a power of two; points times as long at most."""
    for foreseen, longest in ((3.0, 3.0), (100.0, POINTS)):
        pace = Pace([1.0], first=1.0, slips=Slips())
        assert pace.refine(Onset(fresh=1.0, bent=10.0, limit=1.0))
        assert pace.refine(Onset(fresh=1.0, bent=10.0, limit=1.0))
        begin = pace.end
        pace.take(5, onset=Onset(sticks=1.0, limit=1.0, ahead=foreseen))
        assert 2.0**-0.25 * longest <= (pace.end - begin) / begin <= longest * (1.0 + 1e-9)


def test_where_slip_turns_the_next_step_is_twice_as_long_at_most() -> None:
    """All slips, but not along one line yet: a step as long as the one that was refused would be refused again."""
    pace = Pace([1.0], first=1.0, slips=Slips())
    turning = Onset(fresh=0.05, turns=0.05, bent=1e-4, sticks=0.0, limit=1.0)
    assert pace.refine(Onset(fresh=1.0, bent=1.0, limit=1.0))
    begin = pace.end
    pace.take(5, onset=turning)
    assert begin < pace.end <= 3.0 * begin * (1.0 + 1e-12)


def test_a_step_that_no_line_misses_is_followed_by_one_of_any_length() -> None:
    """Whatever begins to slip in it, as long as the tractions go straight."""
    pace = Pace([1.0], first=1.0, slips=Slips())
    assert not pace.refine(Onset(fresh=1.0, bent=0.0, sticks=0.5, limit=1.0))
    assert pace.end == 1.0


@pytest.mark.parametrize(("fresh", "refused"), [(1.9 / POINTS, False), (2.1 / POINTS, True)])
def test_a_step_is_refused_where_less_than_half_of_it_would_do(fresh: float, refused: bool) -> None:
    """Theory (R21): a point of the onset for each ``POINTS``-th part of friction."""
    pace = Pace([1.0], first=1.0, slips=Slips())
    assert pace.refine(Onset(fresh=fresh, bent=1e6, limit=1.0)) is refused


def test_a_step_need_be_no_shorter_than_one_of_so_many_points() -> None:
    """However far a straight line misses the tractions: (R21) asks for a ``POINTS``-th of friction in a step."""
    pace = Pace([1.0], first=1.0, slips=Slips())
    assert pace.refine(Onset(fresh=1.0, bent=1.0, limit=1.0))
    begin = pace.end
    pace.take(5, onset=Onset(fresh=1.0 / POINTS, bent=1e6, sticks=0.5, limit=1.0))
    assert 2.0**-0.25 * AIM <= (pace.end - begin) / begin <= AIM * (1.0 + 1e-9)


def test_where_all_slips_only_its_turns_make_the_next_step_shorter() -> None:
    """What began to slip has done so, and goes on along its line."""
    pace = Pace([1.0], first=1.0, slips=Slips())
    assert pace.refine(Onset(fresh=1.0, bent=1.0, limit=1.0))
    pace.take(5, onset=Onset(fresh=0.5, turns=0.0, bent=1.0, sticks=0.0, limit=1.0))
    assert pace.end == 1.0


def test_a_fit_alone_says_nothing_of_the_step_after_it() -> None:
    """A first step as short as can be shows what presses before loads do anything: the next one is as long as ever, and
    tractions do not go on as in it."""
    pace, usual = Pace([1.0], slips=Slips(fits=True)), Pace([1.0])
    assert pace.end == SMALLEST
    pace.take(100, onset=Onset(fresh=1.0, bent=1.0, sticks=0.5, limit=1.0))
    assert not pace.goes_on
    assert pace.end is not None
    assert pace.end - SMALLEST == pytest.approx(usual.end)


def test_after_a_leg_tractions_do_not_go_on() -> None:
    pace = Pace([0.5, 1.0], legs=(0.5,), slips=Slips())
    while pace.time < 0.5:
        pace.take(5, onset=Onset(sticks=0.5, limit=1.0))
        assert pace.goes_on is (pace.time < 0.5)


def test_a_stride_is_taken_whatever_the_onset_asked_for() -> None:
    pace = Pace([1.0], first=1.0, slips=Slips())
    assert pace.refine(Onset(fresh=1.0, bent=1.0, limit=1.0))
    pace.stride(0.25)
    assert pace.end == 0.25


def test_a_run_that_the_onset_cut_is_followed() -> None:
    """A restart knows where steps ended, not what asked for it: lengths that halving does not lead to."""
    pace = Pace([1.0], first=1.0, slips=Slips())
    onset = Onset(fresh=0.1, bent=1e-4, sticks=0.5, limit=1.0)
    assert pace.refine(Onset(fresh=0.3, bent=1.0, limit=1.0))
    time = pace.end
    pace.take(5, onset=onset)
    followed = Pace([1.0], first=1.0, slips=Slips())
    followed.repeat(time, 5, onset=onset)
    assert (followed.time, followed.end) == (time, pace.end)


def test_what_sticks_and_begins_again_has_had_its_points() -> None:
    """Once as much as carries all of friction has begun to slip, steps follow no more of it until the way ahead is new."""
    again, pace = (
        Onset(fresh=FINER, bent=1.0, sticks=0.5, limit=1.0),
        Pace([0.5, 1.0], legs=[0.5], kinks=[0.5], slips=Slips()),
    )
    while not pace.refine(replace(again, fresh=1.0)):
        pace.take(5, onset=again)
    for _ in range(POINTS):
        assert pace.time < 0.5
        before, end = pace.time, pace.end
        assert end is not None
        pace.take(5, onset=again)
    assert pace.end - pace.time > 1.4 * (end - before)
    assert not pace.refine(replace(again, fresh=1.0))
    while pace.time < 0.5:
        pace.take(5, onset=again)
    assert pace.refine(replace(again, fresh=1.0))
