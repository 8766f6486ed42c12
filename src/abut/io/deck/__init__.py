"""Abaqus and CalculiX input decks: ``read_deck`` for all of a deck, ``read_abaqus`` for its mesh.

The parser is abut's own: meshio's reads the mesh only and is no longer maintained."""

from abut.io.deck.groups import read_abaqus
from abut.io.deck.reader import read_deck
from abut.io.deck.record import Deck

__all__ = ["Deck", "read_abaqus", "read_deck"]
