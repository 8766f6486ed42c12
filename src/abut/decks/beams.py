"""Beams of a deck expanded into solids, as CalculiX does it: as shells are (``decks.thin``), with a rectangular section
or an elliptic one.

A node where turns are held or prescribed, or a moment acts, is a coupling of its section: the mean motion of its corners (at
large displacements, where turns are held, a rigid one)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.decks.solid_blocks import by_block, free_numbers, sections_of, with_solids
from abut.decks.thin import renamed
from abut.io.deck.reasons import DeckError, Place
from abut.io.deck.record import Block, Coupling, Deck, Equation, Numbers, Section, Thin
from abut.mesh.thin.beams import CORNERS, COUNT, Beam, Sections, expand_beams

CARD = "*BEAM SECTION"


def with_thick_beams(deck: Deck, finite: bool) -> Deck:
    """The deck with its beams expanded, its shells already are. ``finite``: at large displacements.

    Raises InputError for beams without a section or a length, and for nodes that shells have as well."""
    if not any(block.type.thin == "beam" for block in deck.blocks):
        return deck
    deck = replace(deck, blocks=tuple(part for block in deck.blocks for part in _round_apart(deck, block)))
    blocks = [block for block in deck.blocks if block.type.thin == "beam"]
    rows = np.concatenate([np.searchsorted(deck.nodes, _ordered(block)) for block in blocks])
    sections = [section for block in blocks for section in _sections(deck, block)]
    beam = Beam(
        rows,
        np.array([section.axis for section in sections]),
        np.array([section.widths for section in sections]),
        np.array([section.offsets for section in sections]),
        np.array([section.round for section in sections]),
    )
    try:
        solid = expand_beams(deck.points, beam)
    except ValueError as error:
        number = np.concatenate([block.ids for block in blocks])[error.args[0]]
        raise DeckError(
            blocks[0].place, f"*ELEMENT: beam {number} has no length, or lies along the first direction of its section"
        ) from None
    return _with_solids(deck, blocks, solid, finite)


def _ordered(block: Block) -> Numbers:
    """Nodes (n, 3) at start, end and middle of each element; decks list the middle second where it is theirs."""
    return block.nodes if block.code.startswith("B31") else block.nodes[:, [0, 2, 1]]


def _sections(deck: Deck, block: Block) -> list[Section]:
    result = sections_of(deck, block, "element", CARD)
    for number, section in zip(block.ids.tolist(), result):
        if not section.widths[0]:
            raise DeckError(block.place, f"*ELEMENT: element {number} without {CARD}; give its set a section")
    return result


def _round_apart(deck: Deck, block: Block) -> list[Block]:
    """Beams of round sections, where integration is reduced, as a block of their own with full integration, which
    ``element_notes`` says."""
    if block.type.thin != "beam" or block.type.integration != "reduced":
        return [block]
    curved = np.array([section.round for section in _sections(deck, block)])
    parts = [(curved, replace(block.type, integration="full")), (~curved, block.type)]
    return [replace(block, type=kind, ids=block.ids[on], nodes=block.nodes[on]) for on, kind in parts if on.any()]


def _with_solids(deck: Deck, blocks: list[Block], solid: Sections, finite: bool) -> Deck:
    number = free_numbers(deck, len(solid.points), [solid.cells])
    made: dict[
        int, list[Numbers]
    ] = {}  # node -> the eight nodes of each of its sections, -1 for those that are not there
    shares = dict(zip(deck.nodes[solid.node].tolist(), solid.shares))
    for i, point in enumerate(solid.node.tolist()):
        made.setdefault(int(deck.nodes[point]), []).append(number[COUNT * i : COUNT * (i + 1)])
    for node in made:
        if node in deck.thin or any(bound.reference == node for bound in deck.couplings):
            raise DeckError(
                blocks[0].place,
                f"*ELEMENT: node {node} belongs to a beam and a shell, or is a reference; join them by *TIE",
            )
    made_of = [("hex20", rows) for rows in by_block(blocks, solid.cells)]
    new = with_solids(deck, "beam", solid.points, number, made_of)
    new = renamed(new, {node: np.unique(np.concatenate(n)[np.concatenate(n) >= 0]) for node, n in made.items()}, {})
    held, turned = _turned(deck, ("boundary",)), _turned(deck, ("boundary", "force"))
    place = blocks[0].place
    bound = [
        _coupling(node, nodes, finite and node in held, place)
        for node, nodes in made.items()
        if len(nodes) > 1 or node in turned
    ]
    coupled = {coupling.reference for coupling in bound}
    thin = {node: Thin(tuple(nodes[0][: len(CORNERS)].tolist())) for node, nodes in made.items() if node not in coupled}
    straight = [
        equation
        for coupling in bound
        if coupling.distributing and coupling.reference in held
        for equation in _straight(made[coupling.reference][0], shares[coupling.reference], place)
    ]
    return replace(
        new,
        thin={**deck.thin, **thin},
        couplings=(*new.couplings, *bound),
        equations=(*deck.equations, *straight),
    )


def _straight(nodes: Numbers, shares: NDArray[np.float64], place: Place) -> list[Equation]:
    """The points of a section beside its corners go with these."""
    every, count = nodes.tolist(), len(CORNERS)
    return [
        Equation(((n, k, -1.0), *((c, k, w) for c, w in zip(every[:count], share) if w)), place)
        for n, share in zip(every[count:], shares[count:].tolist())
        if n >= 0
        for k in (1, 2, 3)
    ]


def _coupling(node: int, nodes: list[Numbers], rigid: bool, place: Place) -> Coupling:
    """One section by its mean; several, or one whose turns are held at large displacements, as a rigid body."""
    mean = len(nodes) == 1 and not rigid
    every = np.sort(nodes[0][: len(CORNERS)]) if mean else np.unique(np.concatenate(nodes)[np.concatenate(nodes) >= 0])
    name = f"section {node}" if mean else f"knot {node}"
    return Coupling(name, mean, node, "", every, frozenset(range(1, 7)), None, place)


def _turned(deck: Deck, kinds: tuple[str, ...]) -> set[int]:
    """Nodes with supports in turns ("boundary"), or moments ("force")."""
    every = [*deck.fixed, *(value for step in deck.steps for value in step.values)]
    return {
        node for value in every if value.kind in kinds and max(value.directions) > 3 for node in value.numbers.tolist()
    }
