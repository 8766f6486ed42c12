"""Frequencies and buckling loads that a deck asks for."""

from __future__ import annotations

from abut.io.deck.record import Deck
from abut.model import Buckling, Frequencies


def modes(deck: Deck) -> tuple[Frequencies | Buckling, ...]:
    """Of its last step."""
    if deck.modes is None:
        return ()
    if deck.modes.kind == "BUCKLE":
        return (Buckling(deck.modes.count),)
    return (Frequencies(deck.modes.count, stiffening=deck.modes.loaded),)
