"""The outside of all bodies: facets that have a cell on one side only."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from abut._core import single_rows
from abut.cells import CELLS
from abut.mesh.mesh import Mesh

Cells = Sequence[tuple[str, NDArray[np.int32], NDArray[np.int64]]]  # by type: kind, connectivity, cell numbers


def exterior(mesh: Mesh) -> NDArray[np.int64]:
    """Rows (n, 2) = (cell, local facet) of all facets with a cell on one side only, in the order of the cells. Facets
    between bodies that share nodes are inside."""
    return single_facets(mesh, numbered(mesh))


def outside_of_body(mesh: Mesh, body: str) -> NDArray[np.int64]:
    """The same of a body by itself: facets that only one cell of the body has."""
    return single_facets(mesh, mesh.cells_of(body))


def single_facets(mesh: Mesh, cells: Cells) -> NDArray[np.int64]:
    """Rows (cell, local facet), in the order of the cells, of facets that only one of some cells has."""
    corners, rows = facets_of(cells)
    return rows[single_rows(corners, len(mesh.points))]


def facets_of(cells: Cells) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """Corners (n, 4), padded with -1, and rows (n, 2) = (cell, local facet) of every facet of some cells."""
    corners, rows = [np.empty((0, 4), np.int32)], [np.empty((0, 2), np.int64)]
    for kind, nodes, numbers in cells:
        facets = CELLS[kind].facets
        corner_nodes = np.full((len(nodes), len(facets), 4), -1, dtype=np.int32)
        for local, (facet, of_cell) in enumerate(facets):
            used = list(of_cell[: CELLS[facet].corners])
            corner_nodes[:, local, : len(used)] = nodes[:, used]
        corners.append(corner_nodes.reshape(-1, 4))
        rows.append(np.stack([np.repeat(numbers, len(facets)), np.tile(np.arange(len(facets)), len(nodes))], axis=1))
    return np.concatenate(corners), np.concatenate(rows)


def numbered(mesh: Mesh) -> Cells:
    """All cells by block."""
    return [(b.kind, b.nodes, first + np.arange(len(b.nodes))) for b, first in zip(mesh.blocks, mesh.starts)]
