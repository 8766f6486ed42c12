"""Fractional powers of sparse symmetric pencils as sums of resolvents."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import ellipj, ellipk


def inverse_root(low: float, high: float, accuracy: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Shifts s_j and weights w_j with x^-1/2 = sum_j w_j / (x + s_j) to ``accuracy`` for low <= x <= high.

    Hale, Higham and Trefethen 2008, method 3: midpoint rule on the conformal image of a rectangle."""
    # The error is at most 4 exp(-2 pi^2 count / (log(high / low) + 3)).
    count = int(np.ceil((np.log(high / low) + 3.0) * np.log(4.0 / accuracy) / (2.0 * np.pi**2)))
    complement = 1.0 - low / high
    period = ellipk(complement)
    sn, cn, dn, _ = ellipj((np.arange(count) + 0.5) * period / count, complement)
    return np.asarray(low * (sn / cn) ** 2), np.asarray(2.0 * period * np.sqrt(low) / (np.pi * count) * dn / cn**2)
