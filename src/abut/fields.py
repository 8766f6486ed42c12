"""Values that may depend on position: numbers, expressions of x, y and z, or functions of points."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from abut import checks
from abut.errors import InputError
from abut.expression import Expression

Field = Callable[[NDArray[np.float64]], NDArray[np.float64]]  # points (n, dim) -> (n,), (n, dim) or (n, dim, dim)
Given = (
    float | str | Sequence[float | str] | NDArray[np.float64] | Field
)  # text: an expression, in records that keep it as one


def number_or_field(value: object, name: str) -> float | Field:
    """A value as a record keeps it: text as an expression. Raises InputError for anything but finite numbers, expressions
    and functions; ``name`` says whose it is."""
    if isinstance(value, str):
        try:
            return Expression(value)
        except InputError as error:
            raise InputError(f"{name}: {error}") from None
    return value if callable(value) else checks.finite(value, name)  # type: ignore[arg-type]


def called(value: object) -> str:
    """What messages call an expression or a function."""
    return repr(value.text) if isinstance(value, Expression) else "the function"


def evaluate(
    value: Given,
    points: NDArray[np.float64],
    name: str,
    shape: tuple[int, ...] = (),
) -> NDArray[np.float64]:
    """Numbers or a function at points (..., dim): an array (..., *shape); ``shape`` is that of the value at one point.

    Functions get all points at once, (n, dim). Raises InputError where one does not return numbers, returns another
    shape than (n, *shape), or a number that is not finite or beyond all units; ``name`` says whose it is.
    """
    flat = np.ascontiguousarray(points.reshape(-1, points.shape[-1]))
    if not callable(value):
        return np.broadcast_to(np.asarray(value, dtype=float), (*points.shape[:-1], *shape))
    if not len(flat):
        return np.zeros((*points.shape[:-1], *shape))
    try:
        got = value(flat)
    except InputError as error:
        raise InputError(f"{name}: {error}") from None
    try:
        result = np.asarray(got, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"{name}: expected a function that returns numbers, got {type(got).__name__}") from None
    expected = (len(flat), *shape)
    if result.shape != expected:
        raise InputError(
            f"{name}: for points of shape {flat.shape} the function must return shape {expected}, got {result.shape}"
        )
    bad = np.argwhere(~(np.abs(result) <= checks.LARGEST))
    if len(bad):
        raise InputError(f"{name}: {called(value)} returns {result[tuple(bad[0])]:g} at {flat[bad[0][0]].tolist()}")
    return result.reshape(*points.shape[:-1], *shape)
