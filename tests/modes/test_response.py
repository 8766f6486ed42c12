"""Vibrations under loads that change quickly, against closed forms of oscillators, bars and beams."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.mesh import make

MASS, STIFF = (
    4.0,
    100.0,
)  # of a block 2 wide, 1 high and 1 thick, density 2; of its springs along y, beside those along x
OMEGA = np.sqrt(STIFF / MASS)
NATURAL = OMEGA / (2.0 * np.pi)
FORCE = 3.0
RIGID = 1e-6  # the block's own modulus is 1e7 times that of the springs
PUSH = abut.Force("block.top", (0.0, FORCE))


def block(*wanted: Any, **others: Any) -> abut.Model:
    """On springs at both sides, as good as rigid."""
    mesh = make.join({"block": make.rectangle([0, 2], [0, 1], cells=[4, 2])})
    springs = [abut.Spring(side, f"block.{side}", x=4.0 * STIFF, y=STIFF / 2.0) for side in ("left", "right")]
    return abut.Model(
        mesh,
        plane="stress",
        solids=[abut.Solid("block", abut.LinearElastic(1e9, 0.0, density=MASS / 2.0))],
        springs=springs,
        probes=[abut.Probe("middle", at=(1.0, 0.5), of=("displacement",))],
        modes=[abut.Frequencies(3, stiffening=False), *wanted],
        **others,
    )


def motion(model: abut.Model, number: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Of the middle: frequencies or times, and displacements along y."""
    result = abut.solve(model).responses[number]
    return result.at, result.probes[0].displacement[:, 0, 1]


@pytest.mark.parametrize("damping", [{"damping": 0.1}, {"damping": (0.1,)}, {"rayleigh": (0.2 * OMEGA, 0.0)},
                                     {"rayleigh": (0.0, 0.2 / OMEGA)}])  # fmt: skip
def test_an_oscillator_is_amplified_and_lags_as_theory_says(damping: dict[str, Any]) -> None:
    """1 / (1 - r^2 + 2 i zeta r); of the only mode that moves along y, the first one."""
    wide = (0.0, 1.9 * NATURAL)  # below the next mode, along x, which has no damping in one case
    at, moved = motion(block(abut.Harmonic(wide, [PUSH], **damping)))
    r = at / NATURAL
    assert r.min() == 0.0
    assert np.abs(r - 1.0).min() < RIGID
    np.testing.assert_allclose(moved, FORCE / STIFF / (1.0 - r**2 + 0.2j * r), rtol=1e-5)
    assert np.angle(moved[np.abs(r - 1.0).argmin()], deg=True) == pytest.approx(-90.0, abs=1e-3)


def test_loads_a_quarter_ahead_put_all_motion_ahead() -> None:
    band = (0.5 * NATURAL, 1.5 * NATURAL)
    _, first = motion(block(abut.Harmonic(band, [PUSH], damping=0.05)))
    _, ahead = motion(block(abut.Harmonic(band, imaginary=[PUSH], damping=0.05)))
    np.testing.assert_allclose(ahead, 1j * first, rtol=1e-12)


def test_a_base_that_shakes_is_transmitted() -> None:
    """(1 + 2 i zeta r) / (1 - r^2 + 2 i zeta r) of its displacement: springs and dashpots between base and mass."""
    at, moved = motion(block(abut.Harmonic((0.1 * NATURAL, 3.0 * NATURAL), base=(0.0, 2.0), damping=0.1)))
    r = at / NATURAL
    np.testing.assert_allclose(moved, 2.0 * (1.0 + 0.2j * r) / (1.0 - r**2 + 0.2j * r), rtol=1e-5)


def test_damping_by_mass_resists_motion_in_space() -> None:
    """1 / (1 - r^2 + 2 i zeta r): only the spring is tied to the base."""
    shaken = abut.Harmonic((0.1 * NATURAL, 3.0 * NATURAL), base=(0.0, 2.0), rayleigh=(0.2 * OMEGA, 0.0))
    at, moved = motion(block(shaken))
    r = at / NATURAL
    np.testing.assert_allclose(moved, 2.0 / (1.0 - r**2 + 0.2j * r), rtol=1e-5)


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.3])
def test_a_sudden_load_overshoots_by_what_damping_leaves(zeta: float) -> None:
    """1 - exp(-zeta omega t) (cos omega_d t + zeta omega / omega_d sin omega_d t) at every time, twice the static value
    without damping."""
    period = 2.0 / NATURAL
    at, moved = motion(block(abut.Transient(period, [PUSH], steps=64, damping=zeta)))
    damped = OMEGA * np.sqrt(1.0 - zeta**2)
    wave = np.cos(damped * at) + zeta * OMEGA / damped * np.sin(damped * at)
    np.testing.assert_allclose(
        moved, FORCE / STIFF * (1.0 - np.exp(-zeta * OMEGA * at) * wave), atol=1e-5 * FORCE / STIFF
    )
    if not zeta:
        assert moved.max() == pytest.approx(2.0 * FORCE / STIFF, rel=1e-5)


