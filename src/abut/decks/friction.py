"""Friction of a deck's contact as the options of a contact."""

from __future__ import annotations

from collections.abc import Sequence

from abut.io.deck.record import Deck, Friction
from abut.io.deck.time_histories import RAMP, ends
from abut.model import Amplitude, Contact
from abut.types import Json


def path_notes(contacts: Sequence[Contact]) -> list[str]:
    """A note where the result depends on increments, which are not read."""
    if not any(contact.frictional for contact in contacts):
        return []
    return [
        "friction: each step of the deck is one load step, whatever its increments; where the way of the loads matters "
        "within a step, convert the deck and give solve.times"
    ]


def friction_options(deck: Deck, friction: Friction) -> Json:
    """The keys of ``Contact``. A coefficient that changes does so at the beginning of its step."""
    if not friction.changes or not isinstance(friction.value, float):
        return {"friction": friction.value}
    starts = (0.0, *ends(deck)[:-1])
    points = [(0.0, friction.value)]
    for step, value in friction.changes:
        start = starts[step - 1]
        jump = start + RAMP * (ends(deck)[step - 1] - start)
        points = [p for p in points if p[0] < start] + [(start, points[-1][1]), (jump, value)]
    largest = max(value for _, value in points)
    if largest == 0.0:
        return {"friction": 0.0}
    return {"friction": largest, "friction_amplitude": Amplitude(tuple((t, value / largest) for t, value in points))}
