"""Shells of several layers (*SHELL SECTION, COMPOSITE): a solid for each, one on the other.

The lowest solid has the number of the shell's element, those on it have numbers of their own (``Deck.layers``), and sections
that say of what they are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.io.deck.record import Block, Deck, Faces, Numbers, Prescribed, Section
from abut.io.deck.time_histories import BODY_LOADS

NEGATIVE, POSITIVE = 1, 2  # faces S1, S2 of the solid that a shell becomes; those beyond are at its edges


def edges_of(section: Section) -> NDArray[np.float64]:
    """Where layers begin and end over the thickness, from 0 to 1."""
    if not section.layers:
        return np.array([0.0, 1.0])
    ends = np.cumsum([0.0, *(layer.thickness for layer in section.layers)])
    return np.asarray(ends / ends[-1])


def by_section(deck: Deck) -> Deck:
    """The deck with shells in blocks of one section each, where some have layers."""
    if not any(section.layers for section in deck.sections):
        return deck
    blocks: list[Block] = []
    for block in deck.blocks:
        inside = [np.isin(block.ids, section.elements) for section in deck.sections]
        if block.type.thin != "shell" or not any(here.any() for here in inside):
            blocks.append(block)
            continue
        left = ~np.any(inside, axis=0)
        blocks += [replace(block, ids=block.ids[i], nodes=block.nodes[i]) for i in (*inside, left) if i.any()]
    return replace(deck, blocks=tuple(blocks))


def with_layers(deck: Deck, blocks: Sequence[Block], upper: Sequence[Numbers]) -> Deck:
    """The deck with the solids of layers on the lowest ones. blocks: of shells; upper: for each the nodes (layers - 1, n, k)
    of these."""
    if not any(len(cells) for cells in upper):
        return deck
    kinds = {int(block.ids[0]): block.type for block in deck.blocks if len(block.ids)}
    taken = 1 + max(int(block.ids.max()) for block in deck.blocks if len(block.ids))
    stacks = dict(deck.layers)
    new: list[Block] = []
    for block, cells in zip(blocks, upper):
        for nodes in cells:
            ids = taken + np.arange(len(nodes))
            taken += len(nodes)
            new.append(replace(block, type=kinds[int(block.ids[0])], ids=ids, nodes=nodes))
            for below, number in zip(block.ids.tolist(), ids.tolist()):
                stacks[below] = (*stacks.get(below, (below,)), number)
    sections = [each for section in deck.sections for each in _sections(section, stacks)]
    return replace(
        deck,
        blocks=(*deck.blocks, *new),
        layers=stacks,
        sections=tuple(sections),
        surfaces={name: _of_surface(surface, stacks) for name, surface in deck.surfaces.items()},
        absences=tuple(replace(each, elements=_every(each.elements, stacks)) for each in deck.absences),
        steps=tuple(
            replace(step, values=tuple(each for value in step.values for each in _of_value(value, stacks)))
            for step in deck.steps
        ),
    )


def _sections(section: Section, stacks: Mapping[int, tuple[int, ...]]) -> list[Section]:
    """One for each layer."""
    if not section.layers:
        return [section]
    rows = np.array([stacks[number] for number in section.elements.tolist()], np.int64).reshape(-1, len(section.layers))
    return [
        replace(
            section, name=f"{section.name}-layer{i}", elements=np.sort(rows[:, i - 1]), material=layer.material,
            thickness=layer.thickness, orientation=layer.orientation, layers=(),
        )
        for i, layer in enumerate(section.layers, start=1)
    ]  # fmt: skip


def stacked(elements: Numbers, face: int, stacks: Mapping[int, tuple[int, ...]]) -> Numbers:
    """The solids of elements that have one of their faces."""
    if face == NEGATIVE or not stacks:
        return elements
    if face == POSITIVE:
        return np.array([stacks.get(number, (number,))[-1] for number in elements.tolist()], np.int64)
    return _every(elements, stacks)


def _every(elements: Numbers, stacks: Mapping[int, tuple[int, ...]]) -> Numbers:
    found = [n for number in elements.tolist() for n in stacks.get(number, (number,))]
    return np.array(found, np.int64)


def _of_surface(surface: Faces, stacks: Mapping[int, tuple[int, ...]]) -> Faces:
    return replace(surface, faces=tuple((stacked(elements, face, stacks), face) for elements, face in surface.faces))


def _of_value(value: Prescribed, stacks: Mapping[int, tuple[int, ...]]) -> list[Prescribed]:
    if value.kind in BODY_LOADS:
        return [replace(value, numbers=_every(value.numbers, stacks))]
    if value.kind == "pressure":
        return [replace(value, numbers=stacked(value.numbers, value.directions[0], stacks))]
    return [value]