def test_a_ramp_is_followed_exactly_however_few_the_steps() -> None:
    """t / T - sin(omega t) / (omega T) up to T, where the load stays: then as the difference of two ramps."""
    period, rise = 3.0 / NATURAL, 0.37  # a corner between steps
    ramp = abut.Amplitude(((0.0, 0.0), (rise, 1.0)))
    at, moved = motion(block(abut.Transient(period, [replace(PUSH, amplitude=ramp)], steps=7)))

    def ramped(time: np.ndarray) -> np.ndarray:
        later = np.maximum(time, 0.0)
        return (later - np.sin(OMEGA * later) / OMEGA) / (rise * period)

    np.testing.assert_allclose(
        moved, FORCE / STIFF * (ramped(at) - ramped(at - rise * period)), atol=1e-5 * FORCE / STIFF
    )


def test_a_body_that_nothing_holds_flies_off() -> None:
    """F t^2 / (2 m), and F / (-m omega^2) under a cosine."""
    free = replace(
        block(abut.Transient(0.5, [PUSH], steps=5), abut.Harmonic((1.0, 2.0), [PUSH])),
        springs=(),
        solve=abut.SolveOptions(),
    )
    solution = abut.solve(replace(free, supports=[abut.Support("block.left", x=0.0)]))
    fly, shaken = (result.probes[0].displacement[:, 0, 1] for result in solution.responses)
    at = solution.responses[0].at
    np.testing.assert_allclose(fly, FORCE / MASS * at**2 / 2.0, rtol=1e-5, atol=1e-12)
    angular = 2.0 * np.pi * solution.responses[1].at
    np.testing.assert_allclose(shaken, -FORCE / MASS / angular**2, rtol=1e-5)
    lines = [check for check in solution.certificate if "modes left out" in check.name]
    assert [bool(line.unknown) for line in lines] == [True, True]


def test_loads_on_what_is_free_and_has_no_mass_are_refused() -> None:
    blocks = {
        "held": make.rectangle([0, 1], [0, 1], cells=[2, 2]),
        "loose": make.rectangle([2, 3], [0, 1], cells=[2, 2]),
    }
    model = abut.Model(
        make.join(blocks),
        plane="stress",
        solids=[abut.Solid("held", abut.LinearElastic(1e3, 0.0, density=1.0))],
        rigid=[abut.Rigid("loose")],
        supports=[abut.Support("held.left", x=0, y=0)],
        modes=[abut.Frequencies(3), abut.Transient(1.0, [abut.Force("loose", (0.0, 1.0))])],
    )
    with pytest.raises(InputError, match="without mass"):
        abut.solve(model)


LENGTH, HEIGHT, YOUNG, DENSITY = 100.0, 1.0, 210e3, 7.85e-9


def beam(*wanted: Any, count: int = 5) -> abut.Model:
    mesh = make.join({"beam": make.rectangle([0, LENGTH], [0, HEIGHT], [30, 1], "quad8")})
    return abut.Model(
        mesh,
        plane="stress",
        solids=[abut.Solid("beam", abut.LinearElastic(YOUNG, 0.0, density=DENSITY))],
        supports=[abut.Support("beam.left", x=0, y=0)],
        probes=[abut.Probe("tip", at=(LENGTH, HEIGHT / 2.0), of=("displacement",))],
        modes=[abut.Frequencies(count, stiffening=False), *wanted],
    )


def test_a_cantilever_answers_at_its_tip_as_euler_and_bernoulli_say() -> None:
    """(cosh sin - sinh cos)(k l) / (E I k^3 (1 + cosh cos)), with a modulus E (1 + i b omega) of damping by stiffness; up to
    beyond the third mode. A slenderness of 100 shifts frequencies by some (k h)^2, 8e-4 of the third mode, which counts
    twice over its share of damping, .05; a peak errs by 2 * 8e-4 / .1."""
    slow = 1e-5
    last = 3000.0
    at, moved = motion(beam(abut.Harmonic((0.0, last), [abut.Force("beam.right", (0.0, 1.0))], rayleigh=(0.0, slow))))
    at, moved = at[at > 0.0], moved[at > 0.0]
    angular = 2.0 * np.pi * at
    bending = YOUNG * HEIGHT**3 / 12.0 * (1.0 + 1j * slow * angular)
    k = (angular**2 * DENSITY * HEIGHT / bending) ** 0.25
    x = k * LENGTH
    tip = (np.cosh(x) * np.sin(x) - np.sinh(x) * np.cos(x)) / (bending * k**3 * (1.0 + np.cosh(x) * np.cos(x)))
    error = np.abs(moved - tip)
    assert error.max() < 0.05 * np.abs(tip).max()
    assert np.median(error / np.abs(tip)) < 1.6e-2


