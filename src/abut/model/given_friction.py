"""Friction of a contact as the user states it."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from abut import checks
from abut.errors import InputError
from abut.expression import Expression
from abut.fields import Field

ROUGH = "rough"  # friction that never slips
Table = tuple[tuple[float, float], ...]  # pressure, coefficient
Friction = float | str | Field | Table
EXPECTED = 'expected a coefficient >= 0, an expression of x, y, z, "rough", or pairs of pressure and coefficient'


def checked(value: object, where: str) -> Friction:
    """The friction of a contact in the form that its record keeps; ``where`` begins each message. Raises InputError."""
    if callable(value):
        return value
    if isinstance(value, str):
        try:
            return value if value == ROUGH else Expression(value)
        except InputError as error:
            raise InputError(f"{where}: {EXPECTED}, got {value!r}: {error}") from None
    if isinstance(value, (list, tuple, np.ndarray)):
        return _table(value, where)
    if value is None or isinstance(value, dict):
        raise InputError(f"{where}: {EXPECTED}, got {value!r}")
    number = checks.finite(value, where)  # type: ignore[arg-type]
    if number < 0.0:
        raise InputError(f"{where}: expected a coefficient >= 0, got {value!r}")
    return number


def _table(value: list[object] | tuple[object, ...] | np.ndarray, where: str) -> Table:
    try:
        pairs = [(pressure, coefficient) for pressure, coefficient in value]  # type: ignore[misc]
    except (TypeError, ValueError):
        raise InputError(f"{where}: {EXPECTED}, got {value!r}") from None
    if not pairs:
        raise InputError(f"{where}: expected at least one pair of pressure and coefficient")
    table = tuple((checks.finite(p, f"{where}: pressure"), checks.finite(mu, where)) for p, mu in pairs)
    for pressure, coefficient in table:
        if pressure < 0.0:
            raise InputError(f"{where}: expected pressures >= 0 (compression), got {pressure:g}")
        if coefficient < 0.0:
            raise InputError(f"{where}: expected a coefficient >= 0, got {coefficient:g} at pressure {pressure:g}")
    for (before, _), (after, _) in pairwise(table):
        if not before < after:
            raise InputError(f"{where}: pressures must increase, but {after:g} follows {before:g}")
    return table
