"""Large sliding in 3D: a round die pressed into a slab and drawn along it, with linear and quadratic facets; balance of
forces, Coulomb's law and the iterations it takes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.hyperelastic import NeoHooke
from abut.mesh.make import box, join
from abut.mesh.mesh import Mesh
from abut.model import Amplitude, Contact, Model, Solid, Support
from abut.solution import Solution
from abut.solution.records import Step

FRICTION = 0.3
WIDTH, DEPTH, TURN = 1.0, 0.3, 0.9  # of the slab; how far the die goes down; half the angle of its arc, radians
PRESS = Amplitude(((0.0, 0.0), (0.3, 1.0), (1.0, 1.0)))
SLIDE = Amplitude(((0.0, 0.0), (0.3, 0.0), (1.0, 1.0)))
CLOSE = 1e-5  # what is left of the equations from which on Newton's method is quadratic


def _die(level: int, cell: str) -> Mesh:
    """Half a disc and more, of radius 0.8, just above the slab. Surfaces: bottom (the arc), top."""
    n = 2**level
    mesh = box((-1.0, 1.0), (0.0, 1.0), (0.0, 1.0), (6 * n, 2 * n, 2 * n), cell)
    x, y, z = mesh.points.T
    radius, angle = 0.8 - 0.4 * z, TURN * x
    points = np.column_stack([1.0 + radius * np.sin(angle), 0.2 + 0.6 * y, 1.81 - radius * np.cos(angle)])
    return replace(mesh, points=points)


def model(level: int, cell: str) -> Model:
    """The die just above the slab; ``level`` halves the cells, ``cell`` is their kind."""
    n = 2**level
    slab = box((0.0, 3.0), (0.0, WIDTH), (0.0, 1.0), (9 * n, 3 * n, 2 * n), cell)
    return Model(
        join({"slab": slab, "die": _die(level, cell)}),
        [Solid("slab", NeoHooke(10.0, 0.3)), Solid("die", NeoHooke(100.0, 0.3))],
        [
            Support("slab.bottom", x=0.0, y=0.0, z=0.0), Support("die.top", y=0.0, z=-DEPTH, amplitude=PRESS),
            Support("die.top", x=1.0, amplitude=SLIDE),
        ],
        contacts=[Contact(contactor="die.bottom", target="slab.top", friction=FRICTION)], kinematics="finite",
    )  # fmt: skip


def _measures(solution: Solution) -> Mapping[str, float]:
    touching = [step for step in solution.steps if step.contacts[0].active]
    last, (contact, *_) = touching[-1], touching[-1].contacts
    assert contact.friction is not None
    carried = last.reactions["slab.bottom"]
    size = float(np.linalg.norm(carried))
    return {
        "forces on both sides": max(_unbalanced(step) for step in touching),
        "reactions": float(np.abs(last.reactions["die.top"] + carried).max()) / size,
        "force through the contact": float(np.abs(contact.force - carried).max()) / size,
        "friction over its limit": contact.friction.force_by_area / contact.friction.force_limit,
        "tail of the iterations": float(max(_tail(step) for step in touching)),
        "iterations": float(sum(len(step.iterations) for step in solution.steps)), "steps": float(len(solution.steps)),
    }  # fmt: skip


def _unbalanced(step: Step) -> float:
    """Sum of the forces on contactor and target over the sum of their sizes."""
    on_contactor, other = step.contacts[0].contactor_forces, step.contacts[0].target_forces
    return float(np.abs(on_contactor.sum(axis=0) + other.sum(axis=0)).max() / np.abs(on_contactor).sum())


def _tail(step: Step) -> int:
    """Iterations after the one from which on every status is final and ``CLOSE`` or less is left."""
    rough = [row.changed > 0 or max(row.residual, row.contact_residual) > CLOSE for row in step.iterations]
    return len(rough) - 1 - max((i + 1 for i, one in enumerate(rough) if one), default=0)


TAIL = "after the first below 1e-5 with all statuses final, in the worst step; the constant is some 1e3"
EFFORT = "what it took when it was written, and half as much again"


def _references(iterations: float, steps: float) -> Mapping[str, Reference]:
    rounding = "rounding"
    newton = "balance to the tolerance of Newton's method"
    return {
        "forces on both sides": Reference(0.0, 1e-12, "Newton's third law, theory (G1)", rounding),
        "reactions": Reference(0.0, 1e-8, "equilibrium of both bodies", newton),
        "force through the contact": Reference(0.0, 1e-8, "equilibrium of the slab", newton),
        "friction over its limit": Reference(1.0, 1e-8, "Coulomb: all of the contact slides", newton),
        "tail of the iterations": Reference(1.0, 2.0, "quadratic: 1e-5, 1e-7, 1e-11", TAIL),
        "iterations": Reference(0.75 * iterations, 1.0, EFFORT, "linear solutions"),
        "steps": Reference(0.75 * steps, 1.0, EFFORT, "load steps, found by abut"),
    }  # fmt: skip


BENCHMARKS = tuple(
    Benchmark(
        f"die-drawn-{cell}", f"a round die drawn along a slab in 3D, friction 0.3, {cell}",
        partial(model, cell=cell), _measures, _references(iterations, steps),
    )
    for cell, iterations, steps in (("hex8", 65.0, 18.0), ("tet10", 168.0, 26.0), ("hex20", 150.0, 25.0))
)  # fmt: skip
