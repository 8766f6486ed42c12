"""Contact that once stopped on the way: a wheel in its backlash, rollers in races, and slip that begins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from abut.benchmarks.finite_gears import BASE, CENTRES, TEETH, gear, placed
from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import disc, join, rectangle, ring
from abut.model import Amplitude, Contact, Coupling, Force, Model, Moment, Pressure, Solid, Support
from abut.solution import Solution

PLASTIC, STEEL = LinearElastic(3000.0, 0.35), LinearElastic(210e3, 0.3)
TORQUE = 200.0
LOAD = 3000.0  # on the inner race
YOUNG, LENGTH, HEIGHT, PRESSURE, FRICTION = 1e5, 20.0, 0.5, 10.0, 0.3  # of the bar
FULL = FRICTION * PRESSURE * LENGTH  # force under which all of the bar slips
REACH = FULL * LENGTH / (2.0 * YOUNG * HEIGHT)  # displacement of its end then
PRESSED = 0.3  # time from which on it is drawn
FIT, FIT_FRICTION = 0.01, 0.15  # interference of shaft and hub on the radius, and their coefficient
SHAFT, HUB, LONG, INSIDE = 10.0, 20.0, 40.0, 38.0  # radii, length of the shaft, and of the hub


def driven(torque: float = TORQUE, friction: float = 0.0, play: float = 0.025) -> Model:
    """A pinion on its axle, which a torque turns, and a wheel whose hub is held: both flanks of all teeth may touch, and a
    tooth of the pinion is in the middle of a gap. Lengths in mm, moduli in N/mm^2."""
    pinion, wheel = (gear(teeth, 0, both=True, play=play, cell="quad4") for teeth in TEETH)
    wheel = placed(wheel, np.pi + np.pi / TEETH[1], CENTRES)
    return Model(
        join({"pinion": pinion, "wheel": wheel}), [Solid("pinion", PLASTIC), Solid("wheel", PLASTIC)],
        [Support("wheel.hub", x=0, y=0)], [Moment("axle", (torque,))],
        [Contact("pinion.flanks", "wheel.flanks", friction=friction)],
        couplings=[Coupling("axle", "pinion.hub", "kinematic", reference=(0.0, 0.0), x=0.0, y=0.0)],
        plane="strain", kinematics="finite",
    )  # fmt: skip


def _meshed(solution: Solution) -> Mapping[str, float]:
    resultant = solution.contacts[0].resultant
    moment = -float(resultant.moment[0])
    return {"torque": moment / TORQUE, "arm of the force": moment / float(np.linalg.norm(resultant.force)) / BASE[0]}


def races(
    cell: str, cells: int, around: int, angles: Sequence[float] = (-135.0, -45.0), friction: float = 0.0,
    loads: Sequence[Any] = (),
) -> Model:  # fmt: skip
    """Rollers of radius 1 between half rings with races of radii 2 and 4, turned by 0.13; the inner ring pressed down."""
    parts = {
        "outer": ring((4.0, 5.0), (-180, 0), cells=(2, around), cell=cell),
        "inner": ring((1.0, 2.0), (-180, 0), cells=(2, around), cell=cell),
    }
    for i, angle in enumerate(np.deg2rad(angles)):
        roller, by = disc(1.0, cells=cells, cell=cell), angle + 0.13
        turn = np.array([[np.cos(by), np.sin(by)], [-np.sin(by), np.cos(by)]])
        parts[f"r{i}"] = replace(roller, points=roller.points @ turn + 3.0 * np.array([np.cos(angle), np.sin(angle)]))
    mesh = join(parts)
    contacts = [
        Contact(f"r{i}.round", race, name=f"r{i} {race}", friction=friction)
        for i in range(len(angles))
        for race in ("outer.inner", "inner.outer")
    ]
    return Model(
        mesh, [Solid(body, STEEL) for body in mesh.bodies],
        [Support("outer.outer", x=0, y=0), Support("inner.inner", x=0)],
        [Force("inner.inner", (0.0, -LOAD)), *loads], contacts, plane="strain",
    )  # fmt: skip


def _shared(solution: Solution) -> Mapping[str, float]:
    """Forces on the rollers over what statics say, and how far they are from that over what facets leave of motions."""
    forces = np.array([np.linalg.norm(contact.force) * np.sqrt(2.0) / LOAD for contact in solution.contacts])
    return {
        "mean force on a roller": float(forces.mean()),
        "deviation over what holds the rollers": float(np.abs(forces - 1.0).max() / solution.steps[-1].neutral),
    }


def _races(cell: str, cells: int, around: int) -> Benchmark:
    return Benchmark(
        f"rollers-in-races-{cell}",
        f"two rollers without friction between races of {cell}, which facets alone keep from spinning and rolling away",
        lambda level: races(cell, cells, around),
        _shared,
        {
            "mean force on a roller": Reference(
                1.0, 0.02, "statics: two rollers at 45 degrees carry F / sqrt(2) each",
                "rollers lean by 1 to 2 % as they give way",
            ),
            "deviation over what holds the rollers": Reference(
                0.0, 1.0, "theory (V14): what is held of spin and orbit is no more than what facets leave",
                "which is told as the step's share of forces that nothing but facets resists",
            ),
        },
    )  # fmt: skip


def bar(kinematics: str, pull: float) -> Model:
    """A flat bar, pressed on a stiff block, then drawn along it by its end."""
    parts = {
        "bar": rectangle([0, LENGTH], [0, HEIGHT], cells=[24, 1]),
        "block": rectangle([-1, LENGTH + 4], [-2, 0], cells=[29, 1]),
    }
    pressed = Amplitude(((0, 0), (PRESSED, 1), (1, 1)))
    drawn = Amplitude(((0, 0), (PRESSED, 0), (1, 1)))
    return Model(
        join(parts), [Solid("bar", LinearElastic(YOUNG, 0)), Solid("block", LinearElastic(100 * YOUNG, 0))],
        [Support("block.bottom", x=0, y=0), Support("bar.right", x=pull, amplitude=drawn)],
        [Pressure("bar.top", PRESSURE, amplitude=pressed)],
        [Contact("bar.bottom", "block.top", friction=FRICTION)], plane="stress", kinematics=kinematics,
    )  # fmt: skip


def _curve(solution: Solution, times: float) -> Mapping[str, float]:
    """Of a bar drawn so many times as far as where all of it slips."""
    time, force = np.array([[step.factor, abs(step.contacts[0].force[0])] for step in solution.steps]).T
    drawn = times * np.clip((time - PRESSED) / (1.0 - PRESSED), 0.0, 1.0)
    exact = np.minimum(np.sqrt(drawn), 1.0) * FULL
    return {
        "force over displacement": float(np.abs(force - exact).max() / FULL),
        "points before all slips": float(((drawn > 0.0) & (force < 0.99 * FULL)).sum()),
    }


def _bar(times: float) -> Benchmark:
    return Benchmark(
        f"bar-drawn-{times:g}",
        f"a bar drawn along a block by {times:g} times what makes all of it slip, in steps that abut finds",
        lambda level: bar("small", times * REACH),
        lambda solution: _curve(solution, times),
        {
            "force over displacement": Reference(
                0.0, 0.015, "F = sqrt(2 E A q u), the pull-out of fibres: Hutchinson and Jensen 1990",
                "the block gives way by a hundredth of what the bar does, and cells are 1 / 24 of its length",
            ),
            "points before all slips": Reference(
                10.0, 0.3, "theory (R21): eight points or more", "7 to 13; how many tells nothing more"
            ),
        },
    )  # fmt: skip


def pulled(kinematics: str, pull: float = 0.1) -> Model:
    """A hub pressed on a shaft, which is drawn out of it by its end in one ramp; axisymmetric."""
    parts = {
        "shaft": rectangle([0, SHAFT], [0, LONG], cells=[3, 16]),
        "hub": rectangle([SHAFT, HUB], [LONG - INSIDE, LONG], cells=[3, 15]),
    }
    return Model(
        join(parts), [Solid(body, LinearElastic(2e5, 0.3)) for body in parts],
        [Support("shaft.left", x=0), Support("hub.top", y=0), Support("shaft.bottom", y=-pull)],
        contacts=[Contact("shaft.right", "hub.left", friction=FIT_FRICTION, offset=-FIT)],
        plane="axisymmetric", kinematics=kinematics,
    )  # fmt: skip


def _out(solution: Solution) -> Mapping[str, float]:
    force = np.array([step.contacts[0].force[1] for step in solution.steps])
    full = FIT_FRICTION * solution.contacts[0].force_by_area
    return {
        "force at the end": float(force[-1] / full),
        "falls on the way": float(max(0.0, -np.diff(force).min()) / full),
    }


BENCHMARKS = (
    Benchmark(
        "wheel-backlash", "a wheel with backlash that a torque turns into another, held by contact alone",
        lambda level: driven(), _meshed,
        {
            "torque": Reference(1.0, 1e-6, "statics: balance of moments about the axle", "Newton's tolerance"),
            "arm of the force": Reference(
                1.0, 0.02, "the common normal of involutes is tangent to both base circles", "teeth bend and facets turn"
            ),
        },
    ),
    _races("quad4", 6, 53),
    _races("quad8", 4, 37),
    _bar(2.0),
    _bar(200.0),
    Benchmark(
        "press-fit-pulled", "a press fit pulled out in one ramp, in steps that abut finds",
        lambda level: pulled("small"), _out,
        {
            "force at the end": Reference(1.0, 1e-6, "Coulomb: all of it slips", "Newton's tolerance"),
            "falls on the way": Reference(
                0.0, 2e-3, "what slips carries its limit: the force only rises", "pressures change by Poisson's ratio"
            ),
        },
    ),
)  # fmt: skip
