"""Thin things pressed on each other at large displacements: leaves of a spring, a rubber pad under a rough plate."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise

import numpy as np

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.materials.hyperelastic import NeoHooke
from abut.mesh.make import join, rectangle
from abut.model import Contact, Model, Solid, Support
from abut.solution import Solution

YOUNG, THICKNESS, LENGTHS = 206e9, 0.01, (0.6, 0.45, 0.3)  # Pa, m; of the leaves, from the top
DOWN = 0.02  # how far the tip of the longest one is moved, m
PAD_YOUNG, PAD_POISSON, HALF, HEIGHT, PRESSED = 1.0, 0.499, 1.0, 0.5, 0.01


def leaves(contactor: str) -> Model:
    """Three leaves on each other, clamped at their left ends; a support moves the tip of the longest. contactor: "upper" or
    "lower", of either contact."""
    names = [f"leaf{i}" for i in range(len(LENGTHS))]
    parts = {
        name: rectangle([0, length], [-(i + 1) * THICKNESS, -i * THICKNESS], (round(40 * length), 2), "quad8")
        for i, (name, length) in enumerate(zip(names, LENGTHS))
    }
    mesh = join(parts)
    tip = np.flatnonzero(np.isclose(mesh.points, (LENGTHS[0], -0.5 * THICKNESS)).all(axis=1))
    sides = [(f"{above}.bottom", f"{below}.top") for above, below in pairwise(names)]
    return Model(
        replace(mesh, node_sets={**mesh.node_sets, "tip": tip}),
        [Solid(name, LinearElastic(YOUNG, 0.3)) for name in names],
        [*(Support(f"{name}.left", x=0, y=0) for name in names), Support("tip", y=-DOWN)],
        contacts=[
            Contact(contactor=a, target=b) if contactor == "upper" else Contact(contactor=b, target=a) for a, b in sides
        ],
        plane="stress", kinematics="finite",
    )  # fmt: skip


def leaf_force() -> float:
    """At the tip by beam theory: leaves touch at the ends of the shorter ones alone, and are as far down there."""
    stiffness = YOUNG * THICKNESS**3 / 12.0

    def down(x: float, load: float) -> float:
        """Of a cantilever at x under a unit load elsewhere."""
        near, far = min(x, load), max(x, load)
        return near * near * (3.0 * far - near) / (6.0 * stiffness)

    first, second, third = LENGTHS
    alike = np.array(
        [
            [down(first, first), -down(first, second), 0.0],
            [down(second, first), -2.0 * down(second, second), down(second, third)],
            [0.0, down(third, second), -2.0 * down(third, third)],
        ]
    )
    return float(np.linalg.solve(alike, [DOWN, 0.0, 0.0])[0])


def rough_pad() -> Model:
    """A flat pad of rubber on a base that holds it, under a plate with friction 1, which goes down."""
    parts = {
        "pad": rectangle([-HALF, HALF], [0, HEIGHT], (48, 12), "quad8"),
        "plate": rectangle([-2 * HALF, 2 * HALF], [HEIGHT, HEIGHT + 0.3], (36, 6), "quad8"),
    }
    return Model(
        join(parts),
        [Solid("pad", NeoHooke(PAD_YOUNG, PAD_POISSON)), Solid("plate", NeoHooke(1e4, 0.3))],
        [Support("pad.bottom", x=0, y=0), Support("plate.top", x=0, y=-PRESSED)],
        contacts=[Contact(contactor="plate", target="pad", friction=1.0)],
        plane="strain", kinematics="finite",
    )  # fmt: skip


def bonded_force() -> float:
    """Of a bonded pad by Gent and Lindley, with what its volume gives: 1 / E_a = 1 / (4/3 E (1 + S^2)) + 1 / K."""
    shape = HALF / HEIGHT  # loaded over free area: width over twice the height
    bonded = 4.0 / 3.0 * PAD_YOUNG * (1.0 + shape**2)
    bulk = PAD_YOUNG / (3.0 * (1.0 - 2.0 * PAD_POISSON))
    return PRESSED / HEIGHT * 2.0 * HALF / (1.0 / bonded + 1.0 / bulk)


def _force(solution: Solution, support: str) -> Mapping[str, float]:
    return {"force": abs(float(solution.steps[-1].reactions[support][1]))}


def _leaves(contactor: str) -> Benchmark:
    return Benchmark(
        f"leaf-stack-{contactor}",
        f"three leaves bent by a support at the tip of the longest, contactor the {contactor} of two",
        lambda level: leaves(contactor),
        lambda solution: _force(solution, "tip"),
        {
            "force": Reference(
                leaf_force(), 0.02, "beam theory, leaves touching at the ends of the shorter ones",
                "a force at an end is spread over half a facet, 0.012 of 0.45",
            )
        },
    )  # fmt: skip


BENCHMARKS = (
    _leaves("upper"),
    _leaves("lower"),
    Benchmark(
        "rough-pad",
        "a rubber pad with Poisson's ratio 0.499 under a rough plate",
        lambda level: rough_pad(),
        lambda solution: _force(solution, "plate.top"),
        {
            "force": Reference(
                bonded_force(),
                0.035,
                "bonded pads: Gent and Lindley 1959",
                "its parabola of pressures is 2.2 % below what fine cells make of a bonded pad, these cells 0.5 % above",
            )
        },
    ),
)
