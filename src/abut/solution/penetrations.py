"""How far the fluid of pressure penetration has got at the end of a step, and what it exerts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class PenetrationResult:
    """A fluid at the end of a step. pressure: its own; area: that it wets of the contactor (2D: length; axisymmetric: all
    round); share: over all of the contactor's; contactor, target: (dim,) force on either surface."""

    pressure: float
    area: float
    share: float
    contactor: NDArray[np.float64]
    target: NDArray[np.float64]
