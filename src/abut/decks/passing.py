"""*MODEL CHANGE, TYPE=ELEMENT, and *CHANGE SURFACE BEHAVIOR: bodies that go between steps, or come; glue that does."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from abut.io.deck.groups import Piece
from abut.io.deck.record import Deck, Pair
from abut.io.deck.time_histories import ends
from abut.model import Contact, Removal


def in_span(deck: Deck, pair: Pair, contact: Contact) -> Contact:
    """A contact that acts in the steps of its pair alone, at once from their begin and to their end."""
    if pair.span is None:
        return contact
    starts, (first, after) = (0.0, *ends(deck)), pair.span
    return replace(contact, since=starts[first - 1], until=None if after is None else starts[after - 1])


def removals(deck: Deck, parts: Mapping[str, Piece]) -> Iterator[Removal]:
    """Of the bodies, by name: at once as a step begins, and back without strain or with it, as in CalculiX."""
    starts = (0.0, *ends(deck))
    for absence in deck.absences:
        for name, piece in parts.items():
            if np.isin(piece.elements, absence.elements).all():
                for away, *back in absence.spans:
                    since = starts[back[0]] if back else None
                    yield Removal(name, starts[away], since=since, strained=absence.strained)


def passing_notes(deck: Deck) -> list[str]:
    """That elements come back without strain."""
    back = [a for a in deck.absences if any(len(span) > 1 for span in a.spans) and not a.strained]
    count = sum(len(absence.elements) for absence in back)
    return [f"*MODEL CHANGE: {count} elements come back without strain, where their nodes are then"] if back else []
