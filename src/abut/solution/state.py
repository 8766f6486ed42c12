"""The state of a problem at a time, converged or on trial. Nothing else is carried from step to step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
OPEN, CLOSED, SLIPPING = np.int8(0), np.int8(1), np.int8(2)  # status of a multiplier; closed with friction: stuck


@dataclass(frozen=True)
class History:
    """What bodies and contacts remember: arrays (n_integration_points, k) by name, "bodies.pin": that of the term that owns
    them, and of its part."""

    arrays: Mapping[str, Vector] = field(default_factory=dict)

    def of(self, term: str) -> Mapping[str, Vector]:
        """The arrays of a term, by part."""
        return {
            name.partition(".")[2]: values for name, values in self.arrays.items() if name.partition(".")[0] == term
        }

    def with_term(self, term: str, parts: Mapping[str, Vector]) -> History:
        """The same with a term's arrays replaced."""
        return (
            History({**self.arrays, **{f"{term}.{part}": values for part, values in parts.items()}}) if parts else self
        )

    def without(self, term: str) -> History:
        """The same without a term's arrays."""
        return History({name: values for name, values in self.arrays.items() if name.partition(".")[0] != term})


@dataclass(frozen=True)
class Largest:
    """The largest nodal force and pressure of a run so far, against which rounding is judged where loads are taken off."""

    force: float = 0.0
    pressure: float = 0.0


@dataclass(frozen=True)
class State:
    """A state of a problem, converged or on trial; what a restart needs.

    time: in (0, 1]; unknowns: (n_free,) free displacements; multipliers: (n,) of all contact pairs, pair by pair (pressure,
    force per area, or the components of a tie's traction); status: (n,) int8, ``OPEN``, ``CLOSED``
    or, with friction, ``SLIPPING``; history: of bodies
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

    @property
    def slipping(self) -> NDArray[np.bool_]:
        """(n,) multipliers in contact that slip."""
        return self.status == SLIPPING

    def with_closed(self, closed: NDArray[np.bool_]) -> State:
        """The same with another active set, (n,) bool."""
        return self.with_status(np.where(closed, CLOSED, OPEN))

    def with_status(self, status: NDArray[np.int8]) -> State:
        """The same with another status of every multiplier, (n,)."""
        return replace(self, status=status)


def at_rest(n_free: int, n_multipliers: int) -> State:
    """Nothing moved, nothing pressed, all open."""
    return State(0.0, np.zeros(n_free), np.zeros(n_multipliers), np.full(n_multipliers, OPEN))
