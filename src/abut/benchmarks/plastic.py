"""Metal that yields (von Mises): thick cylinder and sphere, press fits, a half space under a ball."""

from __future__ import annotations

import numpy as np

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.materials.plastic import Plastic
from abut.mesh.make import join, rectangle, ring
from abut.model import Amplitude, Contact, Model, Pressure, Rigid, Solid, SolveOptions, Support
from abut.solution import Solution, Step

YOUNG, POISSON = 210e3, 0.3
INNER, OUTER, YIELD = 100.0, 200.0, 240.0
RADIAL = "equilibrium of the radius alone, von Mises, 120 quadratic cells, integrated to 1e-7"
CYLINDER = f"thick cylinder of radii 100 and 200, plane strain, E = 210e3, nu = .3, yield stress 240; {RADIAL}"
QUADRATIC = "quadratic cells, 12 through the wall, against a kink of the stress at the radius of yield"


def _cylinder(moved: float, pressure: float, outer: float, hardening: float = 0.0) -> Benchmark:
    """A bore widened by a given displacement: it follows beyond the limit pressure."""

    def model(level: int) -> Model:
        n = 2**level
        wall = rectangle((INNER, OUTER), (0.0, 5.0), (12 * n, 1), "quad8")
        ends = [Support(f"wall.{side}", y=0) for side in ("bottom", "top")]
        return Model(
            join({"wall": wall}),
            [Solid("wall", Plastic(YOUNG, POISSON, YIELD, hardening))],
            [*ends, Support("wall.left", x=moved)],
            plane="axisymmetric",
            solve=SolveOptions(steps=10),
        )

    def measure(solution: Solution) -> dict[str, float]:
        last, mesh = solution.steps[-1], solution.model.mesh
        area = 2.0 * np.pi * INNER * 5.0
        return {
            "pressure": float(last.reactions["wall.left"][0]) / area,
            "outer displacement": float(last.displacement[mesh.nodes_of("wall.right"), 0].mean()),
        }

    name = f"plastic-cylinder-{moved:g}" + (f"-hardening-{hardening:g}" if hardening else "")
    references = {"pressure": Reference(pressure, 5e-3, CYLINDER, QUADRATIC)}
    if outer:
        references["outer displacement"] = Reference(outer, 5e-3, CYLINDER, QUADRATIC)
    title = f"thick cylinder widened by {moved:g} at the bore" + (", with hardening" if hardening else "")
    return Benchmark(name, title, model, measure, references)


def _unloaded() -> Benchmark:
    def model(level: int) -> Model:
        n = 2**level
        wall = rectangle((INNER, OUTER), (0.0, 5.0), (12 * n, 1), "quad8")
        return Model(
            join({"wall": wall}),
            [Solid("wall", Plastic(YOUNG, POISSON, YIELD))],
            [Support(f"wall.{side}", y=0) for side in ("bottom", "top")],
            [Pressure("wall.left", 170.0, amplitude=Amplitude(((0.0, 0.0), (0.8, 1.0), (1.0, 0.0))))],
            plane="axisymmetric",
            solve=SolveOptions(steps=10),
        )

    def measure(solution: Solution) -> dict[str, float]:
        mesh = solution.model.mesh

        def at(step: Step, side: str) -> float:
            return float(step.displacement[mesh.nodes_of(f"wall.{side}"), 0].mean())

        full = next(step for step in solution.steps if abs(step.factor - 0.8) < 1e-9)
        values = {"bore": at(full, "left"), "outside": at(full, "right")}
        return values | {
            "bore unloaded": at(solution.steps[-1], "left"),
            "outside unloaded": at(solution.steps[-1], "right"),
        }

    exact = {"bore": 0.215752, "outside": 0.129087, "bore unloaded": 0.061403, "outside unloaded": 0.030864}
    return Benchmark(
        "plastic-cylinder-unloaded",
        "thick cylinder under a pressure of 170, unloaded",
        model,
        measure,
        {name: Reference(value, 5e-3, CYLINDER, QUADRATIC) for name, value in exact.items()},
    )


