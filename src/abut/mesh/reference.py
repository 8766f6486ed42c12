"""Reference coordinates of the nodes of every cell type."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS


def reference_nodes(kind: str) -> NDArray[np.float64]:
    """Reference coordinates of a cell's nodes, (nodes, dim)."""
    cell = CELLS[kind]
    if cell.dim == 2:
        corners = np.array([[0, 0], [1, 0], [0, 1]]) if cell.corners == 3 else _square()
        middles = 0.5 * (corners + np.roll(corners, -1, axis=0))
        return np.vstack([corners, middles, [[0.0, 0.0]]])[: cell.nodes].astype(float)
    if cell.corners == 4:
        corners = np.vstack([np.zeros(3), np.eye(3)])
        edges = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
    elif cell.corners == 6:
        tri = np.array([[0.0, 0], [1, 0], [0, 1]])
        corners = np.vstack([np.column_stack([tri, np.full(3, z)]) for z in (-1.0, 1.0)])
        edges = [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)]
    else:
        corners = np.vstack([np.column_stack([_square(), np.full(4, z)]) for z in (-1.0, 1.0)])
        edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
    middles = np.array([0.5 * (corners[a] + corners[b]) for a, b in edges])
    faces = np.array([[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1], [0, 0, 0]], dtype=float)
    return np.vstack([corners, middles, faces])[: cell.nodes]


def _square() -> NDArray[np.float64]:
    return np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])
