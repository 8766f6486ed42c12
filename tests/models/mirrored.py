"""A mesh together with its mirror image beyond a plane of symmetry."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS, CellType
from abut.mesh.cell_block import CellBlock
from abut.mesh.mesh import Mesh

ON_PLANE = 1e-9  # of the mesh's size
# Corners of a cell turned inside out, as mirroring does, so that it is one again.
CORNERS = {3: [1, 0, 2], 4: [1, 0, 3, 2], 6: [1, 0, 2, 4, 3, 5], 8: [1, 0, 3, 2, 5, 4, 7, 6]}


def whole(half: Mesh, axis: int) -> Mesh:
    """``half`` and its image beyond the plane through the origin square to an axis, nodes on the plane being common. Points
    and cells of the half keep their numbers; surfaces in the plane are left out, others go on beyond it."""
    n, size = len(half.points), np.ptp(half.points)
    on = np.abs(half.points[:, axis]) < ON_PLANE * size
    image = np.where(on, np.arange(n), n - 1 + np.cumsum(~on))
    points = half.points.copy()
    points[on, axis] = 0.0
    sign = np.ones(half.dim)
    sign[axis] = -1.0
    blocks = tuple(
        CellBlock(b.kind, np.concatenate([b.nodes, image[b.nodes[:, _nodes(CELLS[b.kind])]]]).astype(np.int32))
        for b in half.blocks
    )
    (block,) = half.blocks
    cells, facet = len(block.nodes), _facets(CELLS[block.kind])
    surfaces = {}
    for name, rows in half.surfaces.items():
        if not on[half.nodes_of(name)].all():
            surfaces[name] = np.vstack([rows, np.column_stack([rows[:, 0] + cells, facet[rows[:, 1]]])])
    bodies = {name: np.concatenate([own, own + cells]) for name, own in half.bodies.items()}
    sets = {name: np.union1d(nodes, image[nodes]) for name, nodes in half.node_sets.items()}
    return replace(
        half,
        points=np.vstack([points, points[~on] * sign]),
        blocks=blocks,
        bodies=bodies,
        surfaces=surfaces,
        node_sets=sets,
    )


def _nodes(cell: CellType) -> NDArray[np.int64]:
    """Which node of a cell each node of its image is."""
    corners = CORNERS[3 if cell.name.startswith("tri") else cell.corners]
    if cell.name.startswith("tet"):
        corners = [1, 0, 2, 3]
    places = _places(cell)
    by_corners = {frozenset(place): node for node, place in places.items()}
    return np.array([by_corners[frozenset(corners[c] for c in places[node])] for node in range(cell.nodes)])


def _facets(cell: CellType) -> NDArray[np.int64]:
    """Which facet of the image each facet of a cell becomes."""
    image = _nodes(cell)
    sets = [frozenset(nodes) for _, nodes in cell.facets]
    return np.array([sets.index(frozenset(int(np.flatnonzero(image == k)[0]) for k in own)) for own in sets])


def _places(cell: CellType) -> dict[int, tuple[int, ...]]:
    """The corners between which each node lies."""
    places = {node: (node,) for node in range(cell.corners)}
    places[cell.nodes - 1] = places.get(cell.nodes - 1, tuple(range(cell.corners)))  # what no facet has: the middle
    for kind, nodes in cell.facets:
        corners = nodes[: CELLS[kind].corners]
        for i, node in enumerate(nodes[len(corners) :]):
            middle = CELLS[kind].dim == 2 and i == len(corners)
            places[node] = corners if middle else (corners[i], corners[(i + 1) % len(corners)])
    return places
