"""How much tangential traction friction carries under a pressure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PressureCurve:
    """A coefficient of friction over pressure, linear between points and constant beyond them. pressures: (m,) >= 0, rising;
    coefficients: (m,) >= 0."""

    pressures: Array
    coefficients: Array

    def at(self, pressure: Array) -> tuple[Array, Array]:
        """The coefficient at pressures (n,), and its derivative by them; at a point of the curve that of the part above."""
        slopes = np.concatenate([[0.0], np.diff(self.coefficients) / np.diff(self.pressures), [0.0]])
        part = np.searchsorted(self.pressures, pressure, side="right")
        return np.interp(pressure, self.pressures, self.coefficients), slopes[part]


@dataclass(frozen=True)
class FrictionBound:
    """The bound mu(p) p of the tangential traction under a pressure p.

    coefficient: one number for all points, or (n,); infinite for surfaces that never slip, then for all points; curve: over
    pressure, times which the coefficient is mu; left out: mu is the coefficient."""

    coefficient: float | Array
    curve: PressureCurve | None = None

    @property
    def rough(self) -> bool:
        """Whether nothing ever slips."""
        return bool(np.isinf(self.coefficient).any())

    @property
    def none(self) -> NDArray[np.bool_]:
        """Where there is no friction at any pressure, (n,) or one bool."""
        return np.equal(self.coefficient, 0.0)

    def at(self, pressure: Array) -> tuple[Array, Array]:
        """The bound under pressures (n,) >= 0, and its derivative by them; where rough, infinite and 0."""
        if self.rough:
            return np.full(len(pressure), np.inf), np.zeros(len(pressure))
        if self.curve is None:
            return self.coefficient * pressure, np.broadcast_to(self.coefficient, pressure.shape)
        over, slope = self.curve.at(pressure)
        return self.coefficient * over * pressure, self.coefficient * (over + slope * pressure)

    def coefficients(self, pressure: Array) -> Array:
        """mu under pressures (n,), (n,)."""
        over = 1.0 if self.curve is None else self.curve.at(pressure)[0]
        return np.asarray(np.broadcast_to(self.coefficient * over, pressure.shape))
