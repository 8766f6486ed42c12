"""The state of a problem at a time, converged or on trial. Nothing else is carried from step to step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from abut.contact.slip_points import Past
from abut.model.rates import Rates

Vector = NDArray[np.float64]
OPEN, CLOSED, SLIPPING = np.int8(0), np.int8(1), np.int8(2)  # status of a multiplier; closed with friction: stuck


@dataclass(frozen=True)
class ContactHistory:
    """What a contact remembers at a converged state.

    slips: (n, 4) of its multipliers, with friction: in the step that ended, in all steps in contact, what did not count in
    the step because it only came closer, and 1 where nothing did, for want of a past. The rest at large displacements only:
    past: from where the next step's slip counts; inner, following, fit: what was fixed during the step that ended, as in
    ``abut.problem.frame.PairFrame``; landed: forces of friction, as in ``abut.problem.step_error.Landed``. began: (n,) of a
    tie that begins on the way, jumps from which it holds."""

    slips: Vector | None = None
    past: Past | None = None
    inner: Vector | None = None
    following: NDArray[np.int64] | None = None
    fit: Vector | None = None
    landed: tuple[float, float] | None = None
    began: Vector | None = None


@dataclass(frozen=True)
class History:
    """What a state remembers of its past.

    arrays: (n_integration_points, k) of bodies by name, "bodies.pin": that of the term that owns them, and of its part;
    contacts: by name; drag: (n_free,) force that a drag has in it, where it was reached under one."""

    arrays: Mapping[str, Vector] = field(default_factory=dict)
    contacts: Mapping[str, ContactHistory] = field(default_factory=dict)
    drag: Vector | None = None

    def of(self, term: str) -> Mapping[str, Vector]:
        """The arrays of a term, by part."""
        return {
            name.partition(".")[2]: values for name, values in self.arrays.items() if name.partition(".")[0] == term
        }

    def contact(self, name: str) -> ContactHistory:
        """Of a contact, empty at the start."""
        return self.contacts.get(name, ContactHistory())

    def with_term(self, term: str, parts: Mapping[str, Vector]) -> History:
        """The same with a term's arrays replaced."""
        new = {f"{term}.{part}": values for part, values in parts.items()}
        return replace(self, arrays={**self.arrays, **new}) if parts else self


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
    and contacts; largest: over all converged states up to this one; rates: of the values of all fields at a converged state,
    None without a time integration.
    """

    time: float
    unknowns: Vector
    multipliers: Vector
    status: NDArray[np.int8]
    history: History = field(default_factory=History)
    largest: Largest = field(default_factory=Largest)
    rates: Rates | None = None

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
