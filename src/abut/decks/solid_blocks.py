"""What expanding shells, beams and trusses of a deck has in common: sections of elements, and solids in their place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Block, Deck, Numbers, Section


def sections_of(deck: Deck, block: Block, what: str, card: str) -> list[Section]:
    """Of each element of a block. Raises InputError for one that no ``card`` names; what: it is called in the message."""
    by_number = {number: section for section in deck.sections for number in section.elements.tolist()}
    for number in block.ids.tolist():
        if number not in by_number:
            raise DeckError(block.place, f"*ELEMENT: {what} {number} without {card}; give its set a section")
    return [by_number[number] for number in block.ids.tolist()]


def free_numbers(deck: Deck, n_points: int, cells: Sequence[Numbers]) -> Numbers:
    """Numbers (n_points,) that no node of the deck has, for the points of new cells (rows of points), -1 for others."""
    used = np.unique(np.concatenate([rows.ravel() for rows in cells]))
    taken = [int(deck.nodes.max()), *deck.references, *(section.node for section in deck.pretension)]
    number = np.full(n_points, -1, np.int64)
    number[used] = max(taken) + 1 + np.arange(len(used))
    return number


def with_solids(
    deck: Deck, thin: str, points: NDArray[np.float64], number: Numbers, cells: Sequence[tuple[str, Numbers]]
) -> Deck:
    """The deck with solid cells (kind, rows of points) in place of each block of ``thin`` elements, and with the points
    (n, 3) that have a ``number``."""
    new = number >= 0
    made = iter(cells)

    def solid(block: Block) -> Block:
        kind, rows = next(made)
        return replace(block, type=replace(block.type, kind=kind, thin=""), nodes=number[rows])

    return replace(
        deck,
        nodes=np.concatenate([deck.nodes, number[new]]),
        points=np.concatenate([deck.points, points[new]]),
        blocks=tuple(solid(block) if block.type.thin == thin else block for block in deck.blocks),
    )


def by_block(blocks: Sequence[Block], cells: Numbers) -> list[Numbers]:
    """Rows of cells, one for each element, of each block."""
    return np.split(cells, np.cumsum([len(block.ids) for block in blocks])[:-1])
