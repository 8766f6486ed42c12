"""Membranes of a deck expanded into solids, as CalculiX does it: one for each element, which shares no node with others.

At each node of the membrane the mean of bottom and top is the same for all elements there, and the displacement of the node:
a hinge (CalculiX CrunchiX manual, "Membrane elements"). So the elements carry forces in their plane, and no moments from
one to the next. Nodes between bottom and top stay halfway, so that forces at the nodes are even stresses (in CalculiX they
are free)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from abut.decks.solid_blocks import free_numbers, with_solids
from abut.decks.thin import nodes_through, normals_at, offsets_of, renamed, thickness_at
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Block, Deck, Equation, Numbers, Prescribed
from abut.io.deck.thin_record import Thin
from abut.mesh.thin.shells import Shell, expand

CARD = "*MEMBRANE SECTION"


def with_thick_membranes(deck: Deck) -> Deck:
    """The deck with its membranes expanded; what else is thin already is.

    Raises InputError for membranes without a section, a thickness or an area, for turns and moments at their nodes, and for
    nodes that are references of rigid bodies and couplings as well."""
    blocks = [block for block in deck.blocks if block.type.thin == "membrane"]
    if not blocks:
        return deck
    deck = _without_turns(deck, blocks)
    shells = [
        Shell(
            block.type.kind,
            np.searchsorted(deck.nodes, block.nodes),
            thickness_at(deck, block, CARD),
            offsets_of(deck, block, CARD),
            normals_at(deck, block),
            apart=True,
        )
        for block in blocks
    ]
    try:
        solid = expand(deck.points, shells)
    except ValueError as error:
        shell, cell = error.args
        raise DeckError(
            blocks[shell].place,
            f"*ELEMENT: membrane {blocks[shell].ids[cell]} has no area at one of its nodes; mend the mesh",
        ) from None
    number = free_numbers(deck, len(solid.points), [rows for _, cells in solid.cells for rows in cells])
    through = number.reshape(-1, 3)
    sides: dict[int, list[tuple[int, int]]] = {}
    for i, ends in enumerate(through[:, [0, 2]].tolist()):
        sides.setdefault(int(deck.nodes[solid.node[i]]), []).append((ends[0], ends[1]))
    others = [block.nodes.ravel() for block in deck.blocks if block.type.thin != "membrane"]
    solids = np.unique(np.concatenate([np.empty(0, np.int64), *others]))
    halfway = through[through[:, 1] >= 0].tolist()
    hinges = [_hinge((low, high), {middle: -1.0}, k, blocks[0]) for low, middle, high in halfway for k in (1, 2, 3)]
    first = dict[int, Thin]()
    for node, each in sides.items():
        if node in deck.thin:
            base = {n: -w for n, w in deck.thin[node].shares}
        elif node in solids:
            base = {node: -1.0}
        else:
            first[node] = Thin(each[0])
            base, each = dict.fromkeys(each[0], -0.5), each[1:]
        hinges += [_hinge(ends, base, k, blocks[0]) for ends in each for k in (1, 2, 3)]
    joined = [(each[0][0], ends[0]) for each in sides.values() for ends in each[1:]]
    stand_for, heights = nodes_through(deck, solid, number)
    deck = with_solids(deck, "membrane", solid.points, number, [(kind, cells[0]) for kind, cells in solid.cells])
    deck = renamed(deck, stand_for, heights)
    return replace(
        deck,
        thin={**deck.thin, **first},
        equations=(*deck.equations, *hinges),
        hinges=np.concatenate([deck.hinges, np.array(joined, np.int64).reshape(-1, 2)]),
    )


def _hinge(ends: tuple[int, int], base: dict[int, float], direction: int, block: Block) -> Equation:
    """The mean of both sides of an element moves as ``base`` does, which has the negative shares of its nodes."""
    terms = [*((node, direction, 0.5) for node in ends), *((node, direction, share) for node, share in base.items())]
    return Equation(tuple(terms), block.place)


def _without_turns(deck: Deck, blocks: Sequence[Block]) -> Deck:
    """The deck without turns of 0 at nodes that membranes alone have, where there is nothing that turns.

    Raises InputError for other turns, moments, and nodes that are references."""
    every = np.unique(np.concatenate([block.nodes.ravel() for block in blocks]))
    for node in np.intersect1d(every, sorted(deck.references)).tolist()[:1]:
        raise DeckError(
            blocks[0].place,
            f"*ELEMENT: node {node} belongs to a membrane and is a reference, or several shells or beams meet there; give "
            "the membrane a node of its own, and join them by *TIE",
        )
    own = np.setdiff1d(every, sorted(deck.thin))

    def kept(values: Sequence[Prescribed]) -> tuple[Prescribed, ...]:
        return tuple(left for value in values for left in _apart_from(value, own))

    return replace(
        deck, fixed=kept(deck.fixed), steps=tuple(replace(step, values=kept(step.values)) for step in deck.steps)
    )


def _apart_from(value: Prescribed, own: Numbers) -> list[Prescribed]:
    if value.kind not in ("boundary", "force") or max(value.directions) <= 3:
        return [value]
    here = np.isin(value.numbers, own)
    if not here.any():
        return [value]
    if value.value != 0.0:
        what = "*CLOAD" if value.kind == "force" else "*BOUNDARY"
        raise DeckError(
            value.place,
            f"{what}: node {value.numbers[here][0]} of membranes does not turn; give directions 1 to 3, or take shells",
        )
    parts = [replace(value, numbers=value.numbers[~here])] if not here.all() else []
    straight = tuple(d for d in value.directions if d <= 3)
    return [*parts, *([replace(value, numbers=value.numbers[here], directions=straight)] if straight else [])]
