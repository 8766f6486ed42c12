"""Grid lines that are fine where bodies touch and grow away from there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from abut import checks
from abut.errors import InputError

MOST = 100_000  # cells along a line


def graded(fine: float, n: int, total: float, growth: float = 1.25) -> NDArray[np.float64]:
    """Grid lines from 0 to ``total``: n equal ones up to ``fine``, then growing by ``growth``."""
    if isinstance(n, bool) or not isinstance(n, (int, np.integer)) or not 1 <= n <= MOST:
        raise InputError(f"cells: expected a whole number from 1 to {MOST}, got {n!r}")
    if checks.finite(growth, "growth") <= 1.0:  # the cells would never reach the other side
        raise InputError(f"growth: expected a number > 1, got {growth!r}")
    if not 0.0 < fine < total:
        raise InputError(f"fine: expected a length between 0 and {total:g}, got {fine!r}")
    step = fine / n
    lines = list(np.linspace(0.0, fine, n + 1))
    rest = total - fine
    count = 1
    while step * _reach(growth, count) < rest:
        count += 1
        if count > MOST:
            raise InputError(
                f"growth: {growth!r} makes more than {MOST} cells; choose a larger growth, or a larger fine"
            )
    low, high = 1.0 + 1e-12, 2.0 * growth
    for _ in range(80):  # the growth with which ``count`` cells end at total
        middle = 0.5 * (low + high)
        low, high = (middle, high) if step * _reach(middle, count) < rest else (low, middle)
    lines += list(fine + np.cumsum(step * low ** np.arange(1, count + 1)))
    lines[-1] = total
    return np.array(lines)


def _reach(growth: float, count: int) -> float:
    """growth + growth^2 + ... + growth^count; infinite where that is too large a number."""
    with np.errstate(over="ignore"):
        return float(growth * (np.float64(growth) ** count - 1.0) / (growth - 1.0))


def graded_axis(
    limits: Sequence[float], zone: Sequence[float], n: int, growth: float, name: str
) -> NDArray[np.float64]:
    """Grid lines from limits[0] to limits[1]: n equal cells in ``zone``, growing on both sides of it."""
    low, high = checks.array(limits, name, shape=(2,))
    begin, end = checks.array(zone, f"{name}: fine", shape=(2,))
    if not low <= begin < end <= high:
        raise InputError(f"{name}: fine: expected a part of [{low:g}, {high:g}], got {list(zone)}")
    width = end - begin
    lines = [np.linspace(begin, end, n + 1)]
    if begin > low:
        lines.insert(0, begin + width - graded(width, n, width + begin - low, growth)[:n:-1])
    if end < high:
        lines.append(end - width + graded(width, n, width + high - end, growth)[n + 1 :])
    return np.concatenate(lines)