def _sphere(radius: float, pressure: float, bore: float, outer: float) -> Benchmark:
    def model(level: int) -> Model:
        n = 2**level
        wall = ring((INNER, OUTER), (0.0, 90.0), cells=(12 * n, 6 * n))
        return Model(
            join({"wall": wall}),
            [Solid("wall", Plastic(YOUNG, POISSON, YIELD))],
            [Support("wall.start", y=0), Support("wall.end", x=0)],
            [Pressure("wall.inner", pressure)],
            plane="axisymmetric",
            solve=SolveOptions(steps=5),
        )

    def measure(solution: Solution) -> dict[str, float]:
        mesh, moved = solution.model.mesh, solution.displacement
        sizes = np.linalg.norm(moved, axis=1)
        return {side: float(sizes[mesh.nodes_of(f"wall.{side}")].mean()) for side in ("inner", "outer")}

    source = f"thick sphere of the same data, yielded to a radius of {radius:g} (Hill 1950, exact)"
    return Benchmark(
        f"plastic-sphere-{radius:g}",
        f"thick sphere under pressure, yielded to a radius of {radius:g}",
        model,
        measure,
        {
            "inner": Reference(bore, 5e-3, source, QUADRATIC),
            "outer": Reference(outer, 5e-3, source, QUADRATIC),
        },
    )


def _press_fit(interference: float, pressure: float) -> Benchmark:
    def model(level: int) -> Model:
        n = 2**level
        parts = {
            "shaft": rectangle((0.0, 50.0), (0.0, 5.0), (4 * n, 1), "quad8"),
            "hub": rectangle((50.0, 100.0), (0.0, 5.0), (12 * n, 1), "quad8"),
        }
        return Model(
            join(parts),
            [Solid("shaft", LinearElastic(YOUNG, POISSON)), Solid("hub", Plastic(YOUNG, POISSON, 300.0))],
            [Support(f"{body}.{side}", y=0) for body in parts for side in ("bottom", "top")],
            contacts=[Contact("hub.left", "shaft.right", offset=-interference)],
            plane="axisymmetric",
            solve=SolveOptions(steps=5),
        )

    def measure(solution: Solution) -> dict[str, float]:
        return {"pressure": float(np.nanmean(solution.contacts[0].pressure))}

    source = f"elastic shaft of radius 50, hub to 100, yield stress 300, plane strain; {RADIAL}"
    return Benchmark(
        f"plastic-press-fit-{interference:g}",
        f"press fit that yields, radial interference {interference:g}",
        model,
        measure,
        {"pressure": Reference(pressure, 1e-2, source, QUADRATIC)},
    )


RADIUS, BALL_YIELD = 10.0, 500.0
FIRST_FORCE, FIRST_WIDTH, FIRST_DEPTH = 5.0885, 0.054890, 3.0129e-4  # where it begins to yield, by Hertz and 1.6128
INDENTED = (
    "half space under a rigid smooth ball, perfect plasticity, E / Y = 420: own axisymmetric elements against a "
    "parabola"
)
AGREED = (
    "cells of a quarter of the first contact radius; Kogut and Etsion (2002) and those elements agree within 3 %; the "
    "domain ends at 900 of these radii"
)


def _indented(depth: float, force: float) -> Benchmark:
    def model(level: int) -> Model:
        h, zone, far = FIRST_WIDTH / 4.0 / 2**level, 1.1 * FIRST_WIDTH * np.sqrt(2.0 * depth), 900.0 * FIRST_WIDTH
        n = int(np.ceil(zone / h))
        fine = {"x": [0.0, zone], "y": [-1.2 * zone, 0.0]}
        ground = rectangle((0.0, far), (-far, 0.0), (n, int(1.2 * n)), "quad4", fine, 1.3)
        last = -90.0 + np.rad2deg(1.2 * zone / RADIUS)
        ball = ring((0.95 * RADIUS, RADIUS), (-90.0, last), (0.0, RADIUS), (1, 2 * n))
        return Model(
            join({"ground": ground, "ball": ball}),
            [Solid("ground", Plastic(YOUNG, POISSON, BALL_YIELD))],
            [Support("ground.bottom", y=0), Support("ground.left", x=0), Support("ground.right", x=0)],
            contacts=[Contact("ground.top", "ball.outer")],
            rigid=[Rigid("ball", y=-depth * FIRST_DEPTH)],
            plane="axisymmetric",
            solve=SolveOptions(steps=int(4 * depth)),
        )

    def measure(solution: Solution) -> dict[str, float]:
        return {"force": abs(float(solution.contacts[0].force[1])) / FIRST_FORCE}

    return Benchmark(
        f"plastic-half-space-{depth:g}",
        f"half space under a rigid ball, pressed in {depth:g} times as far as where it yields first",
        model,
        measure,
        {"force": Reference(force, 0.03, INDENTED, AGREED)},
    )


