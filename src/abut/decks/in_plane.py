"""Beams and trusses in the plane of x and y, B21 and T2D2: those of space whose nodes stay in it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from abut.io.deck.record import Deck, Prescribed

HELD = {"B21": (3, 4, 5), "T2D2": (3,)}  # directions of their nodes


def with_planes_held(deck: Deck) -> Deck:
    """The deck with supports that hold the nodes of such elements in the plane."""
    held = [
        Prescribed("boundary", np.unique(block.nodes), (direction,), 0.0, "", block.place)
        for block in deck.blocks
        for direction in HELD.get(block.code, ())
    ]
    return replace(deck, fixed=(*deck.fixed, *held)) if held else deck