def test_few_modes_have_the_whole_static_answer() -> None:
    """One mode has 97.06 % of a tip's compliance (12 / 1.8751^4); what is added gives the rest, and the certificate tells
    what is missing once frequencies come near the next mode."""
    quiet = abut.Harmonic((0.0, 1.0), [abut.Force("beam.right", (0.0, 1.0))], points=2, bias=1.0)
    solution = abut.solve(beam(quiet, count=1))
    result = solution.responses[0]
    static = 4.0 * LENGTH**3 / (YOUNG * HEIGHT**3)
    assert abs(result.probes[0].displacement[0, 0, 1]) == pytest.approx(static, rel=1e-3)
    assert abs(result.coordinates[0, 0] * solution.modes[0].shapes[0].max()) == pytest.approx(0.9706 * static, rel=1e-3)
    assert result.left_out < 1e-4
    loud = replace(quiet, between=(0.0, 600.0), damping=0.05)  # the second mode is at 520
    lines = {check.name: check for check in abut.solve(beam(loud, count=1)).certificate}
    assert not lines["harmonic response: modes left out"].passed


def test_pressed_bars_vibrate_as_one() -> None:
    """u = F tan(k l) / (E A k) at the end of a bar, of two that a preload presses on each other."""
    parts = {"near": ((0.0, 40.0), 8), "far": ((40.0, LENGTH), 12)}
    mesh = make.join({name: make.rectangle(x, (0.0, HEIGHT), (n, 1), "quad8") for name, (x, n) in parts.items()})
    between = (100.0, 8000.0)  # the first frequency is 12930
    model = abut.Model(
        mesh,
        plane="stress",
        solids=[abut.Solid(name, abut.LinearElastic(YOUNG, 0.0, density=DENSITY)) for name in parts],
        supports=[
            abut.Support("near.left", x=0),
            *(abut.Support(f"{name}.{side}", y=0) for name in parts for side in ("bottom", "top")),
        ],
        loads=[abut.Force("far.right", (-10.0, 0.0))],
        contacts=[abut.Contact("near.right", "far.left", "joint")],
        probes=[abut.Probe("end", at=(LENGTH, HEIGHT / 2.0), of=("displacement",))],
        modes=[
            abut.Frequencies(4, stiffening=False),
            abut.Harmonic(between, [abut.Force("far.right", (1.0, 0.0))]),
        ],
    )
    result = abut.solve(model).responses[0]
    k = 2.0 * np.pi * result.at * np.sqrt(DENSITY / YOUNG)
    expected = np.tan(k * LENGTH) / (YOUNG * HEIGHT * k)
    np.testing.assert_allclose(result.probes[0].displacement[:, 0, 0], expected, rtol=1e-4)


def test_modes_are_those_of_the_time_that_is_asked_for() -> None:
    """At half of the load those of a model with half of it; tension makes a beam stiffer."""
    model = replace(beam(), loads=[abut.Traction("beam.right", (300.0, 0.0))])
    times = [abut.Frequencies(1, time=0.5), abut.Frequencies(1), abut.Frequencies(1, stiffening=False)]
    solution = abut.solve(replace(model, modes=times))
    half, whole, none = (result.eigenvalues[0] for result in solution.modes)
    assert [step.factor for step in solution.steps] == [0.5, 1.0]
    assert none < half < whole
    exact = abut.solve(replace(model, loads=[abut.Traction("beam.right", (150.0, 0.0))], modes=[abut.Frequencies(1)]))
    assert half == pytest.approx(exact.modes[0].eigenvalues[0], rel=1e-9)


@pytest.mark.parametrize(
    ("make_it", "said"),
    [
        (lambda: abut.Harmonic((2.0, 1.0), [PUSH]), "first <= last"),
        (lambda: abut.Harmonic((1.0, 2.0)), "nothing shakes"),
        (lambda: abut.Harmonic((1.0, 2.0), [PUSH], damping=-0.1), "would feed vibrations"),
        (lambda: abut.Harmonic((1.0, 2.0), [PUSH], fields=[3.0]), "from 1 to 2"),
        (lambda: abut.Harmonic((1.0, 2.0), [abut.Temperature("block", 1.0)]), "do not vibrate"),
        (
            lambda: abut.Harmonic((1.0, 2.0), [replace(PUSH, amplitude=abut.Amplitude(((0, 1),)))]),
            "leave the amplitude out",
        ),
        (lambda: abut.Transient(0.0, [PUSH]), "> 0"),
        (lambda: abut.Transient(1.0), "nothing moves anything"),
        (lambda: abut.Transient(1.0, [PUSH], steps=0), "whole number"),
        (lambda: abut.Buckling(1, time=0.0), "after the start"),
        (lambda: abut.Frequencies(1, time=-0.1), "from the start to the end"),
        (lambda: replace(block(), modes=[abut.Transient(1.0, [PUSH])]), "ask for frequencies"),
        (lambda: block(abut.Transient(1.0, [abut.Force("block.topp", (0.0, 1.0))])), "did you mean"),
        (lambda: abut.solve(block(abut.Harmonic((0.0, 2.0), [PUSH]))), "without damping"),
        (lambda: abut.solve(block(abut.Harmonic((0.0, 2.0), base=(1.0, 0.0, 0.0), damping=0.1))), "expected 2 numbers"),
    ],
)
def test_what_cannot_be_is_refused(make_it: Any, said: str) -> None:
    with pytest.raises(InputError, match=said):
        make_it()
