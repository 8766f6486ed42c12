"""Frequencies and buckling loads that a deck asks for."""

from __future__ import annotations

from dataclasses import replace

from abut.decks.large import is_finite
from abut.io.deck.groups import Groups
from abut.io.deck.record import Block, Deck
from abut.io.deck.sectors import turned_side
from abut.io.deck.time_histories import ends
from abut.model import Buckling, Frequencies


def modes(deck: Deck, groups: Groups) -> tuple[Frequencies | Buckling, ...]:
    """Of the steps that ask for them. Raises InputError for sectors of which no nodal diameters but 0 are found."""
    if deck.modes is None:
        return ()
    if deck.modes.kind == "BUCKLE":
        return (Buckling(deck.modes.count),)
    wanted = Frequencies(deck.modes.count, stiffening=deck.modes.loaded)
    if any(deck.modes.diameters):
        side = groups.node_set(turned_side(deck, groups), "sector-side")
        wanted = replace(wanted, diameters=deck.modes.diameters, sectors=deck.cyclic[0].sectors, side=side)
    return (replace(wanted, time=ends(deck)[0]), wanted) if deck.modes.unloaded else (wanted,)


def loading_notes(deck: Deck) -> list[str]:
    """What CalculiX adds to the stiffness about a loaded state, and abut does not."""
    if deck.modes is None or not deck.modes.loaded:
        return []
    if is_finite(deck) or not any(value.kind == "pressure" for step in deck.steps for value in step.values):
        return []
    return [
        f"{deck.steps[-1].place}: *FREQUENCY: pressures keep their direction as the loaded state vibrates, CalculiX "
        "lets them turn"
    ]


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
