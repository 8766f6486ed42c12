"""Rotating discs, bearing loads, pressures of a liquid, springs and dashpots: closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import join, rectangle, ring
from abut.model import (
    Amplitude,
    Centrifugal,
    Contact,
    Force,
    Gravity,
    Model,
    Pressure,
    Solid,
    SolveOptions,
    Spring,
    Support,
)
from abut.solution import Solution

YOUNG, POISSON, DENSITY = 210e3, 0.3, 7.85e-9  # N, mm, t
TIMOSHENKO = "Timoshenko and Goodier, Theory of Elasticity, rotating discs"
QUADRATIC = "quadratic cells, of which {} go through the wall: stresses err by about h^2 of these"


def _quarter(name: str) -> list[Support]:
    """Planes of symmetry of the quarter of a ring."""
    return [Support(f"{name}.start", y=0), Support(f"{name}.end", x=0)]


def _at(model: Model, place: tuple[float, float]) -> int:
    return int(np.argmin(np.linalg.norm(model.mesh.points - place, axis=1)))


def _rotating_disc() -> Benchmark:
    inner, outer, speed = 20.0, 100.0, 1000.0
    size = DENSITY * speed**2 / 4.0
    hoop = size * ((3.0 + POISSON) * outer**2 + (1.0 - POISSON) * inner**2)
    rim = size * outer / YOUNG * ((1.0 - POISSON) * outer**2 + (3.0 + POISSON) * inner**2)

    def model(level: int) -> Model:
        n = 2**level
        mesh = join({"disc": ring((inner, outer), (0.0, 90.0), cells=(8 * n, 12 * n))})
        return Model(
            mesh, [Solid("disc", LinearElastic(YOUNG, POISSON, DENSITY))], _quarter("disc"), [Centrifugal(speed)],
            plane="stress",
        )  # fmt: skip

    def measure(solution: Solution) -> dict[str, float]:
        step, model = solution.steps[-1], solution.model
        return {
            "hoop stress at the bore": float(step.stress[_at(model, (inner, 0.0)), 1]),
            "displacement of the rim": float(step.displacement[_at(model, (outer, 0.0)), 0]),
        }

    return Benchmark(
        "rotating-disc", "disc with a bore, rotating: hoop stress and growth", model, measure,
        {
            "hoop stress at the bore": Reference(hoop, 2e-3, TIMOSHENKO, QUADRATIC.format("eight")),
            "displacement of the rim": Reference(rim, 1e-4, TIMOSHENKO, "quadratic cells: displacements err by h^4"),
        },
    )  # fmt: skip


def _rotating_fit() -> Benchmark:
    """The bore of the hub grows more than the shaft does: c/E rho w^2/4 (3 + nu)(b^2 - a^2) of the interference is gone."""
    a, c, b, overlap, speed = 5.0, 20.0, 60.0, 0.01, 800.0
    soft = c / YOUNG * ((b**2 + c**2) / (b**2 - c**2) + (c**2 + a**2) / (c**2 - a**2))
    grown = c / YOUNG * DENSITY * speed**2 / 4.0 * (3.0 + POISSON) * (b**2 - a**2)

    def model(level: int) -> Model:
        n = 2**level
        mesh = join(
            {
                "shaft": ring((a, c + overlap), (0.0, 90.0), cells=(4 * n, 12 * n)),
                "hub": ring((c, b), (0.0, 90.0), cells=(8 * n, 14 * n)),
            }
        )
        steel = LinearElastic(YOUNG, POISSON, DENSITY)
        return Model(
            mesh, [Solid("shaft", steel), Solid("hub", steel)], [*_quarter("shaft"), *_quarter("hub")],
            [Centrifugal(speed)], [Contact("shaft.outer", "hub.inner", "fit")], plane="stress",
        )  # fmt: skip

    def measure(solution: Solution) -> dict[str, float]:
        fit = solution.contacts[0]
        return {"pressure": float(np.linalg.norm(fit.force)) / (np.sqrt(2.0) * c)}

    source = f"{TIMOSHENKO}, and Lame"
    return Benchmark(
        "rotating-fit", "hub shrunk onto a shaft, rotating: mean pressure that is left", model, measure,
        {"pressure": Reference((overlap - grown) / soft, 2e-3, source, "interference of 5e-4 of the radius beside 1")},
    )  # fmt: skip


def _bearing() -> Benchmark:
    radius, force = 10.0, 1000.0
    peak = 2.0 * force / (np.pi * radius)

    def model(level: int) -> Model:
        n = 2**level
        mesh = join({"lug": ring((radius, 40.0), (-90.0, 90.0), cells=(10 * n, 24 * n))})
        return Model(
            mesh, [Solid("lug", LinearElastic(YOUNG, POISSON))], [Support("lug.outer", x=0, y=0)],
            [Force("lug.inner", (force, 0.0), bearing=True)], plane="stress",
        )  # fmt: skip

    def measure(solution: Solution) -> dict[str, float]:
        step, model = solution.steps[-1], solution.model
        xx, yy, _, xy = step.stress[_at(model, (radius / np.sqrt(2.0), radius / np.sqrt(2.0))), :4]
        return {
            "force": -float(step.reaction[0]),
            "pressure in the middle": -float(step.stress[_at(model, (radius, 0.0)), 0]),
            "pressure at 45 degrees": -float(0.5 * (xx + yy) + xy),
        }

    source = "p = 2 F / (pi R) cos(angle), which adds up to F"
    reason = "stresses at loaded surfaces meet the load there; chords of a circle, h^4"
    return Benchmark(
        "bearing-load", "bearing load on a bore: what the stress at its surface says of the pressure", model, measure,
        {
            "force": Reference(force, 1e-8, "what is prescribed", "balance of forces"),
            "pressure in the middle": Reference(peak, 1e-3, source, reason),
            "pressure at 45 degrees": Reference(peak / np.sqrt(2.0), 1e-3, source, reason),
        },
    )  # fmt: skip


def _immersed() -> Benchmark:
    """As dense as the liquid: the stress is the pressure of the liquid everywhere, and nothing holds the body."""
    density, gravity, depth = 1e-9, 9810.0, 500.0
    weight = density * gravity

    def model(level: int) -> Model:
        n = 2**level
        mesh = join({"block": rectangle((0.0, 60.0), (0.0, 100.0), (3 * n, 5 * n), "quad8")})
        mesh = replace(mesh, node_sets={"corner": np.flatnonzero((mesh.points == 0.0).all(axis=1))})
        pressure = f"{weight!r}*({depth!r} - y)"
        sides = [Pressure(f"block.{side}", pressure) for side in ("left", "right", "top", "bottom")]
        return Model(
            mesh, [Solid("block", LinearElastic(1.0, POISSON, density))],
            [Support("corner", y=0), Support("block.left", x=0)], [*sides, Gravity((0.0, -gravity))], plane="stress",
        )  # fmt: skip

    def measure(solution: Solution) -> dict[str, float]:
        step, model = solution.steps[-1], solution.model
        y = model.mesh.points[:, 1]
        wanted = -weight * (depth - y)
        return {
            "load on the sides": float(step.load[1]) / (weight * 6000.0),
            "stress": float(np.abs(step.stress[:, :2] - wanted[:, None]).max() / (weight * depth)),
        }

    return Benchmark(
        "immersed-block", "block in a liquid of its density: stresses are the pressure of the liquid", model, measure,
        {
            "load on the sides": Reference(0.0, 1e-10, "buoyancy less weight, over the weight", "linear pressures"),
            "stress": Reference(0.0, 1e-10, "hydrostatic state, over the pressure at the level of y = 0", "linear stresses"),
        },
    )  # fmt: skip


def _springs() -> Benchmark:
    """A bar on a bed, another above it on springs between points: everything in a row."""
    young, height, width, force = 1000.0, 4.0, 2.0, 10.0
    bed, link = 50.0, 20.0
    bar = height / (young * width)

    def model(level: int) -> Model:
        n = 2**level
        parts = {
            "lower": rectangle((0.0, width), (0.0, height), (1, 2 * n), "quad4"),
            "upper": rectangle((0.0, width), (height + 1.0, 2.0 * height + 1.0), (1, 2 * n), "quad4"),
        }
        mesh = join(parts)
        ends = {"below": mesh.nodes_of("lower.top"), "above": mesh.nodes_of("upper.bottom")}
        return Model(
            replace(mesh, node_sets={**mesh.node_sets, **ends}),
            [Solid(name, LinearElastic(young, 0.0)) for name in parts],
            [Support("lower.left", x=0), Support("upper.left", x=0)], [Force("upper.top", (0.0, -force))],
            springs=[
                Spring("bed", "lower.bottom", normal=bed / width, per_area=True),
                Spring("link", "above", to="below", along=link),
            ],
            plane="stress",
        )  # fmt: skip

    def measure(solution: Solution) -> dict[str, float]:
        step, mesh = solution.steps[-1], solution.model.mesh
        return {
            f"displacement of {name}": -float(step.displacement[mesh.nodes_of(name), 1].mean())
            for name in ("lower.top", "upper.top")
        } | {"force of the bed": float(step.springs["bed"][1])}

    source, reason = "bars and springs in a row: F (1 / k + L / E A)", "uniform stresses, nu = 0"
    return Benchmark(
        "springs", "two bars on a bed of springs, with springs between them", model, measure,
        {
            "displacement of lower.top": Reference(force * (1.0 / bed + bar), 1e-9, source, reason),
            "displacement of upper.top": Reference(force * (1.0 / bed + 1.0 / link + 2.0 * bar), 1e-9, source, reason),
            "force of the bed": Reference(force, 1e-9, "balance of forces", "uniform stresses"),
        },
    )  # fmt: skip


def _kelvin() -> Benchmark:
    """A bar on a bed of springs and one of dashpots, under a force that is there at once."""
    young, height, width, force = 1000.0, 4.0, 2.0, 10.0
    bed, damping, end = 50.0, 100.0, 4.0  # the exponential falls by e in 2
    decay = bed / damping

    def model(level: int) -> Model:
        steps = 40 * 2**level
        return Model(
            join({"bar": rectangle((0.0, width), (0.0, height), (1, 2), "quad4")}),
            [Solid("bar", LinearElastic(young, 0.0))],
            [Support("bar.left", x=0)],
            [Force("bar.top", (0.0, -force), amplitude=Amplitude(((0.0, 1.0), (end, 1.0))))],
            springs=[
                Spring("bed", "bar.bottom", normal=bed / width, per_area=True),
                Spring("dashpots", "bar.bottom", normal=damping / width, per_area=True, dashpot=True),
            ],
            plane="stress",
            solve=SolveOptions(end=end, times=tuple(np.linspace(0.0, end, steps + 1)[1:])),
        )

    def measure(solution: Solution) -> dict[str, float]:
        nodes = solution.model.mesh.nodes_of("bar.bottom")
        sunk = np.array([-float(step.displacement[nodes, 1].mean()) for step in solution.steps])
        ends = np.array([step.time for step in solution.steps])
        euler = force / bed * (1.0 - (1.0 + ends[0] * decay) ** -np.arange(1.0, len(ends) + 1.0))
        resisted = np.array([float(step.springs["dashpots"][1]) for step in solution.steps])
        taken = sum(step.energy.dashpots for step in solution.steps if step.energy)
        speeds = np.diff(euler, prepend=0.0) / ends[0]
        return {
            "displacements over Euler's": 1.0 + float(np.abs(sunk / euler - 1.0).max()),
            "forces of the dashpots over Euler's": 1.0 + float(np.abs(resisted - damping * speeds).max()) / force,
            "energy over Euler's": taken / float(damping * ends[0] * speeds @ speeds),
            "displacement over the exponential": float(sunk[-1] / (force / bed * (1.0 - np.exp(-decay * end)))),
        }

    exact, rounding = "u_n = (F + c u_(n-1) / dt) / (k + c / dt)", "uniform stresses, nu = 0"
    return Benchmark(
        "kelvin", "a bar on springs and dashpots under a force that is there at once", model, measure,
        {
            "displacements over Euler's": Reference(1.0, 1e-10, exact, rounding),
            "forces of the dashpots over Euler's": Reference(1.0, 1e-10, exact, rounding),
            "energy over Euler's": Reference(1.0, 1e-10, "c times speed squared", rounding),
            "displacement over the exponential": Reference(
                1.0, 0.01, "Kelvin and Voigt: F / k (1 - exp(-k t / c))",
                "backward Euler with 40 steps: the exponent is smaller by k dt / 2 c, 2.5 %",
            ),
        },
    )  # fmt: skip


BENCHMARKS = (_rotating_disc(), _rotating_fit(), _bearing(), _immersed(), _springs(), _kelvin())
