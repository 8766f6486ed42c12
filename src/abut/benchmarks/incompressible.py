"""Bodies that keep their volume, of mixed cells: Cook's membrane, a layer under a cylinder, rubber cylinder and sphere."""

from __future__ import annotations

import numpy as np

from abut.benchmarks.finite_rubber import (
    INFLATED,
    RADII,
    SHEAR,
    cylinder_pressure,
    inflation_source,
    outer_stretch,
    sphere_pressure,
)
from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.materials.hyperelastic import NeoHooke
from abut.mesh.make import join, rectangle, ring
from abut.mesh.mesh import Mesh
from abut.model import Contact, Model, Pressure, Rigid, Solid, SolveOptions, Support, Traction
from abut.solution import Solution

WIDTH, ROLLER = 20.0, 400.0  # half of the contact's on a layer of thickness and shear modulus 1; the cylinder's radius


def _cook(cell: str) -> Benchmark:
    def model(level: int) -> Model:
        n = 16 * 2**level
        square = rectangle((0.0, 1.0), (0.0, 1.0), (n, n), cell)
        along, up = square.points.T
        points = np.column_stack([48.0 * along, 44.0 * along + up * (44.0 - 28.0 * along)])
        membrane = Mesh(points, square.blocks, square.bodies, square.surfaces)
        return Model(
            join({"membrane": membrane}),
            [Solid("membrane", LinearElastic(250.0, 0.5), integration="mixed")],
            [Support("membrane.left", x=0.0, y=0.0)],
            [Traction("membrane.right", (0.0, 100.0 / 16.0))],
            plane="strain",
        )

    def measure(solution: Solution) -> dict[str, float]:
        corner = np.isclose(solution.model.mesh.points, (48.0, 60.0)).all(axis=1)
        return {"tip": float(solution.displacement[corner, 1][0])}

    return Benchmark(
        f"mixed-cook-{cell}",
        f"Cook's membrane of small strains, Poisson's ratio 0.5, mixed {cell}",
        model,
        measure,
        {
            "tip": Reference(
                7.767, 0.01, "extrapolated from three kinds of mixed triangles, another program", "16 cells a side"
            )
        },
    )


def _layer(cell: str) -> Benchmark:
    """The pressure is that of a fluid film's: a layer that changes its volume would carry a parabola."""

    def model(level: int) -> Model:
        n = 2**level
        layer = rectangle((0.0, 30.0), (-1.0, 0.0), (90 * n, 3 * n), cell)
        roller = ring((ROLLER - 5.0, ROLLER), (-90.0, -85.5), (0.0, ROLLER), (1, 80 * n))
        return Model(
            join({"layer": layer, "roller": roller}),
            [Solid("layer", LinearElastic(3.0, 0.5), integration="mixed")],
            [Support("layer.bottom", x=0.0, y=0.0), Support("layer.left", x=0.0)],
            contacts=[Contact("layer.top", "roller.outer")],
            rigid=[Rigid("roller", x=0.0, y=-(WIDTH**2) / (6.0 * ROLLER), rz=0.0)],
            plane="strain",
        )

    def measure(solution: Solution) -> dict[str, float]:
        contact = solution.contacts[0]
        return {"force": 2.0 * abs(float(contact.force[1])), "largest pressure": contact.max_pressure}

    source = "lubrication theory of a bonded incompressible layer: p = G (a^2 - x^2)^2 / (8 R b^3)"
    return Benchmark(
        f"mixed-layer-{cell}",
        f"thin bonded incompressible layer under a rigid cylinder, mixed {cell}",
        model,
        measure,
        {
            "force": Reference(2.0 * WIDTH**5 / (15.0 * ROLLER), 0.05, source, "of order b / a, a twentieth"),
            "largest pressure": Reference(WIDTH**4 / (8.0 * ROLLER), 0.05, source, "of order b / a, a twentieth"),
        },
    )


def _inflated(shape: str, cell: str) -> Benchmark:
    """Cylinder or sphere (a quarter of its meridian) of rubber; 16 cells of second order through the wall."""
    sphere = shape == "sphere"

    def model(level: int) -> Model:
        n = 2**level
        wall = ring(RADII, cells=(16 * n, 24 * n), cell=cell)
        rubber = NeoHooke(shear=SHEAR, bulk=1e7 * SHEAR, volumetric="isochoric")
        return Model(
            join({"wall": wall}),
            [Solid("wall", rubber, integration="mixed")],
            [Support("wall.start", y=0.0), Support("wall.end", x=0.0)],
            [Pressure("wall.inner", sphere_pressure() if sphere else cylinder_pressure())],
            plane="axisymmetric" if sphere else "strain",
            kinematics="finite",
            solve=SolveOptions(steps=5),
        )

    def measure(solution: Solution) -> dict[str, float]:
        points = solution.model.mesh.points
        radius = np.linalg.norm(points, axis=1)
        after = np.linalg.norm(points + solution.displacement, axis=1)
        inner, outer = np.isclose(radius, RADII[0]), np.isclose(radius, RADII[1])
        return {
            "inner stretch": float(after[inner].mean()) / RADII[0],
            "outer stretch": float(after[outer].mean()) / RADII[1],
        }

    source, reason = inflation_source(shape), "16 cells of second order through the wall, h^3 or better"
    return Benchmark(
        f"mixed-{shape}",
        f"thick rubber {shape} blown up, bulk modulus 1e7 times that of shear, mixed {cell}",
        model,
        measure,
        {
            "inner stretch": Reference(INFLATED, 1e-6, source, reason),
            "outer stretch": Reference(outer_stretch(3 if sphere else 2), 1e-6, source, reason),
        },
    )


BENCHMARKS = (
    _cook("tri6"),
    _cook("quad9"),
    _layer("tri6"),
    _layer("quad9"),
    *(_inflated(shape, "quad9") for shape in ("cylinder", "sphere")),
)
