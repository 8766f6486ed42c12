"""Contacts that carry nothing: the certificate's line "carries"."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from abut.model import Model
from abut.model.contact import TWO_WAY
from abut.model.offset import smallest_offset
from abut.solution.contacts import Check, ContactResult

NOTHING = 1e-6  # pressure over the largest of the model that is taken for none
AMONG_OTHERS, ALONE, THOUGH_FIT = (
    0.25,
    0.5,
    1.0,
)  # nothing is carried while others carry; by any; in spite of an interference
WORTH_KNOWING, WRONG = 0.4, 0.75


def idle_contacts(model: Model, steps: Sequence[Sequence[ContactResult]]) -> Iterator[Check]:
    """A line for each contact that carried nothing in any step. It passes beside contacts that carried, is a warning
    where none did, and fails where an interference is larger than what the sides stand off each other in the end.

    steps: the contacts of each."""
    pairs = [(k, contact) for k, contact in enumerate(steps[-1]) if not _holds(model, contact.name)]
    most = {contact.name: max(abs(step[k].max_pressure) for step in steps) for k, contact in pairs}
    largest = max(most.values(), default=0.0)
    for _, result in pairs:
        if most[result.name] > NOTHING * largest:
            continue
        offset = next((smallest_offset(c) for c in model.contacts if c.name == result.name), 0.0)
        gap = float(np.nanmin(result.gap, initial=np.inf))
        fit = offset < 0.0 and gap < -offset
        value = THOUGH_FIT if fit else AMONG_OTHERS if largest > 0.0 else ALONE
        apart = f"; its sides stay {gap:.3g} apart" if np.isfinite(gap) else "; its sides never face each other"
        wanted = f" in spite of an interference of {-offset:.3g}" if fit else ""
        yield Check(
            result.name,
            "carries",
            value,
            WRONG,
            f"above 0: no pressure in any step{wanted}{apart}",
            notice=WORTH_KNOWING,
        )


def _holds(model: Model, name: str) -> bool:
    """Whether it pulls as it pushes, and may carry nothing."""
    return any(contact.name == name and contact.kind in TWO_WAY for contact in model.contacts)
