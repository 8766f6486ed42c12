"""Rubber that hardly changes its volume: thick cylinder and sphere blown up by a following pressure, Cook's membrane."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.hyperelastic import NeoHooke
from abut.mesh.make import join, rectangle, ring
from abut.mesh.mesh import Mesh
from abut.model import Force, Model, Pressure, Solid, SolveOptions, Support
from abut.solution import Solution

SHEAR, BULK = 1.0, 5e4
RADII, INFLATED = (1.0, 2.0), 1.6  # stretch of the inner surface
SMOOTH = "cells of first order, h^2, and a bulk modulus of 5e4 times the shear modulus"


def outer_stretch(power: int) -> float:
    """Stretch of the outer surface at constant volume."""
    a, b = RADII
    return float(((INFLATED * a) ** power - a**power + b**power) ** (1.0 / power) / b)


def cylinder_pressure() -> float:
    """At which the inner surface has its stretch: int of mu (s^2 - s^-2) dr / r over the wall, s = r / R."""
    a, b = INFLATED, outer_stretch(2)
    return float(SHEAR * (np.log(a / b) + 0.5 * (b**-2 - a**-2)))


def sphere_pressure() -> float:
    """The same of a sphere: int of 2 mu (s^2 - s^-4) dr / r."""
    a, b = INFLATED, outer_stretch(3)
    return float(SHEAR * (2.0 / b + 0.5 / b**4 - 2.0 / a - 0.5 / a**4))


def inflation_source(shape: str) -> str:
    """Where the pressures are from, in words."""
    integrand = "2 (s^2 - s^-4)" if shape == "sphere" else "(s^2 - s^-2)"
    return f"incompressible neo-Hooke: p = int mu {integrand} dr/r, s = r/R"


def _rubber(mesh: Mesh, supports: list[Support], pressure: Pressure, plane: str) -> Model:
    rubber = NeoHooke(shear=SHEAR, bulk=BULK, volumetric="isochoric")
    return Model(
        mesh, [Solid("wall", rubber, integration="b-bar")], supports, [pressure], plane=plane, kinematics="finite",
        solve=SolveOptions(steps=5),
    )  # fmt: skip


def _inflated(shape: str) -> Benchmark:
    value = sphere_pressure() if shape == "sphere" else cylinder_pressure()

    def model(level: int) -> Model:
        n = 2**level
        if shape == "tube":
            mesh = join({"wall": rectangle(RADII, (0.0, 0.5), (8 * n, 1), "quad4")})
            ends = [Support(f"wall.{end}", y=0.0) for end in ("bottom", "top")]
            return _rubber(mesh, ends, Pressure("wall.left", value), "axisymmetric")
        mesh = join({"wall": ring(RADII, cells=(8 * n, 12 * n), cell="quad4")})
        ends = [Support("wall.start", y=0.0), Support("wall.end", x=0.0)]
        plane = "axisymmetric" if shape == "sphere" else "strain"
        return _rubber(mesh, ends, Pressure("wall.inner", value), plane)

    def measure(solution: Solution) -> dict[str, float]:
        points = solution.model.mesh.points
        r = np.linalg.norm(points, axis=1) if shape != "tube" else points[:, 0]
        moved = points + solution.displacement
        after = np.linalg.norm(moved, axis=1) if shape != "tube" else moved[:, 0]
        inner, outer = np.isclose(r, RADII[0]), np.isclose(r, RADII[1])
        return {
            "inner stretch": float(after[inner].mean()) / RADII[0],
            "outer stretch": float(after[outer].mean()) / RADII[1],
        }

    power = 3 if shape == "sphere" else 2
    source = inflation_source(shape)
    return Benchmark(
        f"finite-{shape}",
        {"cylinder": "thick rubber cylinder, plane strain", "tube": "the same cylinder, axisymmetric",
         "sphere": "thick rubber sphere, axisymmetric"}[shape] + ", under internal pressure",
        model,
        measure,
        {
            "inner stretch": Reference(INFLATED, 1e-2, source, SMOOTH),
            "outer stretch": Reference(outer_stretch(power), 1e-2, source, SMOOTH),
        },
    )  # fmt: skip


def cook(n: int) -> Model:
    """Cook's membrane with n cells along each side."""
    mesh = rectangle((0.0, 1.0), (0.0, 1.0), (n, n), "quad4")
    along, up = mesh.points.T
    points = np.column_stack([48.0 * along, 44.0 * along + up * (44.0 - 28.0 * along)])
    return Model(
        join({"membrane": replace(mesh, points=points)}),
        [Solid("membrane", NeoHooke(shear=80.194, bulk=400889.8, volumetric="isochoric"), integration="b-bar")],
        [Support("membrane.left", x=0.0, y=0.0)],
        [Force("membrane.right", (0.0, 100.0))],
        plane="strain",
        kinematics="finite",
        solve=SolveOptions(steps=4),
    )


def cook_tip(solution: Solution) -> float:
    """Displacement upwards of the upper right corner."""
    corner = np.isclose(solution.model.mesh.points, (48.0, 60.0)).all(axis=1)
    return float(solution.displacement[corner, 1][0])


COOK = Benchmark(
    "finite-cook",
    "Cook's membrane, nearly incompressible, F-bar",
    lambda level: cook(16 * 2**level),
    lambda solution: {"tip": cook_tip(solution)},
    {
        "tip": Reference(
            6.92,
            0.02,
            "Simo and Armero 1992 (problem); 6.920 with quad9 cells and linear pressures, 16 along each side",
            "16 cells of first order along each side: 4, 8 and 16 give 6.173, 6.674 and 6.834",
        )
    },
)

BENCHMARKS = (*(_inflated(shape) for shape in ("cylinder", "tube", "sphere")), COOK)
