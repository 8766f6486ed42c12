"""Supports that come and go: a bar of 1 x 1 x 2, E = 1000, no Poisson's ratio, so that a force F shortens it by F / 500."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.analysis.static import solve
from abut.benchmarks import BENCHMARKS, run
from abut.mesh import make
from abut.problem.holds import HELD

E, LENGTH = 1000.0, 2.0
MESH = make.join({"bar": make.box([0, 1], [0, 1], [0, LENGTH], cells=[1, 1, 2])})
GIVES = 10.0 / HELD  # a node's spring beside a column of cells: what it gives, over the displacement


def bar(*holds: abut.Hold, force: abut.Amplitude | None = None, **more: object) -> abut.Model:
    loads = [] if force is None else [abut.Force("bar.top", (0.0, 0.0, -4.0), amplitude=force)]
    solid = abut.Solid("bar", abut.LinearElastic(E, 0.0))
    support = abut.Support("bar.bottom", x=0, y=0, z=0)
    return abut.Model(MESH, solids=[solid], supports=[support], loads=loads, holds=holds, **more)


def top(step: abut.solution.Step) -> float:
    return float(step.displacement[MESH.nodes_of("bar.top"), 2].mean())


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_held_and_let_go(kinematics: str) -> None:
    """Pressed by 0.02 up to 0.25, held to 0.5, half of the force gone at 0.625, all of it at 0.75."""
    clamp = abut.Hold("bar.top", z=-0.02, reached=0.25, until=0.5, released=0.75)
    model = bar(clamp, kinematics=kinematics, solve=abut.SolveOptions(times=(0.125, 0.25, 0.5, 0.625, 0.75, 1.0)))
    solution = solve(model)
    assert [step.factor for step in solution.steps] == [0.125, 0.25, 0.5, 0.625, 0.75, 1.0]
    wanted = np.array([-0.01, -0.02, -0.02, -0.01, 0.0, 0.0])
    # Saint Venant and Kirchhoff's stress is not linear: half of the force is not half of the way
    near = 0.02 * GIVES if kinematics == "small" else 2e-4
    assert [top(step) for step in solution.steps] == pytest.approx(wanted, abs=near)
    for step, height in zip(solution.steps, wanted):
        if kinematics == "small":
            assert step.reactions["bar.top"][2] == pytest.approx(E / LENGTH * height, abs=10.0 * GIVES)
        assert step.reactions["bar.bottom"][2] == pytest.approx(-step.reactions["bar.top"][2], abs=1e-8)
    assert all(check.passed for check in solution.certificate)


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_held_where_it_is(kinematics: str) -> None:
    """Loaded, held where it is at 0.5, unloaded: the hold keeps the load's force, which it had not at first."""
    pulse = abut.Amplitude(((0.0, 0.0), (0.5, 1.0), (1.0, 0.0)))
    solution = solve(bar(abut.Hold("bar.top", z="stay", since=0.5), force=pulse, kinematics=kinematics))
    half, end = (next(s for s in solution.steps if s.factor == time) for time in (0.5, 1.0))
    assert top(end) == pytest.approx(top(half), rel=GIVES)
    assert half.reactions["bar.top"][2] == pytest.approx(0.0, abs=1e-9)
    assert end.reactions["bar.top"][2] == pytest.approx(-4.0, rel=2.0 * GIVES)
    assert all(check.passed for check in solution.certificate)


def test_led_from_where_it_is() -> None:
    """Loaded to -0.016 at 0.5, then led back to 0.004 at 1 in a straight line, with the load still on."""
    load = abut.Amplitude(((0.0, 0.0), (0.5, 2.0), (1.0, 2.0)))
    hold = abut.Hold("bar.top", z=0.004, since=0.5)
    solution = solve(bar(hold, force=load, solve=abut.SolveOptions(times=(0.5, 0.75, 1.0))))
    assert [top(step) for step in solution.steps] == pytest.approx([-0.016, -0.006, 0.004], abs=0.02 * GIVES)
    assert solution.steps[-1].reactions["bar.top"][2] == pytest.approx(8.0 + 0.004 * E / LENGTH, rel=2.0 * GIVES)


def test_loose_until_held_is_refused_or_held() -> None:
    """A hold from the outset restrains what has no other support; it is said where a part is loose without it."""
    solid = abut.Solid("bar", abut.LinearElastic(E, 0.0))
    both = [abut.Hold("bar.bottom", x=0, y=0, z=0, name="below"), abut.Hold("bar.top", z=-0.02, name="above")]
    solution = solve(abut.Model(MESH, solids=[solid], holds=both))
    assert top(solution.steps[-1]) == pytest.approx(-0.02, rel=GIVES)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({}, "no component is held"),
        ({"x": "stop"}, 'expected a displacement or "stay"'),
        ({"x": 0.0, "since": 0.5, "until": 0.4}, "expected times 0 <= since < reached <= until < released"),
        ({"x": 0.0, "released": 0.5}, "released goes with until"),
        ({"x": float("nan")}, "finite"),
    ],
)
def test_what_is_no_hold(given: dict[str, object], words: str) -> None:
    with pytest.raises(abut.InputError, match=words):
        abut.Hold("bar.top", **given)


def test_places_are_checked() -> None:
    with pytest.raises(abut.InputError, match=r"holds\[0\].on: no surface, node set or body named 'bar.topp'"):
        bar(abut.Hold("bar.topp", z=0.0))


def test_stretched_loaded_let_go_and_locked() -> None:
    """The benchmark `holds`: displacement and force at every time are those of a spring E A / L."""
    for outcome in run(BENCHMARKS["holds"]):
        assert outcome.passed, outcome
