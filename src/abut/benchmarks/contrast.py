"""Contrast of stiffness (1e4) and of mesh size across an interface: the patch test stays exact, Hertz's pressure smooth.

Left out is what no choice of pressure can mend: a contactor both much stiffer and much finer than its target touches the
facets of the target one by one, and its pressure shows that.
"""

from __future__ import annotations

import numpy as np

from abut.benchmarks.measures import displacement_error, pressure_error
from abut.benchmarks.patch import shaken
from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import half_disc, join, rectangle
from abut.model import Contact, Force, Model, Pressure, Solid, Support
from abut.model.conditions import support_along
from abut.solution import Solution

CONTRAST = 1e4
SIZES = {"coarse": ((1, 1, 1), (10, 10, 2)), "fine": ((10, 10, 2), (1, 1, 1))}
POISSON, STRAIN = 0.3, 1e-3


def _patch(stiffness: str, size: str) -> Benchmark:
    young = {"lower": CONTRAST if stiffness == "stiff" else 1.0 / CONTRAST, "upper": 1.0}
    load = STRAIN * min(young.values())

    def model(level: int) -> Model:
        lower, upper = SIZES[size]
        parts = {"lower": shaken(0, 1, lower, "hex8", 5), "upper": shaken(1, 2, upper, "hex8", 6)}
        sides = [
            support_along(f"{b}.{side}", axis, 0.0) for b in parts for side, axis in (("left", "x"), ("front", "y"))
        ]
        return Model(
            join(parts),
            [Solid(body, LinearElastic(young[body], POISSON)) for body in parts],
            [Support("lower.bottom", z=0), *sides],
            [Pressure("upper.top", load)],
            [Contact(contactor="lower.top", target="upper.bottom")],
        )

    def measure(solution: Solution) -> dict[str, float]:
        mesh = solution.model.mesh
        wanted = np.zeros_like(mesh.points)
        base = 0.0
        for body, bottom in (("lower", 0.0), ("upper", 1.0)):
            nodes, strain = mesh.nodes_of(body), load / young[body]
            wanted[nodes] = mesh.points[nodes] * strain * [POISSON, POISSON, -1.0] + [0.0, 0.0, base + strain * bottom]
            base = -strain
        return {
            "pressure": pressure_error(solution, lambda x: np.full(len(x), load)) / load,
            "displacement": displacement_error(solution, lambda _: wanted),
        }

    reason = "rounding times the contrast in stiffness"
    error = Reference(0.0, 1e-8, "uniform stress is exact", reason)
    return Benchmark(
        f"contrast-patch-{stiffness}-{size}",
        f"patch test, contactor 1e4 times {'stiffer' if stiffness == 'stiff' else 'softer'} and {size} (10 to 1)",
        model,
        measure,
        {"pressure": error, "displacement": error},
    )


HALF_WIDTH, ROUND = 6.0, 50.0


def _hertz(name: str, young: tuple[float, float], cells: tuple[int, int], contactor: str) -> Benchmark:
    """Young's moduli and cells of cylinder and block; the load is such that a = 6."""
    modulus = 1.0 / ((1.0 - POISSON**2) * sum(1.0 / e for e in young))
    load = 0.25 * np.pi * HALF_WIDTH**2 * modulus / ROUND
    peak = np.sqrt(load * modulus / (np.pi * ROUND))

    def model(level: int) -> Model:
        n, m = (c * 2**level for c in cells)
        cylinder = half_disc(ROUND, (0.0, ROUND), fine=8.0, cells=n)
        block = rectangle((-100.0, 100.0), (-200.0, 0.0), (2 * m, m), fine={"x": [-8.0, 8.0], "y": [-8.0, 0.0]})
        pair = ("block.top", "cylinder.round") if contactor == "block" else ("cylinder.round", "block.top")
        return Model(
            join({"cylinder": cylinder, "block": block}),
            [Solid(body, LinearElastic(e, POISSON)) for body, e in zip(("cylinder", "block"), young)],
            [Support("block.bottom", x=0, y=0), Support("cylinder.axis", x=0)],
            [Force("cylinder.flat", (0.0, -load))],
            [Contact(contactor=pair[0], target=pair[1])],
            plane="strain",
        )

    def measure(solution: Solution) -> dict[str, float]:
        ripple = next(check for check in solution.certificate if check.name == "oscillation")
        return {"max pressure": solution.contacts[0].max_pressure / peak, "oscillation": ripple.value}

    return Benchmark(
        f"contrast-hertz-{name}",
        f"Hertz line contact, {name.replace('-', ' ')}",
        model,
        measure,
        {
            "max pressure": Reference(
                1.0, 0.03, "Hertz", "over the peak; a / R = 0.12, and up to 8 cells for 16 lengths"
            ),
            "oscillation": Reference(0.0, 0.06, "Hertz's pressure is smooth", "the certificate's limit"),
        },
    )


BENCHMARKS = (
    *(_patch(stiffness, size) for stiffness in ("soft", "stiff") for size in SIZES),
    _hertz("soft-block", (CONTRAST, 1.0), (12, 12), "block"),
    _hertz("stiff-block", (1.0, CONTRAST), (12, 12), "block"),
    _hertz("soft-cylinder", (1.0, CONTRAST), (12, 12), "cylinder"),
    _hertz("stiff-cylinder", (CONTRAST, 1.0), (12, 12), "cylinder"),
    _hertz("coarse-block", (1.0, 1.0), (60, 6), "block"),
    _hertz("fine-block", (1.0, 1.0), (8, 40), "block"),
    _hertz("coarse-cylinder", (1.0, 1.0), (6, 60), "cylinder"),
    _hertz("fine-cylinder", (1.0, 1.0), (60, 6), "cylinder"),
    _hertz("soft-coarse-cylinder", (1.0, CONTRAST), (6, 60), "cylinder"),
    _hertz("soft-fine-cylinder", (1.0, CONTRAST), (60, 6), "cylinder"),
    _hertz("soft-fine-block", (CONTRAST, 1.0), (8, 40), "block"),
)
