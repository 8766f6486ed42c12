"""The outside of all bodies: facets that have a cell on one side only."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.mesh.facets import corner_keys, row_codes, single
from abut.mesh.mesh import Mesh


def exterior(mesh: Mesh) -> NDArray[np.int64]:
    """Rows (n, 2) = (cell, local facet) of all facets with a cell on one side only, in the order of the cells. Facets
    between bodies that share nodes are inside."""
    every, rows = [np.empty((0, 4), np.int64)], [np.empty((0, 2), np.int64)]
    for block, first in zip(mesh.blocks, mesh.starts):
        for local, (kind, nodes) in enumerate(CELLS[block.kind].facets):
            keys = corner_keys(block.nodes[:, nodes[: CELLS[kind].corners]].astype(np.int64))
            every.append(keys)
            rows.append(np.stack([first + np.arange(len(keys)), np.full(len(keys), local)], axis=1))
    outside = np.concatenate(rows)[single(row_codes(np.concatenate(every)))]
    return outside[np.lexsort((outside[:, 1], outside[:, 0]))]
