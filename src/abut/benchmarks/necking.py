"""A round bar drawn until it necks: where the load is largest by Considere, and how far it has necked beside CalculiX."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.plastic import Plastic
from abut.mesh.make import join, rectangle
from abut.model import Model, Solid, SolveOptions, Support
from abut.solution import Solution

RADIUS, LENGTH, DRAWN = 6.413, 53.334, 14.0  # Simo (1988): the bar, and by how much it is drawn
STEEL = Plastic(206.9e3, 0.29, 450.0, hardening=129.24, saturation=265.0, rate=16.93)
THINNER = 0.018  # share of the radius that the middle lacks, so that the neck knows its place


def considere() -> float:
    """The largest load of a uniform bar.

    The stress times the volume ratio, t = Y(x), times the first area over the stretch exp(x + t / E), x the equivalent
    plastic strain; largest where Y' = Y (1 + Y' / E).
    """

    def stress(x: float) -> float:
        return float(STEEL.table[0][1] + STEEL.hardening * x + STEEL.saturation * (1.0 - np.exp(-STEEL.rate * x)))

    def slope(x: float) -> float:
        return float(STEEL.hardening + STEEL.saturation * STEEL.rate * np.exp(-STEEL.rate * x))

    x = brentq(lambda x: slope(x) - stress(x) * (1.0 + slope(x) / STEEL.young), 1e-3, 1.0, xtol=1e-12)
    return float(stress(x) * np.pi * RADIUS**2 * np.exp(-x - stress(x) / STEEL.young))


def bar(thinner: float, cells: tuple[int, int], drawn: float, steps: int) -> Model:
    """Half a bar by its plane of symmetry, axisymmetric, drawn by ``drawn`` as a whole; ``thinner`` there by a share."""
    mesh = join({"bar": rectangle((0.0, RADIUS), (0.0, LENGTH / 2.0), cells, "quad8")})
    r, z = mesh.points.T
    points = np.column_stack([r * (1.0 - thinner * (1.0 - 2.0 * z / LENGTH)), z])
    return Model(
        replace(mesh, points=points),
        [Solid("bar", STEEL, integration="reduced")],
        [Support("bar.bottom", y=0), Support("bar.top", y=drawn / 2.0)],
        plane="axisymmetric",
        kinematics="finite",
        solve=SolveOptions(steps=steps),
    )


def _loads(solution: Solution) -> list[float]:
    return [float(step.reactions["bar.top"][1]) for step in solution.steps]


def _necked(solution: Solution) -> dict[str, float]:
    points = solution.model.mesh.points + solution.displacement
    loads, left = _loads(solution), points[solution.model.mesh.nodes_of("bar.bottom"), 0].max()
    return {"largest load": max(loads) / considere(), "load at the end": loads[-1], "radius of the neck": float(left)}


WITHOUT = "CalculiX as above, over 1.0018, by which its uniform bar carries more"
CALCULIX = "CalculiX 2.20, CAX8R, the same mesh and as many steps"
HOW_FAR = "flow in finite steps: CalculiX itself differs by 3 % between 34 steps and 100"
BENCHMARKS = (
    Benchmark(
        "considere",
        "uniform bar drawn beyond its largest load (Voce's hardening)",
        lambda level: bar(0.0, (1, 2), 16.0, 80 * 2**level),
        lambda solution: {"largest load": max(_loads(solution))},
        {
            "largest load": Reference(
                considere(), 2e-4, "Considere: hardening equals stress; logarithmic strains", "between two load steps"
            )
        },
    ),
    Benchmark(
        "necking",
        "the same bar, 1.8 % thinner in the middle, drawn by a quarter of its length until it necks",
        lambda level: bar(THINNER, (5 * 2**level, 15 * 2**level), DRAWN, 100),
        _necked,
        {
            "largest load": Reference(0.97214, 1e-3, f"{CALCULIX}, over that of a uniform bar", "as many steps"),
            "load at the end": Reference(31685.0, 0.02, WITHOUT, HOW_FAR),
            "radius of the neck": Reference(2.5050, 0.03, CALCULIX, HOW_FAR),
        },
    ),
)
