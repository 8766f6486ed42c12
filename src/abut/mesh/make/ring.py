"""A sector of a ring: polar grids for fits, pins and holes in the plane."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from abut import checks
from abut.errors import InputError
from abut.mesh.make.block import axes, grid
from abut.mesh.mesh import Mesh

WIDEST = 150.0  # degrees; a cell with straight edges has no area left at 180


def ring(
    radii: Sequence[float] = (1.0, 2.0),
    angles: Sequence[float] = (0.0, 90.0),
    centre: Sequence[float] = (0.0, 0.0),
    cells: Sequence[int] = (4, 8),
    cell: str = "quad8",
    fine: Mapping[str, Sequence[float]] | None = None,
    growth: float = 1.25,
) -> Mesh:
    """The sector of a ring between two ``radii`` and two ``angles`` (degrees from the x axis, less than a whole turn),
    with ``cells`` = (through the wall, around). All nodes lie on circles. Surfaces inner, outer, start, end.

    fine: zones like {x = [1, 1.1], y = [0, 10]} (x: radius, y: angle) that get the cells; outside they grow by ``growth``.
    Raises InputError for radii that are not positive and increasing, angles that do not increase, or too few cells around.
    """
    low, high = checks.array(radii, "ring: radii", shape=(2,))
    first, last = checks.array(angles, "ring: angles", shape=(2,))
    if not 0.0 < low < high:
        raise InputError(f"ring: radii: expected 0 < inner < outer, got {list(radii)}")
    if not first < last < first + 360.0:
        raise InputError(f"ring: angles: expected start < end < start + 360 degrees, got {list(angles)}")
    lines = axes((radii, angles), cells, fine, growth, "ring")
    widest = np.diff(lines[1]).max()
    if widest > WIDEST:
        raise InputError(
            f"ring: cells: one spans {widest:g} degrees; give more around, so that none spans over {WIDEST:g}"
        )
    mesh = grid(lines, cell)
    r, turn = mesh.points[:, 0], np.deg2rad(mesh.points[:, 1])
    points = np.column_stack([r * np.cos(turn), r * np.sin(turn)]) + checks.array(centre, "ring: centre", shape=(2,))
    names = {"inner": "left", "outer": "right", "start": "bottom", "end": "top"}
    return replace(mesh, points=points, surfaces={new: mesh.surfaces[old] for new, old in names.items()})
