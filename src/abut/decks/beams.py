"""Beams of a deck expanded into solids, as CalculiX does it: as shells are (``decks.thin``), over sections of
several forms; hollow ones take a ring of solids.

A node where turns are held or prescribed, or a moment acts, is a coupling of its section: the mean motion of its corners (at
large displacements, where turns are held, a rigid one)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.decks.rings import in_rings
from abut.decks.solid_blocks import by_block, free_numbers, sections_of, with_solids
from abut.decks.thin import at_nodes, renamed
from abut.io.deck.reasons import DeckError, Place
from abut.io.deck.record import Block, Coupling, Deck, Equation, Numbers, Section
from abut.io.deck.thin_record import Thin
from abut.mesh.thin.beams import Beam, Sections, expand_beams

CARD = "*BEAM SECTION"
Made = tuple[Numbers, NDArray[np.float64]]  # a section: its nodes, -1 for those that are not there, and their shares


def with_thick_beams(deck: Deck, finite: bool) -> Deck:
    """The deck with its beams expanded, its shells already are. ``finite``: at large displacements.

    Raises InputError for beams without a section or a length, for nodes that shells have as well, and for pressures and
    surfaces on numbered faces of hollow ones."""
    if not any(block.type.thin == "beam" for block in deck.blocks):
        return deck
    deck = replace(deck, blocks=tuple(part for block in deck.blocks for part in _apart(deck, block)))
    beams = [block for block in deck.blocks if block.type.thin == "beam"]
    forms: dict[str, list[Block]] = {}
    for block in beams:
        forms.setdefault(_sections(deck, block)[0].form, []).append(block)
    solids = [_solid(deck, blocks) for blocks in forms.values()]
    starts = np.cumsum([0, *(len(solid.points) for solid in solids)]).tolist()
    cells = [
        rows
        for solid, blocks, start in zip(solids, forms.values(), starts)
        for rows in by_block(blocks, solid.cells + start)
    ]
    points = np.concatenate([solid.points for solid in solids])
    number = free_numbers(deck, len(points), cells)
    made: dict[int, list[Made]] = {}
    for solid, start in zip(solids, starts):
        each = number[start : start + len(solid.points)].reshape(len(solid.node), -1)
        for node, nodes, shares in zip(deck.nodes[solid.node].tolist(), each, solid.shares):
            made.setdefault(node, []).append((nodes, shares))
    order = [block for blocks in forms.values() for block in blocks]
    by_place = {id(block): rows for block, rows in zip(order, cells)}
    deck, rows = in_rings(deck, [by_place[id(block)] for block in beams])
    new = with_solids(deck, "beam", points, number, [("hex20", each) for each in rows])
    return _bound(deck, new, made, beams[0].place, finite)


def _ordered(block: Block) -> Numbers:
    """Nodes (n, 3) at start, end and middle of each element; decks list the middle second where it is theirs."""
    return block.nodes if block.code.startswith(("B31", "B21")) else block.nodes[:, [0, 2, 1]]


def _sections(deck: Deck, block: Block) -> list[Section]:
    result = sections_of(deck, block, "element", CARD)
    for number, section in zip(block.ids.tolist(), result):
        if not section.widths[0] and not section.nodal:
            raise DeckError(block.place, f"*ELEMENT: element {number} without {CARD}; give its set a section")
    return result


def _apart(deck: Deck, block: Block) -> list[Block]:
    """Beams of each form of section as a block of their own; ellipses integrate fully, as ``element_notes`` says."""
    if block.type.thin != "beam":
        return [block]
    forms = np.array([section.form for section in _sections(deck, block)])
    return [
        replace(
            block,
            type=replace(block.type, integration="full") if form == "ellipse" else block.type,
            ids=block.ids[forms == form],
            nodes=block.nodes[forms == form],
        )
        for form in dict.fromkeys(forms.tolist())
    ]


def _solid(deck: Deck, blocks: list[Block]) -> Sections:
    """The solids of blocks of one form."""
    sections = [section for block in blocks for section in _sections(deck, block)]
    beam = Beam(
        np.concatenate([np.searchsorted(deck.nodes, _ordered(block)) for block in blocks]),
        np.array([section.axis for section in sections]),
        np.concatenate([_widths(deck, block) for block in blocks]),
        np.array([section.offsets for section in sections]),
        np.array([section.walls for section in sections]),
        sections[0].form,
    )
    try:
        return expand_beams(deck.points, beam)
    except ValueError as error:
        number = np.concatenate([block.ids for block in blocks])[error.args[0]]
        raise DeckError(
            blocks[0].place, f"*ELEMENT: beam {number} has no length, or lies along the first direction of its section"
        ) from None


def _widths(deck: Deck, block: Block) -> NDArray[np.float64]:
    """(n, 3, 2) at start, end and middle of each element: those of its section, or of its nodes."""
    ordered = replace(block, nodes=_ordered(block))
    sections = _sections(deck, block)
    nodal = np.array([section.nodal for section in sections])
    own = np.array([section.widths for section in sections])[:, None]
    return np.where(nodal[:, None, None], at_nodes(deck, ordered, nodal), own)


def _bound(deck: Deck, new: Deck, made: Mapping[int, list[Made]], place: Place, finite: bool) -> Deck:
    """``new`` with what the nodes of beams are for solids. made: of each node its sections."""
    references = {bound.reference: bound for bound in deck.couplings}
    for node in sorted(made.keys() & references.keys()):
        if not references[node].thin:
            raise DeckError(
                place,
                f"*ELEMENT: node {node} belongs to a beam and is the reference of a coupling ({references[node].place}); "
                "give the coupling a node of its own, and join both by *RIGID BODY",
            )
    shared = {node: deck.thin[node].own for node in made.keys() & deck.thin.keys()}
    shared |= {node: tuple(references[node].nodes.tolist()) for node in made.keys() & references.keys()}
    knots = [_knot(node, made[node], nodes, place) for node, nodes in shared.items()]
    new = renamed(new, {node: _all(sections) for node, sections in made.items()}, {})
    made = {node: sections for node, sections in made.items() if node not in shared}
    held, turned = _turned(deck, ("boundary",)), _turned(deck, ("boundary", "force"))
    bound = [
        _coupling(node, sections, finite and node in held, place)
        for node, sections in made.items()
        if len(sections) > 1 or node in turned
    ]
    coupled = {coupling.reference for coupling in bound}
    thin = {node: Thin(tuple(_corners(s[0]).tolist())) for node, s in made.items() if node not in coupled}
    straight = [
        equation
        for coupling in bound
        if coupling.distributing and coupling.reference in held
        for equation in _straight(*made[coupling.reference][0], place)
    ]
    return replace(
        new,
        thin={**{node: each for node, each in deck.thin.items() if node not in shared}, **thin},
        couplings=(*(each for each in new.couplings if each.reference not in shared), *knots, *bound),
        equations=(*deck.equations, *straight),
    )


def _corners(section: Made) -> Numbers:
    return section[0][: section[1].shape[1]]


def _all(sections: list[Made]) -> Numbers:
    nodes = np.concatenate([nodes for nodes, _ in sections])
    return np.unique(nodes[nodes >= 0])


def _straight(nodes: Numbers, shares: NDArray[np.float64], place: Place) -> list[Equation]:
    """The points of a section beside its corners go with these."""
    every, count = nodes.tolist(), shares.shape[1]
    return [
        Equation(((n, k, -1.0), *((c, k, w) for c, w in zip(every[:count], share) if w)), place)
        for n, share in zip(every[count:], shares[count:].tolist())
        if n >= 0
        for k in (1, 2, 3)
    ]


def _coupling(node: int, sections: list[Made], rigid: bool, place: Place) -> Coupling:
    """One section by its mean; several, or one whose turns are held at large displacements, as a rigid body."""
    mean = len(sections) == 1 and not rigid
    every = np.sort(_corners(sections[0])) if mean else _all(sections)
    name = f"section {node}" if mean else f"knot {node}"
    return Coupling(name, mean, node, "", every, frozenset(range(1, 7)), None, place, thin=True)


def _knot(node: int, sections: list[Made], others: tuple[int, ...], place: Place) -> Coupling:
    """Of the sections of beams at a node and what stands for it in shells (``others``): a rigid body, as in CalculiX."""
    every = np.union1d(_all(sections), others)
    return Coupling(f"knot {node}", False, node, "", every, frozenset(range(1, 7)), None, place, thin=True)


def _turned(deck: Deck, kinds: tuple[str, ...]) -> set[int]:
    """Nodes with supports in turns ("boundary"), or moments ("force")."""
    every = [*deck.fixed, *(value for step in deck.steps for value in step.values)]
    return {
        node for value in every if value.kind in kinds and max(value.directions) > 3 for node in value.numbers.tolist()
    }
