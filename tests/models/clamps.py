"""Bodies with two arms that close on each other, and tubes that are flattened, in the plane and extruded."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

import abut
from abut.contact.sides import Names
from abut.mesh.make.block import SOLID_CELLS, grid
from abut.mesh.mesh import Mesh

ARM, RADIUS, THICKNESS, DEPTH = 1.2, 0.4, 0.3, 0.2
NOSE, PLACE, WIDTH = 0.18, 0.9, 0.45  # of the bulge inside of each arm
GAP = 2.0 * (RADIUS - 0.5 * THICKNESS - NOSE)  # between the noses
RUBBER = abut.NeoHooke(young=100.0, poisson=0.3)
Array = NDArray[np.float64]


def bowed(points: Array) -> Array:
    """A strip (share of the length; share of the thickness, inside 1; depth) laid as a C with two arms to the right,
    thicker where they will touch."""
    arc = np.pi * RADIUS
    way = points[:, 0] * (2.0 * ARM + arc)
    angle = np.clip((way - ARM) / RADIUS, 0.0, np.pi)
    straight = np.maximum(np.maximum(way - ARM - arc, ARM - way), 0.0)
    x, y = straight - RADIUS * np.sin(angle), RADIUS * np.cos(angle)
    inward = np.stack([np.sin(angle), -np.cos(angle)], axis=1)
    bulge = NOSE * np.exp(-(((straight - PLACE) / WIDTH) ** 2))
    off = (points[:, 1] - 0.5) * THICKNESS + bulge * points[:, 1]
    return np.column_stack([np.stack([x, y], axis=1) + off[:, None] * inward, points[:, 2:]])


def clamp(
    cell: str, closing: float = 0.15, sides: tuple[Names, Names] = ("body", "body"), cells: tuple[int, int] = (24, 1),
    **contact: Any,
) -> abut.Model:
    """The arms are pressed together where they are outside, the upper one moved along a little as well; in 3D between
    two planes, as in plane strain."""
    solid = cell in SOLID_CELLS
    lines = [np.linspace(0.0, 1.0, cells[0] + 1), np.linspace(0.0, 1.0, cells[1] + 1)]
    made = grid([*lines, np.array([0.0, DEPTH])] if solid else lines, cell, bowed)
    inside, outside = ("back", "front") if solid else ("top", "bottom")
    mesh = replace(made, surfaces={
        **made.surfaces,
        "lower": _where(made, inside, lambda x: x[:, 1] < 0.0), "upper": _where(made, inside, lambda x: x[:, 1] > 0.0),
        "below": _where(made, outside, lambda x: (x[:, 1] < 0.0) & (x[:, 0] > 0.5 * ARM)),
        "above": _where(made, outside, lambda x: (x[:, 1] > 0.0) & (x[:, 0] > 0.5 * ARM)),
    })  # fmt: skip
    between = [abut.Support("bottom", z=0.0), abut.Support("top", z=0.0)] if solid else []
    return abut.Model(
        mesh, [abut.Solid("body", RUBBER)],
        [abut.Support("below", x=0.0, y=0.0), abut.Support("above", x=0.03, y=-GAP - closing), *between],
        contacts=[abut.Contact(*sides, name="jaws", **contact)], plane=None if solid else "strain", kinematics="finite",
    )  # fmt: skip


def _where(mesh: Mesh, surface: str, chosen: Any) -> NDArray[np.int64]:
    """Facets of a surface all of whose points are chosen by their place (n, dim)."""
    rows = mesh.surfaces[surface]
    return rows[[bool(chosen(mesh.points[nodes[nodes >= 0]]).all()) for nodes in mesh.facets(rows).nodes]]
