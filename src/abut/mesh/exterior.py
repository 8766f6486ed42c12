"""The outside of all bodies: facets that have a cell on one side only."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.mesh.facets import corner_keys
from abut.mesh.mesh import Mesh


def exterior(mesh: Mesh) -> NDArray[np.int64]:
    """Rows (n, 2) = (cell, local facet) of all facets with a cell on one side only, in the order of the cells. Facets
    between bodies that share nodes are inside."""
    code, row = coded_facets(mesh)
    order = np.lexsort(code.T)
    new = np.ones(len(order) + 1, dtype=bool)
    new[1:-1] = (code[order[1:]] != code[order[:-1]]).any(axis=1)
    outside = row[order[new[:-1] & new[1:]]]
    return outside[np.lexsort((outside[:, 1], outside[:, 0]))]


def coded_facets(mesh: Mesh) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Every facet of every cell: two numbers (n, 2) that only facets with the same corners have in common, and rows (n, 2) =
    (cell, local facet)."""
    codes, rows = [np.empty((0, 2), np.int64)], [np.empty((0, 2), np.int64)]
    for block, first in zip(mesh.blocks, mesh.starts):
        for local, (kind, nodes) in enumerate(CELLS[block.kind].facets):
            keys = corner_keys(block.nodes[:, nodes[: CELLS[kind].corners]].astype(np.int64))
            codes.append((keys[:, 0::2] << 32) + keys[:, 1::2] + 1)  # four numbers in two: faster to sort, still exact
            rows.append(np.stack([first + np.arange(len(keys)), np.full(len(keys), local)], axis=1))
    return np.concatenate(codes), np.concatenate(rows)
