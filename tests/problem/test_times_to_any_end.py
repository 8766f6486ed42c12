"""Times of a model run from 0 to any end: what they say does not depend on the unit that time is measured in."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

import abut
from abut.mesh import make

LONG, YOUNG, PULL = 10.0, 1000.0, 5.0
MESH = make.join({"bar": make.box([0, 1], [0, 1], [0, LONG], cells=[1, 1, 2])})
SOLID = abut.Solid("bar", abut.LinearElastic(YOUNG, 0.0, density=1.0))
BELOW = abut.Support("bar.bottom", x=0, y=0, z=0)
END = 60.0
GIVES = 1e-5  # of a way: how far a hold is drawn along by what it carries


def bar(**others: Any) -> abut.Model:
    return abut.Model(MESH, solids=[SOLID], **{"supports": [BELOW], **others})


def pulled(end: float) -> abut.Model:
    """Up to the load in half of the time, then back to half of it; over the last sixth its top is held where it is."""
    history = abut.Amplitude(((0.0, 0.0), (0.5 * end, 1.0), (end, 0.5)))
    return bar(
        loads=[abut.Force("bar.top", (0.0, 0.0, PULL), amplitude=history)],
        holds=[abut.Hold("bar.top", z="stay", since=5 / 6 * end)],
        solve=abut.SolveOptions(times=tuple(end * k / 6 for k in range(1, 7)), end=end),
    )


@pytest.mark.parametrize("end", [END, 0.001])
def test_displacements_follow_the_history(end: float) -> None:
    """F(t) L / (E A) at each time, until the top stays; the same as over a time of 1, bit for bit."""
    long, short = abut.solve(pulled(end)), abut.solve(pulled(1.0))
    factors = [1 / 3, 2 / 3, 1.0, 5 / 6, 4 / 6, 4 / 6]
    for step, other, factor in zip(long.steps, short.steps, factors, strict=True):
        tops = step.displacement[MESH.nodes_of("bar.top"), 2]
        assert tops == pytest.approx(factor * PULL * LONG / YOUNG, rel=GIVES)
        assert np.abs(step.displacement - other.displacement).max() <= 1e-15
        assert step.factor == pytest.approx(other.factor, abs=1e-15)


def test_a_model_made_of_another_keeps_its_times() -> None:
    model = pulled(END)
    assert replace(model, probes=[]).loads[0].amplitude == model.loads[0].amplitude
    assert model.solve.ends == pytest.approx(np.arange(1, 7) / 6)


PAIR = make.join({name: make.box([0, 1], [0, 1], z, cells=[1, 1, 1]) for name, z in (("low", [0, 1]), ("up", [1, 2]))})


def pressed(friction_amplitude: abut.Amplitude) -> Callable[..., abut.Model]:
    steel = abut.LinearElastic(YOUNG, 0.0)
    contact = abut.Contact("up.bottom", "low.top", friction=0.2, friction_amplitude=friction_amplitude)
    fixed = [abut.Support("low.bottom", x=0, y=0, z=0), abut.Support("up.top", x=0, y=0, z=-0.01)]
    return lambda **solve: abut.Model(
        PAIR, [abut.Solid("low", steel), abut.Solid("up", steel)], fixed, contacts=[contact], **solve
    )


HALF = abut.Amplitude(((0.0, 1.0), (0.5, 1.0), (1.0, 0.5)))
TWICE = abut.Amplitude(((0.0, 1.0), (0.5 * END, 1.0), (END, 0.5)))
# What has a time of its own: the list that it is in, made with times in parts of the end.
TIMED: Mapping[str, tuple[str, Callable[[float], Any]]] = {
    "lock": (
        "preloads",
        lambda t: abut.Preload("bolt", "bar", force=1.0, lock=0.5 * t, point=(0, 0, 5), normal=(0, 0, 1)),
    ),
    "hold": ("holds", lambda t: abut.Hold("bar.top", z=0.1, since=0.1 * t, reached=0.2 * t, until=0.5 * t, released=t)),
    "removal": ("removals", lambda t: abut.Removal("bar", until=0.2 * t, released=0.4 * t, since=0.5 * t)),
    "frequencies": ("modes", lambda t: abut.Frequencies(1, time=0.5 * t)),
    "turns of a coupling": (
        "couplings",
        lambda t: abut.Coupling(
            "head",
            "bar.top",
            reference=(0.5, 0.5, LONG),
            rz=0.1,
            amplitudes={"rz": abut.Amplitude(((0.0, 0.0), (t, 1.0)))},
        ),
    ),
}


def _plain(record: Any) -> dict[str, Any]:
    return {each.name: getattr(record, each.name) for each in fields(record)}


@pytest.mark.parametrize(("times", "end"), [((0.5, 1.5), 1.0), ((0.5, 2.5), 2.0), ((1e-4, 2e-3), 1e-3)])
def test_load_steps_after_the_end(times: tuple[float, ...], end: float) -> None:
    with pytest.raises(abut.InputError, match=f"solve: times: expected a time from 0 to {end:g}, the end of the run"):
        bar(solve=abut.SolveOptions(times=times, end=end))


@pytest.mark.parametrize("what", TIMED)
def test_every_time_is_one_of_the_run(what: str) -> None:
    """In a model of 60 it is what it is in one of 1."""
    name, record = TIMED[what]
    made = [
        _plain(getattr(bar(**{name: [record(end)], "solve": abut.SolveOptions(end=end)}), name)[0])
        for end in (1.0, END)
    ]
    assert made[0] == made[1]


def test_friction_over_time() -> None:
    one, other = pressed(HALF)(), pressed(TWICE)(solve=abut.SolveOptions(end=END))
    assert one.contacts[0].friction_amplitude == other.contacts[0].friction_amplitude


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (
            {"loads": [abut.Force("bar.top", (0, 0, 1.0), amplitude=abut.Amplitude(((0, 0), (7, 1))))]},
            r"loads\[0\]: amplitude: expected a time from 0 to 5, the end of the run, got 7",
        ),
        ({"holds": [abut.Hold("bar.top", z=0.1, until=5.0)]}, r"holds\[0\]: until: expected a time before 5"),
        ({"holds": [abut.Hold("bar.top", z=0.1, reached=6.0)]}, r"holds\[0\]: reached: expected a time from 0 to 5"),
        ({"modes": [abut.Frequencies(1, time=5.5)]}, r"modes\[0\]: time: expected a time from 0 to 5"),
    ],
)
def test_times_after_the_end(given: dict[str, Any], words: str) -> None:
    with pytest.raises(abut.InputError, match=words):
        bar(solve=abut.SolveOptions(end=5.0), **given)


def test_left_out_the_time_of_modes_is_the_end() -> None:
    assert bar(modes=[abut.Frequencies(1)], solve=abut.SolveOptions(end=5.0)).modes[0].share == 1.0


def test_loads_of_a_transient_have_the_time_of_that() -> None:
    late = abut.Force("bar.top", (0, 0, 1.0), amplitude=abut.Amplitude(((0.0, 0.0), (2.0, 1.0))))
    with pytest.raises(abut.InputError, match="shares of the period"):
        abut.Transient(4.0, [late])


def flung(end: float) -> abut.Model:
    """A metal bar pulled beyond its limit load, which no load step reaches."""
    metal = abut.Plastic(YOUNG, 0.3, 1.0)
    return abut.Model(
        MESH, solids=[abut.Solid("bar", metal)], supports=[BELOW],
        loads=[abut.Force("bar.top", (0.0, 0.0, 4.0))], solve=abut.SolveOptions(steps=4, end=end, max_iterations=10),
    )  # fmt: skip


def test_messages_say_times() -> None:
    """What a run of one model says, to an end of 1 and to another, is the same but for its times, which are so many times
    later."""
    short, long = abut.solve(flung(1.0)), abut.solve(flung(END))
    assert [step.time for step in long.steps] == pytest.approx([END * step.factor for step in short.steps])
    assert f"at time {long.steps[0].time:.6g}:" in repr(long.steps[0])
    said = [
        [float(at) for at in re.findall(r"(?:time|near|to) ([0-9.]+)", " ".join(each.notes))] for each in (short, long)
    ]
    assert len(said[0]) > 8
    assert max(said[0]) <= 1.0
    assert said[1] == pytest.approx([END * time for time in said[0]], rel=1e-4)