# Ball and half space of one metal: each yields as under a rigid ball of twice the radius at half the depth, so that half of
# E / (1 - nu^2) gives four times the force, twice the width and four times the depth at first yield
BOTH_FORCE, BOTH_WIDTH, BOTH_DEPTH = 4.0 * FIRST_FORCE, 2.0 * FIRST_WIDTH, 4.0 * FIRST_DEPTH
BOTH_AGREED = (
    "cells of a quarter of the first contact radius; a ball of 91 of these radii is held at its middle, which a half space "
    "is not: less than 1 %"
)


def _both_indented(depth: float, force: float) -> Benchmark:
    def model(level: int) -> Model:
        h, zone, far = BOTH_WIDTH / 4.0 / 2**level, 1.1 * BOTH_WIDTH * np.sqrt(2.0 * depth), 900.0 * BOTH_WIDTH
        n, deep = int(np.ceil(zone / h)), 1.2 * zone
        fine = {"x": [0.0, zone], "y": [-deep, 0.0]}
        ground = rectangle((0.0, far), (-far, 0.0), (n, int(1.2 * n)), "quad4", fine, 1.3)
        edge = -90.0 + np.rad2deg(zone / RADIUS)
        ball = ring(
            (0.01 * RADIUS, RADIUS), (-90.0, 0.0), (0.0, RADIUS), (int(1.2 * n), int(1.2 * n)), "quad4",
            {"x": [RADIUS - deep, RADIUS], "y": [-90.0, edge]}, 1.3,
        )  # fmt: skip
        metal = Plastic(YOUNG, POISSON, BALL_YIELD)
        return Model(
            join({"ground": ground, "ball": ball}),
            [Solid("ground", metal), Solid("ball", metal)],
            [
                Support("ground.bottom", y=0), Support("ground.left", x=0), Support("ground.right", x=0),
                Support("ball.start", x=0), Support("ball.end", y=-depth * BOTH_DEPTH),
            ],
            contacts=[Contact("ground.top", "ball.outer")],
            plane="axisymmetric",
            solve=SolveOptions(steps=int(4 * depth)),
        )  # fmt: skip

    return Benchmark(
        f"plastic-ball-and-half-space-{depth:g}",
        f"half space and ball of the same metal, pressed together {depth:g} times as far as where they yield first",
        model,
        lambda solution: {"force": abs(float(solution.contacts[0].force[1])) / BOTH_FORCE},
        {"force": Reference(force, 0.03, f"{INDENTED}; the same of both by symmetry", BOTH_AGREED)},
    )


INDENTATIONS = ((2.0, 2.755), (5.0, 9.93), (10.0, 25.4), (20.0, 61.9))  # depth and force, over those at first yield
BENCHMARKS = (
    _cylinder(0.20, 165.5099, 0.120619),
    _cylinder(0.40, 191.1704, 0.224524),
    _cylinder(0.40, 193.5359, 0.0, 2100.0),
    _unloaded(),
    _sphere(160.0, 303.6817, 0.269836, 0.08192),
    *(_press_fit(*pair) for pair in ((0.08, 137.962), (0.15, 206.533), (0.30, 239.291))),
    *(_indented(*pair) for pair in INDENTATIONS),
    *(_both_indented(*pair) for pair in INDENTATIONS),
)
