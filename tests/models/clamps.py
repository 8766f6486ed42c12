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
from abut.solution import Solution

ARM, RADIUS, THICKNESS, DEPTH = 1.2, 0.4, 0.3, 0.2
NOSE, PLACE, WIDTH = 0.18, 0.9, 0.45  # of the bulge inside of each arm
GAP = 2.0 * (RADIUS - 0.5 * THICKNESS - NOSE)  # between the noses
OUTER, INNER = 1.0, 0.75  # radii of the tube
WHOLE, NAMED = ("body", "body"), ("lower", "upper")  # what clamp and tube may be in contact by
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
    cell: str,
    closing: float = 0.15,
    sides: tuple[Names, Names] = ("body", "body"),
    cells: tuple[int, int] = (24, 1),
    **contact: Any,
) -> abut.Model:
    """The arms are pressed together where they are outside, the upper one moved along a little as well; in 3D between
    two planes, as in plane strain."""
    solid = cell in SOLID_CELLS
    mesh = _jaws(cell, cells, [0.0, DEPTH] if solid else None)
    between = [abut.Support("bottom", z=0.0), abut.Support("top", z=0.0)] if solid else []
    return abut.Model(
        mesh, [abut.Solid("body", RUBBER)],
        [abut.Support("below", x=0.0, y=0.0), abut.Support("above", x=0.03, y=-GAP - closing), *between],
        contacts=[abut.Contact(contactor=sides[0], target=sides[1], name="jaws", **contact)],
        plane=None if solid else "strain", kinematics="finite",
    )  # fmt: skip


def wrung(cell: str, sides: tuple[Names, Names] = ("body", "body"), **contact: Any) -> abut.Model:
    """The clamp in space, free in its depth: closed, and then its upper arm is pushed across and turned about the way in
    which it closed."""
    first = abut.Amplitude(((0.0, 0.0), (0.5, 1.0), (1.0, 1.0)))
    then = abut.Amplitude(((0.0, 0.0), (0.5, 0.0), (1.0, 1.0)))
    return abut.Model(
        _jaws(cell, (16, 1), [0.0, 0.25, 0.5]), [abut.Solid("body", RUBBER)],
        [
            abut.Support("below", x=0.0, y=0.0, z=0.0), abut.Support("above", y=-GAP - 0.1, amplitude=first),
            abut.Support("above", x=lambda p: 0.2 * (p[:, 2] - 0.25), amplitude=then),
            abut.Support("above", z=lambda p: 0.12 - 0.2 * (p[:, 0] - PLACE), amplitude=then),
        ],
        contacts=[abut.Contact(contactor=sides[0], target=sides[1], name="jaws", **contact)], kinematics="finite",
        solve=abut.SolveOptions(times=tuple(np.linspace(0.125, 1.0, 8))),
    )  # fmt: skip


def _jaws(cell: str, cells: tuple[int, int], depth: list[float] | None) -> Mesh:
    """Of a strip with so many cells along and through it; depth: of the layers of solid cells."""
    lines = [np.linspace(0.0, 1.0, n + 1) for n in cells]
    made = grid(lines if depth is None else [*lines, np.array(depth)], cell, bowed)
    inside, outside = ("top", "bottom") if depth is None else ("back", "front")
    return replace(made, surfaces={
        **made.surfaces,
        "lower": _where(made, inside, lambda x: x[:, 1] < 0.0), "upper": _where(made, inside, lambda x: x[:, 1] > 0.0),
        "below": _where(made, outside, lambda x: (x[:, 1] < 0.0) & (x[:, 0] > 0.5 * ARM)),
        "above": _where(made, outside, lambda x: (x[:, 1] > 0.0) & (x[:, 0] > 0.5 * ARM)),
    })  # fmt: skip


def _where(mesh: Mesh, surface: str, chosen: Any) -> NDArray[np.int64]:
    """Facets of a surface all of whose points are chosen by their place (n, dim)."""
    rows = mesh.surfaces[surface]
    return rows[[bool(chosen(mesh.points[nodes[nodes >= 0]]).all()) for nodes in mesh.facets(rows).nodes]]


def tube(
    cell: str,
    closing: float = 0.1,
    sides: tuple[Names, Names] = ("body", "body"),
    cells: int = 24,
    **contact: Any,
) -> abut.Model:
    """A thick tube, pressed together where it is outside at the top and the bottom until its inside touches itself."""
    solid = cell in SOLID_CELLS
    lines = [np.linspace(0.0, 1.0, cells + 1), np.array([0.0, 1.0])]
    made = _joined(grid([*lines, np.array([0.0, DEPTH])] if solid else lines, cell, _round))
    inside, outside = ("back", "front") if solid else ("top", "bottom")
    width = 0.3 * OUTER
    mesh = replace(made, surfaces={
        "upper": _where(made, inside, lambda x: x[:, 1] > -1e-9), "lower": _where(made, inside, lambda x: x[:, 1] < 1e-9),
        "below": _where(made, outside, lambda x: (x[:, 1] < 0.0) & (np.abs(x[:, 0]) < width)),
        "above": _where(made, outside, lambda x: (x[:, 1] > 0.0) & (np.abs(x[:, 0]) < width)),
        **{name: made.surfaces[name] for name in (("bottom", "top") if solid else ())},
    })  # fmt: skip
    between = [abut.Support("bottom", z=0.0), abut.Support("top", z=0.0)] if solid else []
    middle = [abut.Support("below", x=0.0, y=0.0), abut.Support("above", x=0.0, y=-2.0 * INNER - closing)]
    return abut.Model(
        mesh, [abut.Solid("body", RUBBER)], [*middle, *between],
        contacts=[abut.Contact(contactor=sides[0], target=sides[1], name="inside", **contact)],
        plane=None if solid else "strain", kinematics="finite",
    )  # fmt: skip


def _round(points: Array) -> Array:
    angle, radius = 2.0 * np.pi * points[:, 0], OUTER - (OUTER - INNER) * points[:, 1]
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), points[:, 2:]])


def _joined(mesh: Mesh) -> Mesh:
    """With one point where several lie at a place."""
    _, first, number = np.unique(np.round(mesh.points, 9), axis=0, return_index=True, return_inverse=True)
    blocks = tuple(replace(b, nodes=number.ravel()[b.nodes].astype(np.int32)) for b in mesh.blocks)
    return replace(mesh, points=mesh.points[first], blocks=blocks)


def balanced(solution: Solution) -> None:
    """Both sides' forces, and their moments about the origin where the points are now, add up to none."""
    pair = solution.contacts[0]
    now = solution.model.mesh.points + solution.displacement
    sides = (pair.contactor.node_ids, pair.contactor_forces), (pair.target.node_ids, pair.target_forces)
    size = np.abs(pair.contactor_forces).sum()
    linear = sum(forces.sum(axis=0) for _, forces in sides)
    turn = sum(np.sum(cross(now[ids], forces), axis=0) for ids, forces in sides)
    assert size > 0.0
    assert np.abs(linear).max() < 1e-13 * size
    assert np.abs(turn).max() < 1e-12 * size


def cross(x: Array, force: Array) -> Array:
    if x.shape[1] == 3:
        return np.cross(x, force)
    return x[:, 0] * force[:, 1] - x[:, 1] * force[:, 0]
