"""Friction of a contact as the user states it, and its coefficient at points and times."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from abut import checks
from abut.contact.friction_bound import FrictionBound, PressureCurve
from abut.errors import InputError
from abut.expression import Expression
from abut.fields import Field, called, evaluate
from abut.types import Array

if TYPE_CHECKING:
    from abut.model.contact import Contact
    from abut.model.model import Model

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


@dataclass(frozen=True)
class FrictionValues:
    """The coefficient of friction at n points. coefficient: (n,), infinite where rough; curve: over pressure, times which it
    is to be taken; history: number of its amplitude among the model's histories, None for one that is constant; largest: the
    largest factor that this amplitude has."""

    coefficient: Array
    curve: PressureCurve | None = None
    history: int | None = None
    largest: float = 1.0

    def at(self, factors: Array) -> FrictionValues:
        """The values of a moment, where the model's histories are at ``factors``, (n_histories,)."""
        return (
            self
            if self.history is None
            else FrictionValues(self.coefficient * float(factors[self.history]), self.curve)
        )

    def bound(self, factors: Array) -> FrictionBound:
        """The same as what tractions are bounded by."""
        return FrictionBound(self.at(factors).coefficient, self.curve)

    @property
    def steepest(self) -> Array:
        """The largest coefficient at any time and pressure, (n,)."""
        over = 1.0 if self.curve is None else float(self.curve.coefficients.max())
        return self.coefficient * (self.largest * over)


def friction_values(model: Model, contact: Contact, points: Array) -> FrictionValues:
    """The friction of one of the model's contacts at points (n, dim). Raises InputError for an expression or a function that
    returns anything but numbers >= 0."""
    given, n, curve = contact.friction, len(points), None
    if isinstance(given, str):
        coefficient = np.full(n, math.inf)
    elif isinstance(given, tuple):
        coefficient, curve = np.ones(n), PressureCurve(*np.array(given).T)
    else:
        where = f"contact '{contact.name}': friction"
        coefficient = np.array(evaluate(given, points, where))
        if (coefficient < 0.0).any():
            first = int(np.argmax(coefficient < 0.0))
            raise InputError(
                f"{where}: {called(given)} returns {coefficient[first]:g} at {points[first].tolist()}, not >= 0"
            )
    amplitude = contact.friction_amplitude
    if amplitude is None:
        return FrictionValues(coefficient, curve)
    return FrictionValues(coefficient, curve, model.histories.index(amplitude), amplitude.largest)
