"""*MODEL CHANGE, TYPE=ELEMENT, REMOVE in the first step: elements that are not there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from abut.io.deck.cards import Card, key
from abut.io.deck.mesh_cards import MeshCards
from abut.io.deck.reasons import Reasons
from abut.io.deck.record import Deck, Faces, Numbers, Prescribed

ON_ELEMENTS = ("pressure", "gravity", "centrifugal")
EMPTY = np.empty(0, np.int64)


def of_elements(card: Card) -> bool:
    """Whether a *MODEL CHANGE is of elements."""
    return key(card.get("TYPE", "ELEMENT") or "") != "CONTACTPAIR"


def removed(groups: Sequence[Sequence[Card]], mesh: MeshCards, reasons: Reasons) -> Numbers:
    """Numbers of the elements that the first step takes out; ``groups``: the cards of each step. ``reasons`` gets elements
    that come or go later."""
    result: list[Numbers] = [EMPTY]
    for number, group in enumerate(groups):
        for card in group:
            if card.key != "MODELCHANGE" or not of_elements(card):
                continue
            with reasons.gathered():
                if number or not card.has("REMOVE") or card.has("ADD"):
                    raise card.error(
                        "elements that come, or that go after the first step, are not supported; make a deck for each state"
                    )
                for line in card.lines:
                    for i, text in enumerate(line.fields):
                        members = mesh.element_sets.resolve(line, i, "element") if text else EMPTY
                        for element in members.tolist():
                            if element not in mesh.kinds:
                                raise line.unknown(f"element {element} does not exist")
                        result.append(members)
    return np.unique(np.concatenate(result))


def without(deck: Deck, gone: Numbers) -> Deck:
    """The deck without these elements, their faces and the loads on them, with a note."""
    if not len(gone):
        return deck
    blocks = []
    for block in deck.blocks:
        kept = ~np.isin(block.ids, gone)
        blocks += [replace(block, ids=block.ids[kept], nodes=block.nodes[kept])] if kept.any() else []
    sections = tuple(replace(s, elements=np.setdiff1d(s.elements, gone)) for s in deck.sections)
    return replace(
        deck,
        blocks=tuple(blocks),
        element_sets={name: np.setdiff1d(members, gone) for name, members in deck.element_sets.items()},
        sections=tuple(section for section in sections if len(section.elements)),
        surfaces={name: _faces(surface, gone) for name, surface in deck.surfaces.items()},
        rigid=tuple(replace(body, elements=np.setdiff1d(body.elements, gone)) for body in deck.rigid),
        steps=tuple(replace(step, values=_left(step.values, gone)) for step in deck.steps),
        notes=(*deck.notes, f"*MODEL CHANGE: {len(gone)} elements are taken out from the beginning on"),
    )


def _faces(surface: Faces, gone: Numbers) -> Faces:
    return replace(surface, faces=tuple((np.setdiff1d(elements, gone), face) for elements, face in surface.faces))


def _left(values: Sequence[Prescribed], gone: Numbers) -> tuple[Prescribed, ...]:
    made = [replace(v, numbers=np.setdiff1d(v.numbers, gone)) if v.kind in ON_ELEMENTS else v for v in values]
    return tuple(value for value in made if len(value.numbers))
