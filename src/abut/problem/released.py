"""Contacts and ties that let go on the way: their last forces, taken off in a straight line; theory (L18)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from abut.model import Contact, Model
from abut.model.step_ends import SAME
from abut.problem.linearised import Linearised
from abut.problem.terms import Motion, Share
from abut.solution.state import History, State
from abut.types import Array


@dataclass(frozen=True)
class Released:
    """Contacts that act for a part of the time; its history: of each that is taken off slowly, by name, the nodal forces
    (n_points, dim) on both sides when it acted last."""

    contacts: Sequence[Contact]
    name: str = "released"
    constant: bool = False

    @classmethod
    def of(cls, model: Model) -> Released | None:
        """None where all contacts act all the time."""
        found = [contact for contact in model.contacts if not contact.times.always]
        return cls(found) if found else None

    def evaluate(self, before: Motion, now: Motion) -> Share:
        """As in ``Term``: no stiffness; its history stays until a state is converged."""
        force = np.zeros_like(now.displacement)
        for contact in self.contacts:
            left, kept = contact.times.left(now.time), before.history.get(contact.name)
            if left > 0.0 and kept is not None:
                force -= left * kept.ravel()
        return Share(force, None, before.history)

    def remembered(self, history: History, state: State, system: Linearised) -> History:
        """The history of a converged state, near which the problem is ``system``: with the forces of what acts there."""
        forces: dict[str, Array] = {}
        slow = {
            contact.name: contact.times for contact in self.contacts if contact.times.gone > contact.times.last + SAME
        }
        for pair, multipliers in zip(system.pairs, system.split(state.multipliers)):
            times = slow.get(pair.contact.name)
            if times is not None and state.time <= times.last + SAME:
                forces[pair.contact.name] = (pair.rows.T @ multipliers).reshape(-1, pair.contactor.dim)
        return history.with_term(self.name, forces)
