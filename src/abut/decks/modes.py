"""Frequencies and buckling loads that a deck asks for."""

from __future__ import annotations

from dataclasses import replace

from abut.io.deck.record import Block, Deck
from abut.model import Buckling, Frequencies


def modes(deck: Deck) -> tuple[Frequencies | Buckling, ...]:
    """Of its last step."""
    if deck.modes is None:
        return ()
    if deck.modes.kind == "BUCKLE":
        return (Buckling(deck.modes.count),)
    return (Frequencies(deck.modes.count, stiffening=deck.modes.loaded),)


def with_stiff_beams(deck: Deck) -> Deck:
    """The deck with its beams fully integrated where it asks for modes: single cells with less have motions that no
    stiffness resists, which would be the lowest modes."""
    if deck.modes is None:
        return deck
    return replace(deck, blocks=tuple(map(_stiff, deck.blocks)))


def _stiff(block: Block) -> Block:
    if block.type.thin != "beam" or block.type.integration == "full":
        return block
    why = "full integration (C3D20) for modes: with less, single cells have motions without stiffness"
    told = f"{block.type.instead}; {why}" if block.type.instead else why
    return replace(block, type=replace(block.type, integration="full", instead=told))
