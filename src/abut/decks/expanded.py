"""Shells, beams and trusses of a deck as solids."""

from __future__ import annotations

from abut.decks.beams import with_thick_beams
from abut.decks.shell_edges import quadratic
from abut.decks.thin import with_thick_shells
from abut.decks.trusses import with_thick_trusses
from abut.io.deck.record import Deck


def expanded(deck: Deck, finite: bool) -> Deck:
    """The deck with solids in place of shells, beams and trusses. ``finite``: at large displacements.

    Raises InputError for what has no section or no size, and for what cannot be said of solids."""
    return with_thick_trusses(with_thick_beams(with_thick_shells(quadratic(deck), finite), finite))
