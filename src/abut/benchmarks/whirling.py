"""Vibrations seen from what turns: a disc, as good as rigid, on springs."""

from __future__ import annotations

import numpy as np

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import box, join
from abut.model import Centrifugal, Frequencies, Model, Solid, Spring
from abut.solution import Solution

SIDE, THICK, DENSITY, YOUNG = 2.0, 0.5, 1.0, 1e7
SPEED, ACROSS, ALONG = 3.0, 50.0, 200.0  # of rotation; stiffness of all springs across the axis, and along it
MASS = DENSITY * SIDE**2 * THICK
POLAR = MASS * SIDE**2 / 6.0
DIAMETRAL = MASS * (SIDE**2 + THICK**2) / 12.0


def _disc(level: int) -> Model:
    """A square one about z; each of its four narrow sides on springs across its thickness and length."""
    n, half = 2**level, 0.5 * SIDE
    mesh = join({"disc": box((-half, half), (-half, half), (-0.5 * THICK, 0.5 * THICK), (2 * n, 2 * n, n), "hex20")})
    sides = ("left", "right", "front", "back")
    return Model(
        mesh,
        [Solid("disc", LinearElastic(YOUNG, 0.0, DENSITY))],
        springs=[Spring(side, f"disc.{side}", x=ACROSS / 4.0, y=ACROSS / 4.0, z=ALONG / 4.0) for side in sides],
        loads=[Centrifugal(SPEED, axis=(0.0, 0.0, 1.0))],
        modes=[Frequencies(6, coriolis=True)],
    )


def _found(solution: Solution) -> dict[str, float]:
    """Angular frequencies, of each the one nearest to what it should be."""
    omega = 2.0 * np.pi * solution.modes[0].values
    return {name: float(omega[int(np.argmin(np.abs(omega - near)))]) for name, near in SEEN.items()}


# In space a tilt goes round with w, D w^2 - P S w - k = 0 (P, D: polar and diametral moments, k: by the springs' distances),
# a shift with the root of k / m; seen from the disc forward ones are slower by its speed, backward ones faster
TILT = ALONG * (SIDE**2 / 8.0 + SIDE**2 / 24.0) + ACROSS * THICK**2 / 12.0
_ROOTS = np.roots([DIAMETRAL, -POLAR * SPEED, -TILT])
SEEN = {
    "shift forward": float(np.sqrt(ACROSS / MASS)) - SPEED,
    "shift backward": float(np.sqrt(ACROSS / MASS)) + SPEED,
    "tilt forward": float(_ROOTS.max()) - SPEED,
    "tilt backward": float(-_ROOTS.min()) + SPEED,
    "along the axis": float(np.sqrt(ALONG / MASS)),
}
BENCHMARKS = (
    Benchmark(
        "whirling-disc", "rigid disc on springs that turns: vibrations with and against the rotation", _disc, _found,
        {
            name: Reference(
                value, 5e-5, "Euler's equations of a turning rigid body, seen from it",
                "what the disc gives way, 1.7e-5 of its springs along the axis",
            )
            for name, value in SEEN.items()
        },
    ),
)  # fmt: skip
