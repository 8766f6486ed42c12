"""What materials take and return, at n points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Evaluated = tuple[Array, Array, Array]  # stress (n, 6), tangent d stress / d strain (n, 6, 6), new history (n, h)
