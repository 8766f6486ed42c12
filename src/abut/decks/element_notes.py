"""Where elements of abut answer otherwise than those of a deck, beyond what their types say."""

from __future__ import annotations

import numpy as np

from abut.io.deck.record import Block, Deck
from abut.io.deck.time_histories import courses

SLENDER = 3.0  # longest over shortest edge: from there on bending of b-bar cells is too stiff by a fifth and more
EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))


def element_notes(deck: Deck) -> list[str]:
    """Shells that are clamped, which keep their thickness; C3D8I that are thin, which lock in bending here; C3D20 that are
    warm, which CalculiX takes otherwise; circles of beams, for which Abaqus has the radius."""
    blocks = [note for block in deck.blocks for note in (*_thin(deck, block), *_warm(deck, block))]
    return [*_circles(deck), *_clamped(deck), *blocks]


def _circles(deck: Deck) -> list[str]:
    curved = np.concatenate([np.empty(0, np.int64), *(s.elements for s in deck.sections if s.form == "ellipse")])
    codes = {b.code for b in deck.blocks if b.type.integration == "reduced" and np.isin(b.ids, curved).any()}
    full = [
        f"{code} of round section: expanded to C3D20, as the points of C3D20R would make it 7 % too stiff in bending"
        for code in sorted(codes)
    ]
    return full + [
        f"*BEAM SECTION, SECTION=CIRC of {s.name}: {s.widths[0]:g} is the diameter, as in CalculiX; where the deck is for "
        "Abaqus, whose number is the radius, double it"
        for s in deck.sections
        if s.form == "ellipse" and s.widths[0] == s.widths[1]
    ]


def _clamped(deck: Deck) -> list[str]:
    shells = {n for block in deck.blocks if block.type.thin == "shell" for n in np.unique(block.nodes).tolist()}
    held: dict[int, set[int]] = {}
    for value in (*deck.fixed, *(value for step in deck.steps for value in step.values)):
        for node in value.numbers.tolist() if value.kind == "boundary" and shells else ():
            held.setdefault(node, set()).update(value.directions)
    if not any(node in shells and {1, 2, 3} < directions for node, directions in held.items()):
        return []
    return [
        "shells that are clamped keep their thickness there, as in CalculiX: with a Poisson's ratio they bend too little, "
        "in proportion to the cells (a plate of 8 by 8 by 6 %); refine at the clamp, or take shells of a job file, which do "
        "not"
    ]


def _thin(deck: Deck, block: Block) -> list[str]:
    if block.code not in ("C3D8I", "C3D8IH"):
        return []
    x = deck.points[np.searchsorted(deck.nodes, block.nodes)]
    lengths = np.stack([np.linalg.norm(x[:, a] - x[:, b], axis=1) for a, b in EDGES])
    slender = lengths.max(axis=0) > SLENDER * lengths.min(axis=0)
    if not slender.any():
        return []
    return [
        f"{block.code}: {slender.sum()} of {len(slender)} elements are more than {SLENDER:g} times as long as thick: where "
        "they bend they are far too stiff without incompatible modes; mesh what bends with C3D20R"
    ]


def _warm(deck: Deck, block: Block) -> list[str]:
    if block.code != "C3D20":
        return []
    changes = courses(deck, "temperature", lambda key: deck.initial.get(int(key[0]), 0.0))
    values = [tuple(changes.get((node, 0), ())) for node in np.unique(block.nodes).tolist()] if changes else []
    if len(set(values)) <= 1:
        return []
    return [
        "C3D20 with temperatures that differ from node to node: they are quadratic between the nodes, in CalculiX linear; "
        "with C3D20R both do the same"
    ]
