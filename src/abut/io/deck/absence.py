"""Elements that are not there for a while."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Absence:
    """Elements (n,) that are not there for a while. spans: the step (0, 1, ...) from which on they are away, and that from
    which on they are there again, left out where they stay away; strained: then by all of their displacement."""

    elements: NDArray[np.int64]
    spans: tuple[tuple[int, ...], ...]
    strained: bool = False
