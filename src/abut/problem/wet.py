"""How far a fluid has got into a contact."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.types import Array


@dataclass(frozen=True)
class Wet:
    """How far a fluid has got. nodes: (n_points,) corners of the contactor that it reaches; left: those that it has left in
    this step; shares: (n_points, 2) share of the pressure that acts at the points of contactor and target, linear between:
    0 to 1, and on the target somewhat beyond at the fluid's edge."""

    nodes: NDArray[np.bool_]
    left: NDArray[np.bool_]
    shares: Array

    @classmethod
    def none(cls, count: int) -> Wet:
        """Dry; count: of points."""
        dry = np.zeros(count, dtype=bool)
        return cls(dry, dry, np.zeros((count, 2)))

    @classmethod
    def remembered(cls, parts: Array) -> Wet:
        """From what a converged state remembers, (n_points, 3)."""
        return cls(parts[:, 0] > 0.5, np.zeros(len(parts), dtype=bool), parts[:, 1:])

    def parts(self) -> Array:
        """What a converged state remembers, (n_points, 3)."""
        return np.column_stack([self.nodes.astype(float), self.shares])
