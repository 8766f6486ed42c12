"""The mesh record: points, cell blocks, named bodies, surfaces and node sets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class CellBlock:
    """Cells of one type: ``kind`` a name in ``abut.mesh.cells.CELLS``, ``nodes`` (n_cells, n_nodes) int32."""

    kind: str
    nodes: NDArray[np.int32]


@dataclass(frozen=True)
class Mesh:
    """Points and cells with names.

    points:    (n_points, dim) float64, dim 2 or 3, any length unit.
    blocks:    cells by type; cell numbers run through the blocks in order.
    bodies:    name -> (n,) int64 cell numbers, sorted.
    surfaces:  name -> (n, 2) int64 rows (cell number, local facet number).
    node_sets: name -> (n,) int64 point numbers, sorted.
    """

    points: NDArray[np.float64]
    blocks: tuple[CellBlock, ...]
    bodies: Mapping[str, NDArray[np.int64]]
    surfaces: Mapping[str, NDArray[np.int64]] = field(default_factory=dict)
    node_sets: Mapping[str, NDArray[np.int64]] = field(default_factory=dict)
