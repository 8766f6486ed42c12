"""Surfaces for the interface tests: grids of every facet type, with distorted interior nodes and curved edges at will."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.mesh.surface import Surface

FACETS_3D = ("tri3", "tri6", "quad4", "quad8", "quad9")
Map = Callable[[NDArray[np.float64]], NDArray[np.float64]]


def pack(points: NDArray[np.float64], kind: str, nodes: NDArray[np.int64], name: str = "surface") -> Surface:
    """A surface of one facet type."""
    padded = np.full((len(nodes), 9), -1, dtype=np.int32)
    padded[:, : nodes.shape[1]] = nodes
    none = np.full(len(nodes), -1, dtype=np.int64)
    return Surface(points, np.full(len(nodes), CELLS[kind].code, np.uint8), padded, none, none, name)


def grid(
    kind: str, n: tuple[int, int], *, distort: float = 0.0, up: bool = True, bulge: Map | None = None, seed: int = 0
) -> Surface:
    """The unit square z = 0 as n[0] x n[1] quadrilaterals (or twice as many triangles), normal +z or -z (``up``).

    distort: interior corners move by this share of the facet size; edges stay straight, mid nodes in the middle.
    bulge:   map applied to all nodes afterwards (for curved edges or surfaces).
    """
    rng = np.random.default_rng(seed)
    x, y = (np.linspace(0.0, 1.0, m + 1) for m in n)
    corners = np.stack([*(g.ravel() for g in np.meshgrid(x, y, indexing="ij")), np.zeros((n[0] + 1) * (n[1] + 1))], 1)
    inside = ((corners[:, :2] > 1e-9) & (corners[:, :2] < 1.0 - 1e-9)).all(axis=1)
    corners[inside, :2] += distort * rng.uniform(-1, 1, (inside.sum(), 2)) / np.array(n)
    index = np.arange(len(corners)).reshape(n[0] + 1, n[1] + 1)
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1).reshape(-1, 4)
    cell = CELLS[kind]
    facets = quads if cell.corners == 4 else np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    if not up:
        facets = facets[:, ::-1]
    points, nodes = [corners], [facets]
    if cell.degree == 2:
        edges = np.stack([facets, np.roll(facets, -1, axis=1)], axis=-1)
        unique, inverse = np.unique(np.sort(edges.reshape(-1, 2), axis=1), axis=0, return_inverse=True)
        nodes.append(len(corners) + inverse.reshape(facets.shape))
        points.append(corners[unique].mean(axis=1))
        if cell.nodes == 9:
            nodes.append((len(corners) + len(unique) + np.arange(len(facets)))[:, None])
            points.append(corners[facets].mean(axis=1))
    every = np.concatenate(points)
    return pack(every if bulge is None else bulge(every), kind, np.concatenate(nodes, axis=1))
