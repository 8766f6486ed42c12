"""Rigid punches on an elastic half space (axisymmetric), and two bars that close a gap when heated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from abut.benchmarks.measures import contact_points
from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import join, rectangle
from abut.mesh.mesh import Mesh
from abut.model import Contact, Model, Solid, Support
from abut.solution import Solution

YOUNG, POISSON = 1.0, 0.3
PLANE_STRAIN = YOUNG / (1.0 - POISSON**2)  # E* against a rigid punch
DEPTH = 1e-3
FAR = 200.0  # the half space is a cylinder of this radius and height, held below
SLOPE = 2e-3 / np.pi  # of the cone: its contact radius is (2 / pi) depth / slope = 1
SPACE_REASON = "a cylinder of radius and height 200 a for the half space is stiffer by about a / 200"
SNEDDON = "Sneddon 1965"


def _punch(mesh: Mesh, cells: int) -> Model:
    """A punch pushed into a half space whose mesh is even up to a radius of 1.25."""
    space = rectangle(
        (0.0, FAR), (-FAR, 0.0), (5 * cells // 4, cells), "quad8", {"x": [0.0, 1.25], "y": [-1.0, 0.0]}, 1.3
    )
    joined = join({"punch": mesh, "space": space})
    joined = replace(joined, node_sets={"punch": joined.nodes_of("punch")})
    return Model(
        joined,
        [Solid(body, LinearElastic(YOUNG, POISSON)) for body in ("punch", "space")],
        [Support("punch", x=0, y=-DEPTH), Support("space.bottom", x=0, y=0)],
        contacts=[Contact("space.top", "punch.bottom")],
        plane="axisymmetric",
    )


def _flat(level: int) -> Model:
    return _punch(rectangle((0.0, 1.0), (0.0, 0.5), (1, 1)), 24 * 2**level)


def _flat_measure(solution: Solution) -> dict[str, float]:
    contact = solution.contacts[0]
    x, p = contact_points(contact)
    r = x[:, 0]
    exact = PLANE_STRAIN * DEPTH / (np.pi * np.sqrt(np.maximum(1.0 - r**2, 1e-9)))
    return {
        "force": -float(contact.force[1]),
        "area": contact.area,
        "pressure": float(np.abs(p / exact - 1.0)[r < 0.8].max()),
    }


def _cone(level: int) -> Model:
    mesh = rectangle((0.0, 2.0), (0.0, 0.5), (2, 1), "quad4")
    points = mesh.points + np.column_stack([np.zeros(len(mesh.points)), SLOPE * mesh.points[:, 0]])
    return _punch(replace(mesh, points=points), 32 * 2**level)


def _cone_measure(solution: Solution) -> dict[str, float]:
    contact = solution.contacts[0]
    x, p = contact_points(contact)
    r = x[:, 0]
    ring = (r > 0.2) & (r < 0.8)
    exact = 0.5 * PLANE_STRAIN * SLOPE * np.arccosh(1.0 / np.clip(r, 1e-3, 1.0))
    return {
        "force": -float(contact.force[1]),
        "radius": float(np.sqrt(contact.area / np.pi)),
        "pressure": float(np.abs(p - exact)[ring].max() / exact[ring].max()),
    }


LENGTH, GAP, HEAT, EXPANSION = 1.0, 1e-3, 100.0, 1e-5


def _bars(level: int) -> Model:
    n = 2 * 2**level
    parts = {
        "left": rectangle((0.0, LENGTH), (0.0, 0.2), (4 * n, n), "quad4"),
        "right": rectangle((LENGTH + GAP, 2 * LENGTH + GAP), (0.0, 0.2), (3 * n, n + 1), "quad4"),
    }
    material = LinearElastic(YOUNG, 0.0, expansion=EXPANSION)
    return Model(
        join(parts),
        [Solid(body, material, HEAT) for body in parts],
        [
            Support("left.left", x=0),
            Support("right.right", x=0),
            Support("left.bottom", y=0),
            Support("right.bottom", y=0),
        ],
        contacts=[Contact("left.right", "right.left")],
        plane="stress",
    )


def _bars_measure(solution: Solution) -> dict[str, float]:
    _, p = contact_points(solution.contacts[0])
    exact = YOUNG * (EXPANSION * HEAT - GAP / (2.0 * LENGTH))
    return {"pressure": float(np.abs(p / exact - 1.0).max())}


BENCHMARKS = (
    Benchmark(
        "punch-flat",
        "flat rigid punch on a half space, axisymmetric",
        _flat,
        _flat_measure,
        {
            "force": Reference(2.0 * PLANE_STRAIN * DEPTH, 0.015, f"{SNEDDON}: F = 2 E* a d", SPACE_REASON),
            "area": Reference(np.pi, 1e-9, "the punch's: its edge lies between facets", "rounding only"),
            "pressure": Reference(
                0.0,
                0.03,
                f"{SNEDDON}: p = F / (2 pi a^2 sqrt(1 - r^2 / a^2))",
                f"inside 0.8 a, relative; {SPACE_REASON}",
            ),
        },
    ),
    Benchmark(
        "punch-cone",
        "rigid cone on a half space, axisymmetric",
        _cone,
        _cone_measure,
        {
            "force": Reference(
                0.5 * np.pi * PLANE_STRAIN * SLOPE, 0.02, f"{SNEDDON}: F = pi a^2 E* tan(b) / 2", SPACE_REASON
            ),
            "radius": Reference(1.0, 0.01, f"{SNEDDON}: d = pi a tan(b) / 2", f"a fifth of a facet; {SPACE_REASON}"),
            "pressure": Reference(
                0.0,
                0.03,
                f"{SNEDDON}: p = E* tan(b) arccosh(a / r) / 2",
                "between 0.2 a and 0.8 a, over the largest there",
            ),
        },
    ),
    Benchmark(
        "bars-heated",
        "two heated bars close a gap",
        _bars,
        _bars_measure,
        {
            "pressure": Reference(
                0.0,
                1e-10,
                "statics and thermal strain: p = E (alpha T - g / 2 L)",
                "rounding only: the field is linear",
            )
        },
    ),
)
