"""*CHANGE SOLID SECTION: elements of another material from a step on.

Its stress is that of all strain, as in CalculiX. So there are elements of both materials, of which the first go as the step
begins, and the others come, strained; the nodes of these are others in the same places, which move as the first do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from abut.io.deck.absence import Absence
from abut.io.deck.cards import Card, of
from abut.io.deck.mesh_cards import MeshCards
from abut.io.deck.reasons import Place, Reasons
from abut.io.deck.record import Deck, Equation, Material, Numbers, Prescribed, Section
from abut.io.deck.section_cards import section_of
from abut.io.deck.time_histories import BODY_LOADS

CARD = "CHANGESOLIDSECTION"


def with_changed_sections(
    deck: Deck, groups: Sequence[Sequence[Card]], mesh: MeshCards, known: Mapping[str, Material], reasons: Reasons
) -> Deck:
    """The deck with elements of the other materials; ``groups``: the cards of each step. ``reasons`` gets changes of what is
    not elastic, not solid, goes itself, changes twice or has faces that are pressed or touch."""
    for number, group in enumerate(groups):
        for card in of(group, CARD):
            with reasons.gathered():
                deck = _changed(deck, card, section_of(card, mesh, known), number)
    return deck


def _changed(deck: Deck, card: Card, section: Section, step: int) -> Deck:
    _check(deck, card, section)
    if not step:
        return replace(deck, sections=(*_without(deck.sections, section.elements), section))
    first = 1 + max(
        int(numbers.max()) for numbers in (*(b.ids for b in deck.blocks), *deck.element_sets.values()) if len(numbers)
    )
    old = np.unique(section.elements)
    new = first + np.arange(len(old))
    used = np.unique(np.concatenate([block.nodes[np.isin(block.ids, old)].ravel() for block in deck.blocks]))
    taken = [int(deck.nodes.max()), *deck.references, *(cut.node for cut in deck.pretension)]
    twins = 1 + max(taken) + np.arange(len(used))
    blocks = []
    for block in deck.blocks:
        here = np.isin(block.ids, old)
        if here.any():
            ids = new[np.searchsorted(old, block.ids[here])]
            blocks.append(replace(block, ids=ids, nodes=twins[np.searchsorted(used, block.nodes[here])]))
    steps = tuple(replace(s, values=tuple(_on_both(v, old, new) for v in s.values)) for s in deck.steps)
    return replace(
        deck,
        nodes=np.concatenate([deck.nodes, twins]),
        points=np.concatenate([deck.points, deck.points[np.searchsorted(deck.nodes, used)]]),
        blocks=(*deck.blocks, *blocks),
        equations=(*deck.equations, *_together(twins, used, card.place)),
        sections=(*deck.sections, replace(section, name=f"{section.name}-{section.material.name}", elements=new)),
        absences=(*deck.absences, Absence(old, ((step,),)), Absence(new, ((0, step),), strained=True)),
        steps=steps,
    )


def _together(twins: Numbers, nodes: Numbers, place: Place) -> list[Equation]:
    pairs = zip(twins.tolist(), nodes.tolist())
    return [Equation(((twin, k, 1.0), (node, k, -1.0)), place) for twin, node in pairs for k in (1, 2, 3)]


def _without(sections: Sequence[Section], elements: Numbers) -> list[Section]:
    left = [replace(s, elements=np.setdiff1d(s.elements, elements)) for s in sections]
    return [section for section in left if len(section.elements)]


def _on_both(value: Prescribed, old: Numbers, new: Numbers) -> Prescribed:
    if value.kind not in BODY_LOADS:
        return value
    return replace(value, numbers=np.concatenate([value.numbers, new[np.isin(old, value.numbers)]]))


def _check(deck: Deck, card: Card, section: Section) -> None:
    elements = section.elements
    owners = [s for s in deck.sections if np.isin(s.elements, elements).any()]
    if deck.general is not None:
        raise card.error("with contact of all surfaces elements do not change; name the surfaces in *CONTACT PAIR")
    if any(block.type.thin and np.isin(block.ids, elements).any() for block in deck.blocks):
        raise card.error("shells and beams that change are not supported; make a deck for each state")
    if any(s.material.hardening or s.material.rubber for s in (section, *owners)):
        raise card.error(
            "materials with *PLASTIC or *HYPERELASTIC that change are not supported; make a deck for each state"
        )
    if any(np.isin(absence.elements, elements).any() for absence in deck.absences):
        raise card.error("elements that change twice, or go and change, are not supported; make a deck for each state")
    pressed = [v.numbers for step in deck.steps for v in step.values if v.kind == "pressure"]
    touching = [numbers for surface in deck.surfaces.values() for numbers, _ in surface.faces]
    if any(np.isin(numbers, elements).any() for numbers in (*pressed, *touching)):
        raise card.error("elements that change have no pressures or surfaces here; load their nodes by *CLOAD")
