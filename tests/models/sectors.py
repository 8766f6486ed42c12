"""Two rings, one pressed into the other, as one sector of several and as the whole that the sectors make."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

import abut
from abut.mesh.cell_block import CellBlock
from abut.mesh.make import box, join, rectangle
from abut.types import Array

COUNT = 4
RADII = (1.0, 1.5, 2.0)
SIDES = {2: ("top", "bottom"), 3: ("back", "front")}  # the one that follows first


def sector(
    cell: str, cells: Sequence[int], other: Sequence[int] | None = None, uneven: float = 0.0, count: int = COUNT
) -> abut.Mesh:
    """One of ``count``, from 10 degrees on. cells: radial, around (and along) of the inner ring, other: of the outer one;
    uneven: how far facets around differ, so that no plane mirrors them; in 3D sides then wind, too."""
    make, rest = (rectangle, ()) if len(cells) == 2 else (box, ((0.0, 0.6),))
    parts = zip(("in", "out"), itertools.pairwise(RADII), (cells, other or cells))
    flat = join({name: make(radii, (0.0, 1.0), *rest, tuple(n), cell) for name, radii, n in parts})
    r, s = flat.points[:, 0], flat.points[:, 1]
    s = s + uneven * (np.sin(2.0 * np.pi * s) + 0.5 * (1.0 - np.cos(2.0 * np.pi * s))) / (2.0 * np.pi)
    angle = np.deg2rad(10.0) + 2.0 * np.pi / count * s
    if flat.dim == 3:
        angle += 0.5 * uneven * flat.points[:, 2]
    return replace(flat, points=np.column_stack([r * np.cos(angle), r * np.sin(angle), *flat.points[:, 2:].T]))


def whole(mesh: abut.Mesh, count: int = COUNT) -> tuple[abut.Mesh, Array]:
    """All sectors in one mesh, whose points on common sides are one in each body; and which of its points those of the first
    are, (n_points,)."""
    turn = np.eye(mesh.dim)
    angle = 2.0 * np.pi / count
    turn[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    copies = [mesh.points @ np.linalg.matrix_power(turn, k).T for k in range(count)]
    points, n = np.concatenate(copies), len(mesh.points)
    inner = np.zeros(n)
    first = 0
    for block in mesh.blocks:
        of_in = np.isin(np.arange(first, first := first + len(block.nodes)), mesh.bodies["in"])
        inner[block.nodes[of_in]] = 1.0
    same = cKDTree(np.column_stack([points, 10.0 * np.tile(inner, count)])).query_pairs(1e-7, output_type="ndarray")
    rep = np.arange(count * n)
    for _ in range(3):
        np.minimum.at(rep, same[:, 1], rep[same[:, 0]])
        np.minimum.at(rep, same[:, 0], rep[same[:, 1]])
    kept, number = np.unique(rep, return_inverse=True)
    blocks, cells, first = [], [np.zeros(0, dtype=np.int64) for _ in range(count)], 0
    for block in mesh.blocks:
        blocks.append(CellBlock(block.kind, np.concatenate([number[k * n + block.nodes] for k in range(count)])))
        size = len(block.nodes)
        cells = [np.concatenate([own, first + k * size + np.arange(size)]) for k, own in enumerate(cells)]
        first += count * size
    bodies = {name: np.concatenate([own[of] for own in cells]) for name, of in mesh.bodies.items()}
    surfaces = {
        name: np.concatenate([np.column_stack([own[rows[:, 0]], rows[:, 1]]) for own in cells])
        for name, rows in mesh.surfaces.items()
        if name.split(".")[1] not in SIDES[mesh.dim]
    }
    return abut.Mesh(points[kept], tuple(blocks), bodies, surfaces), number[:n]


@dataclass(frozen=True)
class Both:
    """The same contact solved on a sector and on the whole; same: which points of the whole the sector's are."""

    sector: abut.Solution
    whole: abut.Solution
    same: Array

    def apart(self, field: Callable[[abut.ContactResult], Array]) -> float:
        """The largest difference of a field (n_facets, 9, ...) at the nodes of the sector's contactor, over the largest;
        where facets differ at a node, of the least and of the largest there."""
        here, there = (_at_points(s.contacts[0], field) for s in (self.sector, self.whole))
        largest = max(float(np.abs(values).max()) for values in there.values())
        return max(float(np.abs(here[k] - there[int(self.same[k])]).max()) for k in here) / largest

    @property
    def moved(self) -> float:
        """The same of displacements."""
        one, other = self.sector.displacement, self.whole.displacement
        return float(np.abs(one - other[self.same]).max() / np.abs(other).max())


def _at_points(contact: abut.ContactResult, field: Callable[[abut.ContactResult], Array]) -> dict[int, Array]:
    found: dict[int, list[Array]] = {}
    for nodes, values in zip(contact.contactor.nodes, field(contact)):
        for node, value in zip(nodes.tolist(), values):
            if node >= 0:
                found.setdefault(node, []).append(value)
    return {node: np.array([np.min(values, axis=0), np.max(values, axis=0)]) for node, values in found.items()}


def models(mesh: abut.Mesh, supports: Sequence[abut.Support], contact: abut.Contact, **more: object) -> tuple:
    """Models of the sector and of the whole, and which points of the whole the sector's are."""
    follows, leads = SIDES[mesh.dim]
    added = abut.add_sectors(mesh, [abut.Sector(f"{b}.{follows}", f"{b}.{leads}", COUNT) for b in ("in", "out")])
    every, same = whole(mesh)
    steel = abut.LinearElastic(1000.0, 0.3)
    solids = [abut.Solid("in", steel), abut.Solid("out", steel)]
    given = {"plane": "strain" if mesh.dim == 2 else None, **more}
    return (
        abut.Model(added.mesh, solids, supports, contacts=[contact], equations=added.equations, **given),
        abut.Model(every, solids, supports, contacts=[contact], **given),
        same,
    )


def solved(mesh: abut.Mesh, supports: Sequence[abut.Support], contact: abut.Contact, **more: object) -> Both:
    one, every, same = models(mesh, supports, contact, **more)
    return Both(abut.solve(one), abut.solve(every), same)
