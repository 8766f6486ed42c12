"""The outside of all bodies: facets that have a cell on one side only."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from abut._core import single_rows
from abut.cells import CELLS
from abut.mesh.mesh import Mesh


def exterior(mesh: Mesh) -> NDArray[np.int64]:
    """Rows (n, 2) = (cell, local facet) of all facets with a cell on one side only, in the order of the cells. Facets
    between bodies that share nodes are inside."""
    blocks = zip(mesh.blocks, mesh.starts)
    return single_facets(
        mesh, [(block.kind, block.nodes, first + np.arange(len(block.nodes))) for block, first in blocks]
    )


def outside_of_body(mesh: Mesh, body: str) -> NDArray[np.int64]:
    """The same of a body by itself: facets that only one cell of the body has."""
    return single_facets(mesh, mesh.cells_of(body))


def single_facets(mesh: Mesh, cells: Sequence[tuple[str, NDArray[np.int32], NDArray[np.int64]]]) -> NDArray[np.int64]:
    """Rows (cell, local facet), in the order of the cells, of facets that only one of some cells has; these by type: kind,
    connectivity, cell numbers."""
    corners, rows = [np.empty((0, 4), np.int32)], [np.empty((0, 2), np.int64)]
    for kind, nodes, numbers in cells:
        facets = CELLS[kind].facets
        own = np.full((len(nodes), len(facets), 4), -1, dtype=np.int32)
        for local, (facet, of_cell) in enumerate(facets):
            used = list(of_cell[: CELLS[facet].corners])
            own[:, local, : len(used)] = nodes[:, used]
        corners.append(own.reshape(-1, 4))
        rows.append(np.stack([np.repeat(numbers, len(facets)), np.tile(np.arange(len(facets)), len(nodes))], axis=1))
    return np.concatenate(rows)[single_rows(np.concatenate(corners), len(mesh.points))]
