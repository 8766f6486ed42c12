"""*MODEL CHANGE, TYPE=ELEMENT: elements that are not there, go, or come back."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from abut.io.deck.absence import Absence
from abut.io.deck.cards import Card, Line, key
from abut.io.deck.mesh_cards import MeshCards
from abut.io.deck.reasons import Reasons
from abut.io.deck.record import Deck, Faces, Numbers, Prescribed

ON_ELEMENTS = ("pressure", "gravity", "centrifugal")
STRAINED = "WITHSTRAIN"
EMPTY = np.empty(0, np.int64)


def of_elements(card: Card) -> bool:
    """Whether a *MODEL CHANGE is of elements."""
    return key(card.get("TYPE", "ELEMENT") or "") != "CONTACTPAIR"


def absences(groups: Sequence[Sequence[Card]], mesh: MeshCards, reasons: Reasons) -> tuple[Absence, ...]:
    """Elements that steps take out and bring back, those together that do so in the same steps; ``groups``: the cards of
    each step. ``reasons`` gets what is no such thing."""
    spans: dict[int, list[list[int]]] = {}  # of each element: the step from which on it is away, and that of its return
    strained: set[int] = set()
    for number, group in enumerate(groups):
        for card in group:
            if card.key == "MODELCHANGE" and of_elements(card):
                with reasons.gathered():
                    for element, line in _members(card, mesh):
                        _note(spans.setdefault(element, []), number, card, line, element)
                        strained |= {element} if key(card.get("ADD") or "") == STRAINED else set()
    alike: dict[tuple[bool, tuple[tuple[int, ...], ...]], list[int]] = {}
    for element, found in spans.items():
        alike.setdefault((element in strained, tuple(map(tuple, found))), []).append(element)
    return tuple(
        Absence(np.array(sorted(members), np.int64), found, with_strain)
        for (with_strain, found), members in alike.items()
        if found
    )


def _members(card: Card, mesh: MeshCards) -> Iterator[tuple[int, Line]]:
    if card.has("REMOVE") == card.has("ADD"):
        raise card.error("expected one of ADD and REMOVE")
    if key(card.get("ADD") or STRAINED) not in (STRAINED, "STRAINFREE"):
        raise card.error(f"ADD={card.get('ADD')}: expected STRAIN FREE, WITH STRAIN, or no value")
    for line in card.lines:
        for i, text in enumerate(line.fields):
            for element in mesh.element_sets.resolve(line, i, "element").tolist() if text else ():
                if element not in mesh.kinds:
                    raise line.unknown(f"element {element} does not exist")
                yield element, line


def _note(found: list[list[int]], step: int, card: Card, line: Line, element: int) -> None:
    away = bool(found) and len(found[-1]) == 1
    if card.has("REMOVE") and not away:
        found.append([step])
    elif card.has("ADD") and away and found[-1][0] < step:
        found[-1].append(step)
    elif card.has("ADD") and not away:
        raise line.error(f"element {element} is there already; take it out of the line")
    elif card.has("ADD"):
        raise line.error(f"element {element} is taken out and brought back in one step; give one of them")


def gone(found: Sequence[Absence]) -> Numbers:
    """Elements that the first step takes out for good."""
    return np.unique(np.concatenate([EMPTY, *(absence.elements for absence in found if absence.spans == ((0,),))]))


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
