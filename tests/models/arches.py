"""An arch on two hinges that a punch pushes down, past where it snaps through; a ball of bricks between two plates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

import abut
from abut.mesh import make
from abut.mesh.make.block import grid

SPAN, RISE, THICKNESS, PUNCH = 10.0, 2.0, 0.2, 0.8
FORCE = 30.0  # dead, past the first limit point (about 4) and the second state of rest
PRESSED, ROLLED = 0.6, 0.3  # ways of the upper plate down, and then along
STEEL = abut.LinearElastic(1e4, 0.3)
SOFT = abut.LinearElastic(1e3, 0.3)
Array = NDArray[np.float64]


def _bent(points: Array) -> Array:
    x = (points[:, 0] - 0.5) * SPAN
    return np.stack([x, RISE * np.cos(np.pi * x / SPAN) + points[:, 1] * THICKNESS], axis=1)


def arch(force: float | None = None, way: float = 0.0, steps: int | str = "auto") -> abut.Model:
    """The punch is pushed by a dead force, or (None) moved by a way; down in both."""
    made = grid([np.linspace(0.0, 1.0, 13), np.array([-0.5, 0.5])], "quad8", _bent)
    block = make.rectangle([-PUNCH / 2, PUNCH / 2], [0, 0.4], cells=[4, 2], cell="quad8")
    points = block.points + np.array([0.0, RISE + THICKNESS / 2])
    points[:, 1] += np.where(block.points[:, 1] < 1e-9, 0.35 * points[:, 0] ** 2, 0.0)
    mesh = make.join(
        {"arch": replace(made, bodies={"arch": made.bodies["body"]}), "punch": replace(block, points=points)}
    )
    pushed = [] if force is None else [abut.Traction("punch.top", (0.0, -force / PUNCH))]
    moved = [abut.Support("punch.top", y=-way)] if force is None else []
    return abut.Model(
        mesh, [abut.Solid(name, STEEL) for name in mesh.bodies],
        [abut.Support("arch.left", x=0, y=0), abut.Support("arch.right", x=0, y=0), abut.Support("punch.left", x=0), *moved],
        pushed, [abut.Contact(contactor="punch.bottom", target="arch.top")], plane="strain", kinematics="finite",
        solve=abut.SolveOptions(steps=steps),
    )  # fmt: skip


def ball(cells: int = 2) -> abut.Model:
    """Pressed by one node on each side, and rolled: nothing resists its spin about the line between them."""
    block = make.box((-1, 1), (-1, 1), (-1, 1), cells=(cells, cells, cells))
    size, far = np.abs(block.points).max(axis=1), np.linalg.norm(block.points, axis=1)
    points = block.points * (size / np.maximum(far, 1e-9))[:, None]
    plates = {
        "low": make.box((-1.3, 1.3), (-1.3, 1.3), (-1.5, -1), cells=(5, 5, 1)),
        "up": make.box((-1.3, 1.3), (-1.3, 1.3), (1, 1.5), cells=(5, 5, 1)),
    }
    mesh = make.join({"ball": replace(block, points=points), **plates})
    press, roll = abut.Amplitude(((0, 0), (0.5, 1))), abut.Amplitude(((0.5, 0), (1, 1)))
    return abut.Model(
        mesh, [abut.Solid(name, SOFT) for name in mesh.bodies],
        [
            abut.Support("low.bottom", x=0, y=0, z=0), abut.Support("up.top", y=0),
            abut.Support("up.top", z=-PRESSED, amplitude=press), abut.Support("up.top", x=ROLLED, amplitude=roll),
        ],
        contacts=[abut.Contact(contactor="ball", target="low.top", friction=0.3),
            abut.Contact(contactor="ball", target="up.bottom", friction=0.3)],
        kinematics="finite",
    )  # fmt: skip
