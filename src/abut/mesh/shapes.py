"""How good cells are by their corners: scaled Jacobian, ratio of edges."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.mesh.integrals import chunks
from abut.mesh.mesh import Mesh

CORNERS = {  # at each corner the ends of its edges, right-handed
    ("tri", 3): ((1, 2), (2, 0), (0, 1)),
    ("quad", 4): ((1, 3), (2, 0), (3, 1), (0, 2)),
    ("tet", 4): ((1, 2, 3), (2, 0, 3), (0, 1, 3), (0, 2, 1)),
    ("hex", 8): ((1, 3, 4), (2, 0, 5), (3, 1, 6), (0, 2, 7), (7, 5, 0), (4, 6, 1), (5, 7, 2), (6, 4, 3)),
    ("wedge", 6): ((1, 2, 3), (2, 0, 4), (0, 1, 5), (5, 4, 0), (3, 5, 1), (4, 3, 2)),
}
BEST = {"tri": np.sqrt(0.75), "quad": 1.0, "tet": np.sqrt(0.5), "hex": 1.0, "wedge": np.sqrt(0.75)}


def ratios(mesh: Mesh) -> NDArray[np.float64]:
    """Longest over shortest edge of each cell."""
    result = np.empty(mesh.n_cells)
    for kind, nodes, cells in chunks(mesh):
        result[cells] = cell_shapes(kind, mesh.points[nodes[:, : CELLS[kind].corners]])[1]
    return result


def cell_shapes(kind: str, x: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Smallest scaled Jacobian over the corners and ratio of edges of cells with corners x (n, corners, dim)."""
    name = next(shape for shape, _ in CORNERS if kind.startswith(shape))
    smallest = np.full(len(x), np.inf)
    short, long = np.full(len(x), np.inf), np.zeros(len(x))
    for corner, ends in enumerate(CORNERS[name, x.shape[1]]):
        edges = x[:, list(ends)] - x[:, [corner]]
        lengths = np.linalg.norm(edges, axis=2)
        short, long = np.minimum(short, lengths.min(axis=1)), np.maximum(long, lengths.max(axis=1))
        scaled = np.linalg.det(edges) / np.maximum(lengths.prod(axis=1), 1e-300) / BEST[name]
        smallest = np.minimum(smallest, scaled)
    return smallest, long / np.maximum(short, 1e-300)
