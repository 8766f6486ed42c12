"""Elements of a deck that take several solids each, which share what was said of the element."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Block, Deck, Faces, Numbers, Prescribed, Section
from abut.io.deck.time_histories import BODY_LOADS


def in_rings(deck: Deck, cells: Sequence[Numbers]) -> tuple[Deck, list[Numbers]]:
    """The deck with a block for each of the solids of a beam, and their cells. cells: of each block of beams
    (n, c, nodes); the first solid keeps the element's number, others get free ones, in its sets, sections and body loads.

    Raises InputError for pressures and surfaces on numbered faces of such elements."""
    most = max(int(block.ids.max()) for block in deck.blocks)
    blocks, rows, others, left = list[Block](), list[Numbers](), dict[int, list[int]](), iter(cells)
    for block in deck.blocks:
        own = next(left) if block.type.thin == "beam" else None
        blocks.append(block)
        if own is None:
            continue
        rows.append(own[:, 0])
        for k in range(1, own.shape[1]):
            ids = most + 1 + np.arange(len(block.ids))
            most += len(ids)
            blocks.append(replace(block, ids=ids))
            rows.append(own[:, k])
            for element, more in zip(block.ids.tolist(), ids.tolist()):
                others.setdefault(element, []).append(more)
    return (_told(replace(deck, blocks=tuple(blocks)), others) if others else deck), rows


def _told(deck: Deck, others: dict[int, list[int]]) -> Deck:
    """With the other solids of elements wherever those are named."""
    several = np.array(sorted(others), np.int64)

    def every(elements: Numbers) -> Numbers:
        more = [n for e in elements[np.isin(elements, several)].tolist() for n in others[e]]
        return np.concatenate([elements, np.array(more, elements.dtype)])

    def of_value(value: Prescribed) -> Prescribed:
        if value.kind == "pressure" and np.isin(value.numbers, several).any():
            raise DeckError(value.place, f"*DLOAD: faces of hollow beams have no numbers; {_INSTEAD}")
        return replace(value, numbers=every(value.numbers)) if value.kind in BODY_LOADS else value

    def of_surface(surface: Faces) -> Faces:
        for elements, face in surface.faces:
            if face and np.isin(elements, several).any():
                raise DeckError(surface.place, f"*SURFACE: faces of hollow beams have no numbers; {_INSTEAD}")
        return replace(surface, faces=tuple((every(elements), face) for elements, face in surface.faces))

    def of_section(section: Section) -> Section:
        return replace(section, elements=every(section.elements))

    return replace(
        deck,
        sections=tuple(map(of_section, deck.sections)),
        element_sets={name: every(elements) for name, elements in deck.element_sets.items()},
        surfaces={name: of_surface(surface) for name, surface in deck.surfaces.items()},
        steps=tuple(replace(step, values=tuple(map(of_value, step.values))) for step in deck.steps),
    )


_INSTEAD = "name the element without a face, for all its free ones"
