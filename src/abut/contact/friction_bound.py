"""How much tangential traction friction carries under a pressure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FrictionBound:
    """The bound mu p of the tangential traction under a pressure p.

    coefficient mu: one number for all points, or (n,); infinite for surfaces that never slip, then for all points."""

    coefficient: float | Array

    @property
    def rough(self) -> bool:
        """Whether nothing ever slips."""
        return bool(np.isinf(self.coefficient).any())

    def at(self, pressure: Array) -> tuple[Array, Array]:
        """The bound under pressures (n,) >= 0, and its derivative by them; where rough, infinite and 0."""
        if self.rough:
            return np.full(len(pressure), np.inf), np.zeros(len(pressure))
        return self.coefficient * pressure, np.broadcast_to(self.coefficient, pressure.shape)
