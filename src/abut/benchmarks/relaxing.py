"""Bodies that relax: a bar that creeps, and balls pressed into a half space (Lee and Radok)."""

from __future__ import annotations

import numpy as np
from scipy.integrate import quad

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.materials.viscoelastic import Viscoelastic
from abut.mesh.make import join, rectangle, ring
from abut.model import Amplitude, Contact, Force, Model, Rigid, Solid, SolveOptions, Support, Traction
from abut.solution import Solution

YOUNG, POISSON, SHARE, TAU = 10.0, 0.4, 0.6, 2.0
NOW = LinearElastic(YOUNG, POISSON)
BULK, SHEAR = YOUNG / (3.0 * (1.0 - 2.0 * POISSON)), YOUNG / (2.0 * (1.0 + POISSON))
END, SUDDEN = 6.0, 1e-3  # of the run, and of what is applied at once
AT_ONCE = Amplitude(((0.0, 0.0), (SUDDEN, 1.0)))
RADIUS, DEPTH = 100.0, 0.01  # of the ball, whose contact then has the radius 1


def _creep(level: int) -> Model:
    """A bar under a tension that stays; its shear alone relaxes."""
    steps = 20 * 2**level
    return Model(
        join({"bar": rectangle((0.0, 4.0), (0.0, 1.0), (4, 1), "quad8")}),
        [Solid("bar", Viscoelastic(NOW, [(SHARE, 0.0, TAU)]))],
        [Support("bar.left", x=0), Support("bar.bottom", y=0)],
        [Traction("bar.right", (0.1, 0.0), amplitude=AT_ONCE)],
        plane="stress",
        solve=SolveOptions(end=END, times=(SUDDEN, *np.linspace(SUDDEN, END, steps + 1)[1:])),
    )


def _stretched(solution: Solution) -> dict[str, float]:
    step = solution.steps[-1]
    return {"strain": float(step.displacement[:, 0].max()) / 4.0 / (0.1 / YOUNG)}


def _bar_strain() -> float:
    """Over the elastic one at once, in plane stress: creep of shear J(t), none of volume."""
    late = SHEAR * (1.0 - SHARE)
    creep = 1.0 / late - (1.0 / late - 1.0 / SHEAR) * np.exp(-(END - 0.5 * SUDDEN) * (1.0 - SHARE) / TAU)
    return float(YOUNG * (creep / 3.0 + 1.0 / (9.0 * BULK)))


def _ground(level: int, loads: tuple[Force, ...], rigid: Rigid, times: np.ndarray) -> Model:
    """A half space whose shear and bulk relax alike, under a rigid ball."""
    n = 12 * 2**level
    fine = {"x": [0.0, 1.2], "y": [-1.2, 0.0]}
    ground = rectangle((0.0, 300.0), (-300.0, 0.0), (n, n), "quad8", fine, 1.3)
    ball = ring((95.0, RADIUS), (-90.0, -90.0 + np.rad2deg(0.015)), (0.0, RADIUS), (1, 2 * n))
    return Model(
        join({"ground": ground, "ball": ball}),
        [Solid("ground", Viscoelastic(NOW, [(SHARE, SHARE, TAU)]), integration="reduced")],
        [Support("ground.bottom", y=0), Support("ground.left", x=0), Support("ground.right", x=0)],
        loads,
        contacts=[Contact("ground.top", "ball.outer")],
        rigid=[rigid],
        plane="axisymmetric",
        solve=SolveOptions(end=END, times=tuple(times)),
    )


HERTZ = 4.0 / 3.0 * YOUNG / (1.0 - POISSON**2) * np.sqrt(RADIUS)  # force over depth^(3/2)


def _pressed(level: int) -> Model:
    """At a constant speed."""
    course = Amplitude(((0.0, 0.0), (END, 1.0)))
    return _ground(level, (), Rigid("ball", y=-DEPTH, amplitude=course), np.linspace(0.0, END, 21 * 2**level)[1:])


def _force(solution: Solution) -> dict[str, float]:
    return {"force": abs(float(solution.contacts[0].force[1])) / (HERTZ * DEPTH**1.5)}


def _fading(after: float) -> float:
    return float(1.0 - SHARE * (1.0 - np.exp(-after / TAU)))


def _pressed_force() -> float:
    """Over the elastic one at the end."""
    return float(quad(lambda s: _fading(END * (1.0 - s)) * 1.5 * np.sqrt(s), 0.0, 1.0)[0])


HALF_SPACE = (
    "cells of a twelfth of the largest contact radius, a ground of 300 of them: 0.5 % as of elastic balls; 20 steps"
)
LEE = "Lee and Radok (1960): Hertz's force in the hereditary integral"
BENCHMARKS = (
    Benchmark(
        "relaxing-bar",
        "a bar that creeps under a tension, plane stress",
        _creep,
        _stretched,
        {
            "strain": Reference(
                _bar_strain(), 1e-3, "creep of shear beside an elastic volume, in closed form",
                "20 steps, over each of which stresses are taken to grow evenly",
            )
        },
    ),
    Benchmark(
        "relaxing-half-space",
        "a rigid ball pressed into a half space that relaxes, at a constant speed",
        _pressed,
        _force,
        {"force": Reference(_pressed_force(), 0.015, LEE, HALF_SPACE)},
    ),
)  # fmt: skip
