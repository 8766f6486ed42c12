"""Cells of one type."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut import checks
from abut.cells import CELLS


@dataclass(frozen=True)
class CellBlock:
    """Cells of one type: ``kind`` a name in ``abut.cells.CELLS``, ``nodes`` (n_cells, n_nodes) int32, of which whole numbers
    of any kind are made. Raises InputError for what is no such array."""

    kind: str
    nodes: NDArray[np.int32]

    def __post_init__(self) -> None:
        checks.choice(self.kind, "cell block: kind", tuple(CELLS))
        nodes = checks.whole_numbers(self.nodes, f"{self.kind} cells: nodes", np.int32, (None, None))
        object.__setattr__(self, "nodes", nodes)
