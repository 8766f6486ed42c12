"""Large sliding in 3D: a wire pulled along the groove between two others; force of friction against statics."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.hyperelastic import NeoHooke
from abut.mesh.make import box, join
from abut.mesh.mesh import Mesh
from abut.model import Amplitude, Contact, Model, Solid, Support
from abut.solution import Solution

FRICTION, PRESSED, PULLED = (
    0.2,
    0.05,
    0.8,
)  # coefficient; how far the wire of radius 1 is pressed down, and then pulled along
BORE = 0.4  # radius of the core that does not deform
SLIDING = 0.5  # time from which on all of the wire slides
HEIGHT = np.sqrt(3.0)  # of the upper wire's axis when all three touch
DOWN = Amplitude(((0.0, 0.0), (0.4, 1.0), (1.0, 1.0)))
ALONG = Amplitude(((0.0, 0.0), (0.4, 0.0), (1.0, 1.0)))


def _wire(
    angles: tuple[float, float], centre: tuple[float, float], ends: tuple[float, float], cells: Sequence[int]
) -> Mesh:
    """Part of a wire along z between two angles (degrees). Surfaces: top (round), bottom (bore), and the others of a box."""
    mesh = box((0.0, 1.0), ends, (BORE, 1.0), cells, "hex8")
    share, along, radius = mesh.points.T
    angle = np.radians(angles[0] + (angles[1] - angles[0]) * share)
    across = np.column_stack([centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle)])
    return replace(mesh, points=np.column_stack([across, along]))


def _wires(level: int) -> Model:
    n = 2**level
    parts = {
        "left": _wire((0.0, 60.0), (-1.0, 0.0), (0.0, 3.0), (10 * n, 6 * n, 2 * n)),
        "right": _wire((120.0, 180.0), (1.0, 0.0), (0.0, 3.0), (10 * n, 6 * n, 2 * n)),
        "upper": _wire((200.0, 340.0), (0.0, HEIGHT), (0.3, 1.8), (26 * n, 4 * n, 2 * n)),
    }
    return Model(
        join(parts), [Solid(name, NeoHooke(100.0, 0.3)) for name in parts],
        [
            Support("left.bottom", x=0.0, y=0.0, z=0.0), Support("right.bottom", x=0.0, y=0.0, z=0.0),
            Support("upper.bottom", x=0.0, y=-PRESSED, amplitude=DOWN), Support("upper.bottom", z=PULLED, amplitude=ALONG),
        ],
        contacts=[Contact(contactor="upper.top", target=("left.top", "right.top"), friction=FRICTION)], kinematics="finite",
    )  # fmt: skip


def _forces(solution: Solution) -> Mapping[str, float]:
    last, contact = solution.steps[-1], solution.contacts[0]
    assert contact.friction is not None
    x, y, _ = last.reactions["upper.bottom"]
    pulls = [step.reactions["upper.bottom"] for step in solution.steps if step.factor > SLIDING]
    sizes = [float(np.linalg.norm(force)) for force in contact.body_forces.values()]
    return {
        "pull over pressing force": float(np.mean([force[2] / -force[1] for force in pulls])),
        "force to the side": float(abs(x / y)),
        "forces on both wires": sizes[0] / sizes[1],
        "friction over its limit": contact.friction.force_by_area / contact.friction.force_limit,
        "iterations": float(sum(len(step.iterations) for step in solution.steps)),
    }  # fmt: skip


SLOPE = (HEIGHT - PRESSED) / np.hypot(1.0, HEIGHT - PRESSED)  # cosine of the normals' angle to the pressing force
BENCHMARKS = (
    Benchmark(
        "wires", "a wire pressed between two others and pulled along them, friction 0.2", _wires, _forces,
        {
            "pull over pressing force": Reference(
                FRICTION / SLOPE, 0.04, "statics: friction on both normals between the axes",
                "contact is two facets wide; the wire's end shakes the force by 3 % from facet to facet",
            ),
            "force to the side": Reference(0.0, 1e-6, "symmetry", "the mesh is symmetric"),
            "forces on both wires": Reference(1.0, 1e-6, "symmetry", "the mesh is symmetric"),
            "friction over its limit": Reference(1.0, 1e-8, "Coulomb: all of the contact slides", "Newton's tolerance"),
            "iterations": Reference(
                40.0, 1.75, "what it took when it was written, and half as much again",
                "linear solutions of steps that were kept; two dozen follow slip as it turns from across to along the wires",
            ),
        },
    ),
)  # fmt: skip
