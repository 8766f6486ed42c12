"""Ends of springs that belong to no element, and that nothing holds: points that move freely.

Each becomes a small cube whose corners all move as the node does, so that it takes no force by itself and does not turn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from abut.io.deck.elements import ELEMENTS
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import NO_CONSTANTS, Block, Deck, Equation, Expansion, Material, Numbers, Section
from abut.io.deck.time_histories import courses, zero

NAME = "points"
SIZE = 0.01  # of a cube over the model's: nothing depends on it
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])


def with_points(deck: Deck) -> Deck:
    """The deck with a cube at each end of a spring that is neither a node of an element, nor a reference, nor held in all
    directions of its springs without a force there. The cube of a node of a rigid body is a part of that. Decks of plane
    and axisymmetric elements stay as they are.

    Raises InputError beside contact of all surfaces, which would take cubes for bodies."""
    if any(block.type.plane for block in deck.blocks):
        return deck
    free = _free(deck)
    if not len(free):
        return deck
    place = deck.springs[0].place
    if deck.general is not None:
        raise DeckError(
            place, f"node {free[0]} belongs to no element, and all surfaces may touch; name them in *CONTACT PAIR"
        )
    used = np.concatenate([free, *(block.nodes.ravel() for block in deck.blocks)])
    size = SIZE * (float(np.ptp(deck.points[np.isin(deck.nodes, used)], axis=0).max()) or 1.0)
    others = max(int(deck.nodes.max()), *deck.references, 0) + 1 + np.arange(7 * len(free)).reshape(-1, 7)
    rows = np.column_stack([free, others])
    at = deck.points[np.searchsorted(deck.nodes, free)][:, None] + size * CORNERS[1:]
    taken = [block.ids for block in deck.blocks] + [spring.elements for spring in deck.springs]
    ids = max(int(numbers.max()) for numbers in taken) + 1 + np.arange(len(free))
    stiff = max(_slope(spring.law) for spring in deck.springs) / size
    elastic = replace(NO_CONSTANTS, rows=((0.0, (stiff, 0.0)),))
    material = Material(NAME, elastic, 0.0, Expansion(), place)
    bound = [np.intersect1d(body.nodes, free) for body in deck.rigid]
    follow = [
        Equation(((other, k, 1.0), (node, k, -1.0)), place)
        for node, *seven in rows[~np.isin(free, np.concatenate([free[:0], *bound]))].tolist()
        for other in seven
        for k in (1, 2, 3)
    ]
    rigid = tuple(
        replace(body, nodes=np.concatenate([body.nodes, others[np.isin(free, own)].ravel()]))
        for body, own in zip(deck.rigid, bound)
    )
    each = "nodes " + ", ".join(map(str, free[:5])) + (" ..." if len(free) > 5 else "")
    return replace(
        deck,
        nodes=np.concatenate([deck.nodes, others.ravel()]),
        points=np.concatenate([deck.points, at.reshape(-1, 3)]),
        blocks=(*deck.blocks, Block("C3D8", ELEMENTS["C3D8"], ids, rows, place)),
        sections=(*deck.sections, Section(NAME, ids, material, 1.0, place)),
        equations=(*deck.equations, *follow),
        rigid=rigid,
        notes=(
            *deck.notes,
            f"springs: {each} belong to no element; each is a small cube without mass that moves as a whole",
        ),
    )


def _free(deck: Deck) -> Numbers:
    held = {(int(n), int(d)) for (n, d), course in courses(deck, "boundary").items() if zero(course)}
    forced = {n for step in deck.steps for v in step.values if v.kind == "force" for n in v.numbers.tolist()}
    used = {*deck.references, *(node for block in deck.blocks for node in np.unique(block.nodes).tolist())}
    found = {
        node
        for spring in deck.springs
        for node in np.unique(spring.ends).tolist()
        if node not in used and (node in forced or any((node, d) not in held for d in spring.directions or (1, 2, 3)))
    }
    return np.array(sorted(found), np.int64)


def _slope(law: float | tuple[tuple[float, float], ...]) -> float:
    """Stiffness of a spring, where it is largest."""
    if isinstance(law, float):
        return law
    u, f = np.array(law).T
    return float((np.diff(f) / np.diff(u)).max())
