"""Natural frequencies and buckling loads: bars that press each other, and a strut."""

from __future__ import annotations

import numpy as np

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import join, rectangle
from abut.model import Buckling, Contact, Force, Frequencies, Model, Solid, Support
from abut.solution import Solution

YOUNG, DENSITY, LENGTH, HEIGHT = 210e3, 7.85e-9, 100.0, 2.0  # N, mm, t; a width of 1
PUSH = 10.0


def pressed_bars(level: int) -> Model:
    """Two bars in a row, pressed on each other by a force: closed contact vibrates as if they were one."""
    n = 2**level
    parts = {
        "near": rectangle((0.0, 0.4 * LENGTH), (0.0, HEIGHT), (8 * n, 1), "quad8"),
        "far": rectangle((0.4 * LENGTH, LENGTH), (0.0, HEIGHT), (12 * n, 2), "quad8"),
    }
    return Model(
        join(parts),
        [Solid(name, LinearElastic(YOUNG, 0.0, DENSITY)) for name in parts],
        [Support("near.left", x=0), *(Support(f"{name}.{side}", y=0) for name in parts for side in ("bottom", "top"))],
        [Force("far.right", (-PUSH, 0.0))],
        [Contact("near.right", "far.left", "joint")],
        plane="stress",
        modes=[Frequencies(3, stiffening=False)],
    )


def _strut(level: int) -> Model:
    """Clamped at one end, pushed at the other."""
    n = 2**level
    mesh = join({"strut": rectangle((0.0, LENGTH), (0.0, HEIGHT), (16 * n, 2 * n), "quad8")})
    return Model(
        mesh,
        [Solid("strut", LinearElastic(YOUNG, 0.0))],
        [Support("strut.left", x=0, y=0)],
        [Force("strut.right", (-PUSH, 0.0))],
        plane="stress",
        modes=[Buckling(1)],
    )


def _frequencies(solution: Solution) -> dict[str, float]:
    return {f"frequency {i + 1}": float(value) for i, value in enumerate(solution.modes[0].values)}


def _buckling(solution: Solution) -> dict[str, float]:
    return {"force": PUSH * float(solution.modes[0].values[0])}


WAVE = float(np.sqrt(YOUNG / DENSITY))
EULER = np.pi**2 * YOUNG * HEIGHT**3 / 12.0 / (4.0 * LENGTH**2)
SHEAR = 1.0 + 1.2 * EULER / (YOUNG / 2.0 * HEIGHT)  # nu = 0: G = E / 2
BENCHMARKS = (
    Benchmark(
        "bars-ring", "two bars pressed on each other: natural frequencies along them", pressed_bars, _frequencies,
        {
            f"frequency {i + 1}": Reference(
                (2 * i + 1) * WAVE / (4.0 * LENGTH), 2e-5, "bar held at one end: (2 n - 1) c / 4 L",
                "quadratic cells err by (k h)^4 / 1440, 1.65e-5 of the third",
            )
            for i in range(3)
        },
    ),
    Benchmark(
        "strut", "strut clamped at one end: buckling load", _strut, _buckling,
        {
            "force": Reference(
                EULER / SHEAR, 5e-4, "Euler, with Engesser's shear", "quadratic cells: h^4; shear counts 2e-4"
            )
        },
    ),
)  # fmt: skip
