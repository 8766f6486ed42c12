"""What connectors do at the end of a step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

STILL = 1e-9  # turn in radians, and travel over the largest displacement, that is rounding


@dataclass(frozen=True)
class ConnectorResult:
    """A connector at the end of a step. motion: by name "turn", "turn2" (radian), "travel" (length), of ``on`` relative to
    ``to``; force (dim,) and moment (1,) or (3,) about the joint where it is then, that it exerts on ``on``, its stop,
    spring, load and drive among them; stop: moment or force along the free motion by the limit that is reached, 0.0
    between both, None without limits; drive: that of a prescribed motion, None without; stop2: as stop, of the second free
    motion."""

    motion: Mapping[str, float]
    force: NDArray[np.float64]
    moment: NDArray[np.float64]
    stop: float | None = None
    drive: float | None = None
    stop2: float | None = None

    def moves(self, largest: float) -> bool:
        """Whether there is any motion beyond rounding; largest: displacement in the model."""
        sizes = {name: largest if name == "travel" else 1.0 for name in self.motion}
        return any(abs(value) > STILL * sizes[name] for name, value in self.motion.items())
