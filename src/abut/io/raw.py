"""The raw contents of a mesh file, before they become bodies and surfaces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class RawMesh:
    """points: (n, 3); groups: name -> cell type ("point" for single nodes) -> connectivity (cells, nodes) in the order
    of ``abut.cells``. A cell may stand in several groups; the name "" holds cells without a group. notes: what was left
    out of the file, in words."""

    points: NDArray[np.float64]
    groups: Mapping[str, Mapping[str, NDArray[np.int64]]]
    notes: tuple[str, ...] = ()
