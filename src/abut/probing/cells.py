"""Which cell a point lies in, and the values of its shape functions there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from abut._core import shape_functions
from abut.cells import CELLS
from abut.mesh.cell_block import CellBlock
from abut.mesh.mesh import Mesh
from abut.probing.inverse import nearest

INSIDE = 1e-9  # distance over the cell's size up to which a point lies in a cell: rounding of its coordinates
NEAR = 1e-3  # and up to which one outside is taken for one on the surface: coordinates are typed with few digits
BULGE = 0.3  # how far a curved cell may reach beyond the box of its nodes, over its size
FEW = 4  # points that are compared with all boxes left


@dataclass(frozen=True)
class Inside:
    """Points in cells. weights: (n, n_points of the mesh) values of the shape functions, CSR, a zero row for points that
    lie outside all cells; bodies: of each point the body that is read, then others that it lies in as well, none for
    points outside."""

    weights: csr_matrix
    bodies: tuple[tuple[str, ...], ...]

    @property
    def outside(self) -> NDArray[np.int64]:
        """Numbers of the points that lie in no cell."""
        return np.array([i for i, found in enumerate(self.bodies) if not found], dtype=np.int64)


@dataclass(frozen=True)
class Boxes:
    """Cells of each block of a mesh in boxes: low, high (n_cells, dim) corners that no curved cell reaches beyond, size
    (n_cells,) the longest edge of the box of its nodes."""

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    size: NDArray[np.float64]


def boxes(mesh: Mesh) -> tuple[Boxes, ...]:
    """One record for each block of the mesh."""
    result = []
    for block in mesh.blocks:
        low, high = (mesh.points[block.nodes[:, 0]] for _ in range(2))
        for nodes in block.nodes.T[1:]:  # not all at once: the coordinates of every node of every cell are many
            low, high = np.minimum(low, mesh.points[nodes]), np.maximum(high, mesh.points[nodes])
        size = (high - low).max(axis=1)
        more = ((BULGE if CELLS[block.kind].degree > 1 else 0.0) + 2.0 * NEAR) * size[:, None]
        result.append(Boxes(low - more, high + more, size))
    return tuple(result)


def locate(mesh: Mesh, around: Sequence[Boxes], points: NDArray[np.float64], body: str | None = None) -> Inside:
    """Find points (n, dim) in the cells of all bodies, or of ``body``; around: ``boxes(mesh)``. A point in several bodies is
    read in the first of them, in the order of the mesh; one outside by less than ``NEAR`` cell sizes is read at the
    surface nearby."""
    names = list(mesh.bodies) if body is None else [body]
    owner = np.full(mesh.n_cells, -1)
    for number in reversed(range(len(names))):
        owner[mesh.bodies[names[number]]] = number
    found = [
        _in_block(mesh, block, candidates, owner[first : first + len(block.nodes)], points)
        for block, candidates, first in zip(mesh.blocks, around, mesh.starts)
    ]
    which = np.concatenate([f.point for f in found])
    away = np.concatenate([f.away for f in found])
    who = np.concatenate([f.body for f in found])
    order = np.lexsort((np.arange(len(which)), who, np.where(away <= INSIDE, 0.0, away), which))
    best = order[np.unique(which[order], return_index=True)[1]]
    bodies: list[tuple[str, ...]] = [()] * len(points)
    for k in best:
        also = sorted(set(who[(which == which[k]) & (away <= INSIDE)].tolist()) - {int(who[k])})
        bodies[int(which[k])] = tuple(names[number] for number in (int(who[k]), *also))
    parts, first = [], 0
    for block, f in zip(mesh.blocks, found):
        candidates = best[(best >= first) & (best < first + len(f.point))] - first
        first += len(f.point)
        shapes, _ = shape_functions(CELLS[block.kind].code, np.ascontiguousarray(f.xi[candidates]))
        entries = (
            shapes.ravel(),
            (np.repeat(f.point[candidates], shapes.shape[1]), block.nodes[f.cell[candidates]].ravel()),
        )
        parts.append(csr_matrix(entries, shape=(len(points), len(mesh.points))))
    return Inside(sum(parts[1:], parts[0]), tuple(bodies))


@dataclass(frozen=True)
class _Found:
    """Pairs of a point and a cell of one block near it: numbers of both and of the cell's body, distance over the cell's
    size, reference coordinates."""

    point: NDArray[np.int64]
    cell: NDArray[np.int64]
    body: NDArray[np.int64]
    away: NDArray[np.float64]
    xi: NDArray[np.float64]


def _in_block(
    mesh: Mesh, block: CellBlock, around: Boxes, owner: NDArray[np.int64], points: NDArray[np.float64]
) -> _Found:
    cells, point = pairs(around.low, around.high, points)
    wanted = owner[cells] >= 0
    cells, point = cells[wanted], point[wanted]
    xi, miss = nearest(block.kind, mesh.points[block.nodes[cells]], points[point])
    away = np.linalg.norm(miss, axis=1) / around.size[cells]
    near = away <= NEAR
    return _Found(point[near], cells[near], owner[cells[near]], away[near], xi[near])


def pairs(
    low: NDArray[np.float64], high: NDArray[np.float64], points: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Numbers of boxes, low to high (n, dim), and of points (m, dim) that lie in them, each pair once. Points are halved
    along their longest extent until few are left, and boxes with them."""
    box: list[NDArray[np.int64]] = [np.empty(0, np.int64)]
    inside: list[NDArray[np.int64]] = [np.empty(0, np.int64)]
    waiting = [(np.arange(len(low)), np.arange(len(points)))]
    while waiting:
        near, bodies = waiting.pop()
        x = points[bodies]
        near = near[((low[near] <= x.max(axis=0)) & (high[near] >= x.min(axis=0))).all(axis=1)]
        if not len(near):
            continue
        if len(bodies) <= FEW:
            hit, point = np.nonzero(((low[near, None] <= x) & (x <= high[near, None])).all(axis=2))
            box.append(near[hit])
            inside.append(bodies[point])
        else:
            order = bodies[np.argsort(x[:, np.argmax(np.ptp(x, axis=0))], kind="stable")]
            waiting += [(near, half) for half in np.array_split(order, 2)]
    return np.concatenate(box), np.concatenate(inside)
