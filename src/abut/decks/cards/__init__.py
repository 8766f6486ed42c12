"""Abaqus and CalculiX input decks: ``read_deck`` for all of a deck, ``read_abaqus`` for its mesh.

The parser is abut's own: meshio's reads the mesh only and is no longer maintained."""

from abut.decks.cards.groups import read_abaqus
from abut.decks.cards.reader import read_deck
from abut.decks.cards.record import Deck

__all__ = ["Deck", "read_abaqus", "read_deck"]
