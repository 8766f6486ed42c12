"""Vibrations under loads: a mass on springs that a load meets suddenly, and pressed bars that a shaker moves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from abut.benchmarks.modes import HEIGHT, LENGTH, WAVE, YOUNG, pressed_bars
from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import join, rectangle
from abut.model import Force, Frequencies, Harmonic, Model, Probe, Solid, Spring, Transient
from abut.solution import Solution

MASS, STIFFNESS, FORCE, DAMPING = 4.0, 100.0, 3.0, 0.1
OMEGA = float(np.sqrt(STIFFNESS / MASS))
FIRST = WAVE / (4.0 * LENGTH)
SHAKEN = 0.5 * FIRST  # frequency
MODES = 4


def _mass(level: int) -> Model:
    """A block, as good as rigid, on springs at both sides; 64 steps a period, one of them at the peak to 1e-3."""
    springs = [Spring(side, f"block.{side}", x=4.0 * STIFFNESS, y=0.5 * STIFFNESS) for side in ("left", "right")]
    period = 4.0 * np.pi / OMEGA
    return Model(
        join({"block": rectangle((0.0, 2.0), (0.0, 1.0), (4, 2))}),
        [Solid("block", LinearElastic(1e9, 0.0, 0.5 * MASS))],
        plane="stress",
        springs=springs,
        probes=[Probe("middle", at=(1.0, 0.5), of=("displacement",))],
        modes=[
            Frequencies(2, stiffening=False),
            Transient(period, [Force("block.top", (0.0, FORCE))], steps=128 * 2**level, damping=DAMPING),
            Harmonic(
                (0.0, OMEGA / np.pi / 1.5), [Force("block.top", (0.0, FORCE))], damping=DAMPING,
                fields=(OMEGA / (2.0 * np.pi),),
            ),
        ],
    )  # fmt: skip


def _bars(level: int) -> Model:
    """The bars of `bars-ring`, whose end a unit force shakes at half of the first frequency."""
    return replace(
        pressed_bars(level),
        probes=[Probe("end", at=(LENGTH, 0.5 * HEIGHT), of=("displacement",))],
        modes=[
            Frequencies(MODES, stiffening=False),
            Harmonic((0.0, 0.9 * FIRST), [Force("far.right", (1.0, 0.0))], fields=(SHAKEN,)),
        ],
    )


def _overshoot(solution: Solution) -> dict[str, float]:
    over_time, steady = solution.responses
    at = int(np.argmin(np.abs(steady.at - OMEGA / (2.0 * np.pi))))
    moved = steady.probes[0].displacement[at, 0, 1]
    return {
        "largest displacement": float(over_time.probes[0].displacement[:, 0, 1].max()),
        "amplitude in resonance": float(np.abs(moved)),
        "phase in resonance": float(np.degrees(np.angle(moved))),
    }


def _amplitude(solution: Solution) -> dict[str, float]:
    result = solution.responses[0]
    return {"amplitude": float(np.abs(result.probes[0].displacement[np.searchsorted(result.at, SHAKEN), 0, 0]))}


STATIC = FORCE / STIFFNESS
K = 2.0 * np.pi * SHAKEN / WAVE
ALONG = float(np.tan(K * LENGTH) / (YOUNG * HEIGHT * K))
BENCHMARKS = (
    Benchmark(
        "sudden-load", "mass on springs: load that comes suddenly, and resonance", _mass, _overshoot,
        {
            "largest displacement": Reference(
                STATIC * (1.0 + float(np.exp(-np.pi * DAMPING / np.sqrt(1.0 - DAMPING**2)))), 1e-3,
                "1 + exp(-pi zeta / sqrt(1 - zeta^2)) of the static one",
                "the peak lies between two of 64 times a period: (pi / 64)^2 / 4",
            ),
            "amplitude in resonance": Reference(
                STATIC / (2.0 * DAMPING), 1e-5, "static one over 2 zeta", "the block is not quite rigid: 1e-7"
            ),
            "phase in resonance": Reference(
                -90.0, 1e-4, "a quarter of a period behind", "the block is not quite rigid: 1e-7, over zeta"
            ),
        },
    ),
    Benchmark(
        "bars-shake", "two bars pressed on each other, shaken at half of the first frequency", _bars, _amplitude,
        {
            "amplitude": Reference(
                ALONG, 6e-5, "bar held at one end: F tan(k l) / (E A k)",
                "motion of modes beyond the fourth: .5^2 8 / pi^2 sum 1 / (2 n - 1)^4, over 4 / pi",
            )
        },
    ),
)  # fmt: skip
