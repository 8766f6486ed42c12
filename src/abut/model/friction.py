"""The coefficient of friction of a contact at points and times."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from abut.contact.friction_bound import FrictionBound, PressureCurve
from abut.errors import InputError
from abut.fields import called, evaluate
from abut.model.contact import Contact
from abut.model.model import Model
from abut.types import Array


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
