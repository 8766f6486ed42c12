"""Scalars of a stress that do not depend on the axes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def von_mises(stress: NDArray[np.float64]) -> NDArray[np.float64]:
    """Von Mises stress of (n, 6) stresses xx yy zz xy yz zx."""
    xx, yy, zz, xy, yz, zx = stress.T
    return np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * (xy**2 + yz**2 + zx**2))


def max_shear(stress: NDArray[np.float64]) -> NDArray[np.float64]:
    """Largest shear stress of (n, 6) stresses xx yy zz xy yz zx, (n,): half the difference of the largest and the smallest
    principal stress, half of Tresca's equivalent stress."""
    roots = principal(stress)
    return np.asarray(0.5 * (roots[:, 0] - roots[:, 2]))


def principal(stress: NDArray[np.float64]) -> NDArray[np.float64]:
    """Principal stresses of (n, 6) stresses xx yy zz xy yz zx, (n, 3), the largest first: the roots of the characteristic
    cubic as cosines (Smith 1961), to about 1e-8 of the largest where two of them nearly agree."""
    size = np.maximum(np.abs(stress).max(axis=1, initial=0.0), np.finfo(float).tiny)
    xx, yy, zz, xy, yz, zx = (stress / size[:, None]).T
    mean = (xx + yy + zz) / 3.0
    a, b, c = xx - mean, yy - mean, zz - mean
    radius = np.sqrt((a**2 + b**2 + c**2 + 2.0 * (xy**2 + yz**2 + zx**2)) / 6.0)
    third = 0.5 * (a * (b * c - yz**2) - xy * (xy * c - yz * zx) + zx * (xy * yz - b * zx))
    cosine = third / np.where(radius > 0.0, radius, 1.0) ** 3
    angle = np.arccos(np.clip(cosine, -1.0, 1.0)) / 3.0
    turned = angle[:, None] + np.array([0.0, -2.0, 2.0]) * np.pi / 3.0  # the cosines in falling order
    return np.asarray(size[:, None] * (mean[:, None] + 2.0 * radius[:, None] * np.cos(turned)))
