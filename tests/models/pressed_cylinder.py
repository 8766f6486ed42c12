"""A stiff cylinder pressed into a soft block, 10^4 to 1, with friction: points come to stick and to slip over and over."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import abut
from abut.mesh import make


def pressed_cylinder(
    cells: tuple[int, int, int] = (8, 3, 2), around: int = 6, depth: float = 0.6, friction: float = 0.5
) -> abut.Model:
    """cells: of the block along, across and up; around: of the lower half of the cylinder."""
    block = make.box([-2.0, 1.0], [0.0, 1.0], [0.0, 1.0], cells=cells)
    half = make.box([0.5, 1.0], [-0.1, 1.1], [np.pi, 2.0 * np.pi], cells=(1, cells[1] - 1, around))
    radius, across, angle = half.points.T
    half = replace(half, points=np.column_stack([radius * np.cos(angle) - 0.5, across, radius * np.sin(angle) + 2.0]))
    return abut.Model(
        make.join({"block": block, "cylinder": half}),
        [abut.Solid("block", abut.NeoHooke(1.0, 0.45)), abut.Solid("cylinder", abut.NeoHooke(1e4, 0.0))],
        [
            abut.Support("block.bottom", x=0, y=0, z=0), abut.Support("block.front", y=0),
            abut.Support("cylinder.left", x=0, y=0, z=-depth),
        ],
        contacts=[abut.Contact(contactor="block.top", target="cylinder.right", friction=friction)], kinematics="finite",
    )  # fmt: skip
