"""Cells of one type."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class CellBlock:
    """Cells of one type: ``kind`` a name in ``abut.cells.CELLS``, ``nodes`` (n_cells, n_nodes) int32."""

    kind: str
    nodes: NDArray[np.int32]
