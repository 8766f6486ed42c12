"""Values that may depend on position: numbers, or functions of points."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from abut.errors import InputError

Field = Callable[[NDArray[np.float64]], NDArray[np.float64]]  # points (n, dim) -> (n,), (n, dim) or (n, dim, dim)


def evaluate(
    value: float | Sequence[float] | NDArray[np.float64] | Field,
    points: NDArray[np.float64],
    name: str,
    shape: tuple[int, ...] = (),
) -> NDArray[np.float64]:
    """Numbers or a function at points (..., dim): an array (..., *shape); ``shape`` is that of the value at one point.

    Functions get all points at once, (n, dim). Raises InputError where one does not return numbers, returns another
    shape than (n, *shape), or a number that is not finite; ``name`` says whose it is.
    """
    flat = np.ascontiguousarray(points.reshape(-1, points.shape[-1]))
    if not callable(value):
        return np.broadcast_to(np.asarray(value, dtype=float), (*points.shape[:-1], *shape))
    if not len(flat):
        return np.zeros((*points.shape[:-1], *shape))
    got = value(flat)
    try:
        result = np.asarray(got, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"{name}: expected a function that returns numbers, got {type(got).__name__}") from None
    expected = (len(flat), *shape)
    if result.shape != expected:
        raise InputError(
            f"{name}: for points of shape {flat.shape} the function must return shape {expected}, got {result.shape}"
        )
    bad = np.argwhere(~np.isfinite(result))
    if len(bad):
        raise InputError(f"{name}: the function returns {result[tuple(bad[0])]} at {flat[bad[0][0]].tolist()}")
    return result.reshape(*points.shape[:-1], *shape)
