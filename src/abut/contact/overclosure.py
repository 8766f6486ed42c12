"""Soft contact: a pressure that grows with how far surfaces overlap."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.contact.laws import LawResult, LawState
from abut.errors import InputError


@dataclass(frozen=True)
class PressureOverclosure:
    """Pressure over the overclosure, which is minus the gap, theory (L14).

    Parameters
    ----------
    points : sequence of (float, float)
        Pairs of overclosure [length] and pressure [force per area], linear between; no pressure before the first, whose
        pressure is 0, and the last slope goes on after the last.

    Raises
    ------
    InputError
        For points that do not increase.

    Examples
    --------
    >>> import abut
    >>> gasket = abut.PressureOverclosure([(0.0, 0.0), (0.01, 5.0), (0.02, 50.0)])
    >>> round(gasket.overclosure(5.0), 6)
    0.01
    """

    points: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        try:
            points = tuple((float(overclosure), float(pressure)) for overclosure, pressure in self.points)
        except (TypeError, ValueError):
            raise InputError(f"overclosure: expected pairs of overclosure and pressure, got {self.points!r}") from None
        values = np.array(points).reshape(-1, 2)
        if len(values) < 2 or not np.isfinite(values).all() or (np.diff(values, axis=0) <= 0.0).any() or values[0, 1]:
            raise InputError(
                "overclosure: expected two or more pairs of overclosure and pressure that both increase, the first pressure "
                f"0, got {[list(point) for point in points]}"
            )
        object.__setattr__(self, "points", points)

    def overclosure(self, pressure: float) -> float:
        """How far surfaces overlap under a pressure."""
        lengths, pressures = np.array(self.points).T
        i = min(int(np.searchsorted(pressures, pressure)), len(pressures) - 1)
        i = max(i, 1)
        slope = (pressures[i] - pressures[i - 1]) / (lengths[i] - lengths[i - 1])
        return float(lengths[i - 1] + (pressure - pressures[i - 1]) / slope)

    def evaluate(self, jump: NDArray[np.float64], traction: NDArray[np.float64], state: LawState) -> LawResult:
        """Residual, derivatives and status at n points, as in ``abut.contact.laws.Law``, c = 1. A point is in contact
        where overclosure and pressure together say so: bodies that contact alone holds keep it while pressures are right
        and gaps are not yet."""
        lengths, pressures = np.array(self.points).T
        slopes = np.diff(pressures) / np.diff(lengths)
        over = -jump[:, 0]
        piece = np.clip(np.searchsorted(lengths, over, side="right") - 1, 0, len(slopes) - 1)
        closed = (over - lengths[0]) * slopes[0] + traction[:, 0] > 0.0
        slope = np.where(closed, slopes[piece], 0.0)
        asked = np.where(closed, pressures[piece] + slope * (over - lengths[piece]), 0.0)
        return LawResult(
            residual=traction - asked[:, None],
            by_jump=slope[:, None, None],
            by_traction=np.ones_like(jump)[:, :, None],
            closed=closed,
        )
