"""Meshes of plates, shells and beams: one cell through the thickness."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.mesh.exterior import exterior, numbered
from abut.mesh.mesh import Mesh

SHARE = (
    0.9  # of the cells: ribs and joints may be thicker (a clamped plate of 60 x 60: multigrid takes five times as long)
)


def one_layer(mesh: Mesh, counted: NDArray[np.bool_]) -> bool:
    """Whether nearly all cells of a 3D mesh that count, (n_cells,), have all of their corners on the outside. Such a mesh is
    coupled as a surface is: few unknowns cut it in two."""
    if mesh.dim != 3 or not counted.any():
        return False
    nodes = mesh.facets(exterior(mesh)).nodes
    outside = np.zeros(len(mesh.points), dtype=bool)
    outside[nodes[nodes >= 0]] = True
    thin = np.zeros(mesh.n_cells, dtype=bool)
    for kind, cells, numbers in numbered(mesh):
        thin[numbers] = outside[cells[:, : CELLS[kind].corners]].all(axis=1)
    return float(thin[counted].mean()) >= SHARE
