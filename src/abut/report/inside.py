"""The inside of bodies as tetrahedra between corners of their cells: what a section plane cuts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.mesh.mesh import Mesh

# Corners of the tetrahedra that fill a cell, by its number of corners.
_TETRAHEDRA: dict[int, tuple[tuple[int, int, int, int], ...]] = {
    4: ((0, 1, 2, 3),),
    6: ((0, 1, 2, 5), (0, 1, 5, 4), (0, 4, 5, 3)),
    8: ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)),
}


def tetrahedra(mesh: Mesh, body: str) -> NDArray[np.int64]:
    """Points of the mesh (n, 4) at the corners of tetrahedra that fill a body, its edges taken for straight; none in 2D."""
    parts = [np.empty((0, 4), np.int64)]
    for kind, nodes, _ in mesh.cells_of(body):
        cell = CELLS[kind]
        if cell.dim == 3:
            parts.append(nodes[:, np.array(_TETRAHEDRA[cell.corners])].reshape(-1, 4).astype(np.int64))
    return np.concatenate(parts)
