"""Results of a probe as plain numbers with names, for tables and plots."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.solution import ProbeResult

STRESSES = ("xx", "yy", "zz", "xy", "yz", "zx")
PARTS = {"displacement": "xyz", "reaction": "xyz", "principal_stress": "123"}  # of others than tensors


def columns(result: ProbeResult) -> dict[str, NDArray[np.float64]]:
    """Each component by its name, (n,): displacement_x ..., stress_xx ... stress_zx, von_mises, principal_stress_1 ... 3,
    max_shear, reaction_x ..., plastic_strain_xx ..., equivalent_plastic_strain, pressure, gap."""
    table: dict[str, NDArray[np.float64]] = {}
    for name, values in result.values.items():
        if values.ndim == 1:
            table[name] = values
        else:
            parts = PARTS.get(name, STRESSES)
            table |= {f"{name}_{part}": column for part, column in zip(parts, values.T)}
    return table


def peaks(result: ProbeResult) -> dict[str, float | None]:
    """Of each component the value farthest from zero, which for one point is its value, of reactions the sum; None where
    there is none."""
    return {
        name: float(values.sum()) if name.startswith("reaction_") else _peak(values)
        for name, values in columns(result).items()
    }


def _peak(values: NDArray[np.float64]) -> float | None:
    known = values[np.isfinite(values)]
    return float(known[np.argmax(np.abs(known))]) if len(known) else None
