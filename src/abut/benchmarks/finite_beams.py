"""Slender beams that turn far: rolled into a circle, and bent by a force that keeps its direction (elastica)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import join, rectangle
from abut.model import Force, Model, Rigid, Solid, SolveOptions, Support
from abut.solution import Solution

YOUNG, LENGTH, HEIGHT = 1.2e4, 10.0, 0.1
STIFFNESS = YOUNG * HEIGHT**3 / 12.0  # per unit thickness
PUSH = 10.0  # force times length squared over the stiffness


def _rolled() -> Benchmark:
    def model(level: int) -> Model:
        n = 40 * 2**level
        mesh = join({"beam": rectangle((0.0, LENGTH + LENGTH / n), (-HEIGHT / 2, HEIGHT / 2), (n + 1, 1), "quad8")})
        middle = mesh.points[mesh.blocks[0].nodes].mean(axis=1)[:, 0]
        cells = {"beam": np.flatnonzero(middle < LENGTH), "grip": np.flatnonzero(middle > LENGTH)}
        return Model(
            replace(mesh, bodies=cells),
            [Solid("beam", LinearElastic(YOUNG, 0.0))],
            [Support("beam.left", x=0.0, y=0.0)],
            rigid=[Rigid("grip", reference=(LENGTH, 0.0), rz=2.0 * np.pi)],
            plane="stress",
            kinematics="finite",
            solve=SolveOptions(steps=8),
        )

    def measure(solution: Solution) -> dict[str, float]:
        grip = solution.steps[-1].rigid["grip"]
        moment, back = float(grip.moment[0]), float(grip.displacement[0])
        return {"moment": moment * LENGTH / STIFFNESS / (2.0 * np.pi), "way back": -back / LENGTH}

    source = "beam theory: a uniform moment M bends to the curvature M / (E I), 2 pi / L for a whole circle"
    reason = "beam theory leaves out terms of the size of (thickness times curvature)^2 = 4e-3, and cells are quadratic"
    return Benchmark(
        "finite-circle",
        "beam rolled into a whole circle by turning its end, which is free to move",
        model,
        measure,
        {"moment": Reference(1.0, 5e-3, source, reason), "way back": Reference(1.0, 1e-3, source, reason)},
    )


def elastica(push: float) -> tuple[float, float]:
    """Deflection across and along, over the length, of a cantilever's tip under a dead force across, by elliptic integrals
    (Bisshopp and Drucker 1945). push: force times length squared over bending stiffness."""

    def parameters(slope: float) -> tuple[float, float]:
        m = 0.5 * (1.0 + np.sin(slope))
        return m, float(np.arcsin(np.sqrt(0.5 / m)))

    def miss(slope: float) -> float:
        m, begin = parameters(slope)
        return float(ellipk(m) - ellipkinc(begin, m) - np.sqrt(push))

    slope = brentq(miss, 1e-9, 0.5 * np.pi - 1e-12)
    m, begin = parameters(slope)
    across = 1.0 - 2.0 / np.sqrt(push) * float(ellipe(m) - ellipeinc(begin, m))
    return across, 1.0 - float(np.sqrt(2.0 * np.sin(slope) / push))


def _elastica() -> Benchmark:
    def model(level: int) -> Model:
        n = 40 * 2**level
        return Model(
            join({"beam": rectangle((0.0, LENGTH), (-HEIGHT / 2, HEIGHT / 2), (n, 1), "quad8")}),
            [Solid("beam", LinearElastic(YOUNG, 0.0))],
            [Support("beam.left", x=0.0, y=0.0)],
            [Force("beam.right", (0.0, PUSH * STIFFNESS / LENGTH**2))],
            plane="stress",
            kinematics="finite",
            solve=SolveOptions(steps=5),
        )

    def measure(solution: Solution) -> dict[str, float]:
        tip = np.flatnonzero(np.isclose(solution.model.mesh.points, (LENGTH, 0.0)).all(axis=1))[0]
        along, across = solution.displacement[tip]
        return {"across": float(across) / LENGTH, "along": -float(along) / LENGTH}

    across, along = elastica(PUSH)
    source = f"elastica: cantilever with a force of {PUSH:g} E I / L^2 at its end (Bisshopp and Drucker 1945)"
    reason = "shear and stretch of a beam 100 times as long as thick, and quadratic cells"
    return Benchmark(
        "finite-elastica",
        "cantilever bent by a dead force to four fifths of its length",
        model,
        measure,
        {"across": Reference(across, 1e-3, source, reason), "along": Reference(along, 1e-3, source, reason)},
    )


BENCHMARKS = (_rolled(), _elastica())
