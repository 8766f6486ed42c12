"""Trusses of a deck expanded into solids: bars of a square section, each with sections of its own, hinged at its ends.

The displacement of a node at the end of a bar is the mean over the area of the bar's section there, so that a force at the
node is an even stress in the bar. What is left to a bar is to spin about itself, which an equation holds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.decks.solid_blocks import by_block, free_numbers, sections_of, with_solids
from abut.decks.thin import renamed
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Block, Deck, Equation, Numbers
from abut.io.deck.thin_record import Thin
from abut.mesh.thin.beams import COUNT, Beam, expand_beams

MEAN = (-1.0 / 12.0,) * 4 + (1.0 / 3.0,) * 4  # over a face of eight nodes: corners, middles of sides
SMALL = 1e-9  # share of an arm that is rounding

Vector = NDArray[np.float64]


def with_thick_trusses(deck: Deck) -> Deck:
    """The deck with its trusses expanded; its shells and beams already are.

    Raises InputError for trusses without a section or a length, for turns and moments at their nodes, and for nodes that
    are references of couplings."""
    blocks = [block for block in deck.blocks if block.type.thin == "truss"]
    if not blocks:
        return deck
    own = np.concatenate([_ordered(block) for block in blocks])  # start, end, middle of each bar
    sections = [section for block in blocks for section in sections_of(deck, block, "truss", "*SOLID SECTION")]
    _check(deck, blocks[0], own)
    points = deck.points[np.searchsorted(deck.nodes, own)]
    along = points[:, 1] - points[:, 0]
    aside = np.where(
        np.abs(along[:, 2:]) < 0.7 * np.linalg.norm(along, axis=1, keepdims=True), [[0, 0, 1.0]], [[1.0, 0, 0]]
    )
    widths = np.repeat(np.sqrt([section.thickness for section in sections])[:, None], 2, axis=1)
    if not widths.all():
        raise DeckError(
            blocks[0].place, "*ELEMENT: a truss has one area, not one at each node; give it in *SOLID SECTION"
        )
    rows = np.arange(own.size).reshape(own.shape)  # no bar shares a section with another
    try:
        solid = expand_beams(
            points.reshape(-1, 3), Beam(rows, aside, widths, np.zeros_like(widths), np.zeros((len(rows), 4)))
        )
    except ValueError as error:
        number = np.concatenate([block.ids for block in blocks])[error.args[0]]
        raise DeckError(blocks[0].place, f"*ELEMENT: truss {number} has no length; mend the mesh") from None
    number = free_numbers(deck, len(solid.points), [solid.cells])
    made: dict[int, list[Thin]] = {}
    for node, eight in zip(own.ravel().tolist(), number.reshape(-1, COUNT).tolist()):
        inside = eight[-1] < 0  # a section in the middle has its corners alone
        made.setdefault(node, []).append(Thin(tuple(eight[:4])) if inside else Thin(tuple(eight), weights=MEAN))
    solids = np.unique(np.concatenate([b.nodes.ravel() for b in deck.blocks if b.type.thin != "truss"] or [own[:0, 0]]))
    place = blocks[0].place
    hinges, first = list[Equation](), dict[int, Thin]()
    for node, each in made.items():
        shared = node in solids or node in deck.thin
        stands = {node: 1.0} if node in solids else dict(deck.thin.get(node, each[0]).shares)
        base = {n: -w for n, w in stands.items()}
        first |= {} if shared else {node: each[0]}
        for bar in each if shared else each[1:]:
            terms = [*bar.shares, *base.items()]
            hinges += [Equation(tuple((n, k, w) for n, w in terms), place) for k in (1, 2, 3)]
    corners = number.reshape(-1, 3, COUNT)[:, 0, :4]
    at = solid.points.reshape(-1, 3, COUNT, 3)[:, 0, :4]
    spins = [_spin(n, x - x.mean(axis=0), t, blocks[0]) for n, x, t in zip(corners, at, along)]
    made_of = [("hex20", rows) for rows in by_block(blocks, solid.cells[:, 0])]
    new = with_solids(deck, "truss", solid.points, number, made_of)
    stand_for = {node: np.unique([n for bar in each for n in bar.nodes]) for node, each in made.items()}
    new = renamed(new, stand_for, {})
    return replace(new, thin={**deck.thin, **first}, equations=(*deck.equations, *hinges, *spins))


def _spin(nodes: Numbers, arms: Vector, along: Vector, block: Block) -> Equation:
    """The corners of a section do not turn about the bar."""
    about = np.cross(along / np.linalg.norm(along), arms / np.linalg.norm(arms, axis=1, keepdims=True))
    terms = [(int(n), k + 1, float(c)) for n, row in zip(nodes, about) for k, c in enumerate(row) if abs(c) > SMALL]
    return Equation(tuple(terms), block.place)


def _ordered(block: Block) -> Numbers:
    """Nodes (n, 3) at start, end and middle of each bar; decks list the middle second where it is theirs."""
    return block.nodes if block.code in ("T3D2", "T2D2") else block.nodes[:, [0, 2, 1]]


def _check(deck: Deck, block: Block, own: Numbers) -> None:
    """Raise InputError for nodes that are references of couplings, and for turns and moments."""
    references = {bound.reference for bound in deck.couplings} | {body.reference for body in deck.rigid}
    nodes = set(own.ravel().tolist())
    for node in sorted(nodes & references)[:1]:
        raise DeckError(
            block.place,
            f"*ELEMENT: node {node} belongs to a truss and is the reference of a coupling, or of shells and beams that meet "
            "there; give the truss a node of its own, and join them by *EQUATION",
        )
    for value in (*deck.fixed, *(value for step in deck.steps for value in step.values)):
        turned = value.kind in ("boundary", "force") and max(value.directions) > 3
        for node in [n for n in value.numbers.tolist() if n in nodes][:1] if turned else ():
            what = "*CLOAD" if value.kind == "force" else "*BOUNDARY"
            raise DeckError(value.place, f"{what}: node {node} of trusses does not turn; give directions 1 to 3")
