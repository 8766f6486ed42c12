"""The state of a problem at a time, converged or on trial. Nothing else is carried from step to step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
OPEN, CLOSED = np.int8(0), np.int8(1)  # status of a multiplier


@dataclass(frozen=True)
class History:
    """What bodies and contacts remember: arrays by the name of the term that owns them, (n_integration_points, k)."""

    arrays: Mapping[str, Vector] = field(default_factory=dict)

    def of(self, name: str) -> Vector | None:
        return self.arrays.get(name)

    def with_(self, news: Mapping[str, Vector]) -> History:
        """The same with some arrays replaced."""
        return History({**self.arrays, **news}) if news else self


@dataclass(frozen=True)
class Largest:
    """The largest nodal force and pressure of a run so far, against which rounding is judged where loads are taken off."""

    force: float = 0.0
    pressure: float = 0.0


@dataclass(frozen=True)
class State:
    """A state of a problem, converged or on trial; what a restart needs.

    time: in (0, 1]; unknowns: (n_free,) free displacements; multipliers: (n,) of all contact pairs, pair by pair (pressure,
    force per area, or the components of a tie's traction); status: (n,) int8, ``OPEN`` or ``CLOSED``; history: of bodies
    and contacts; largest: over all converged states up to this one.
    """

    time: float
    unknowns: Vector
    multipliers: Vector
    status: NDArray[np.int8]
    history: History = field(default_factory=History)
    largest: Largest = field(default_factory=Largest)

    @property
    def closed(self) -> NDArray[np.bool_]:
        """(n,) multipliers in contact: the active set."""
        return self.status != OPEN

    def with_closed(self, closed: NDArray[np.bool_]) -> State:
        """The same with another active set, (n,) bool."""
        return replace(self, status=np.where(closed, CLOSED, OPEN))


def at_rest(n_free: int, n_multipliers: int) -> State:
    """Nothing moved, nothing pressed, all open."""
    return State(0.0, np.zeros(n_free), np.zeros(n_multipliers), np.full(n_multipliers, OPEN))
