"""Rigid bodies of a deck."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from abut.decks.couplings import MOTIONS, components, motion_of
from abut.io.deck.faces import element_nodes
from abut.io.deck.groups import Piece
from abut.io.deck.nodal_constraints import coordinates
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Coupling, Deck, Numbers, Prescribed, RigidBody
from abut.io.deck.time_histories import Course, courses
from abut.model import Rigid
from abut.model.conditions import TURNS


def rigid_bodies(deck: Deck, bodies: Mapping[str, Piece], plane: str | None) -> list[Rigid]:
    """Bodies that move as a whole, ``bodies`` by their names in the mesh, with a mass where modes are asked for. Raises
    InputError for one without its reference node."""
    result = []
    given = courses(deck, "boundary") if deck.rigid else {}
    for (name, piece), body in zip(bodies.items(), deck.rigid):
        density = piece.section.material.density if deck.modes is not None else 0.0
        motion = motion_of(_components(given, body), components(plane))
        if body.reference not in deck.nodes:
            raise DeckError(body.place, f"*RIGID BODY: REF NODE {body.reference} does not exist; give it in *NODE")
        reference = tuple(coordinates(deck, np.array([body.reference]))[0][: 2 if plane else 3].tolist())
        moved = Rigid(name, reference, **motion.values, amplitude=motion.amplitude, amplitudes=motion.amplitudes)
        result.append(replace(moved, density=density))
    return result


def _components(given: Mapping[tuple[float, ...], Course], body: RigidBody) -> dict[str, Course]:
    """Prescribed components by their name in ``abut.Rigid``."""
    result = {}
    for (node, direction), course in given.items():
        if node == body.reference:
            result[MOTIONS[int(direction) - 1]] = course
        elif node == body.turning and direction <= 3:
            result[TURNS[int(direction) - 1]] = course
    return result


def with_parts_coupled(deck: Deck, parts: Sequence[Piece], notes: list[str]) -> Deck:
    """The deck with rigid bodies that are parts of bodies only as kinematic couplings of their nodes, which is the same;
    ``notes`` gets them. What is said of their turning nodes is said of directions 4 to 6 of the reference node."""
    whole: list[RigidBody] = []
    coupled: list[Coupling] = []
    turned: dict[int, int] = {}
    free = list(parts)
    for body in deck.rigid:
        nodes, inside = _inside(deck, body, free)
        elements = np.concatenate([np.empty(0, np.int64), *(piece.elements for piece in inside)])
        if inside and not len(np.setdiff1d(nodes, _nodes(deck, elements))):
            free = [piece for piece in free if not any(piece is other for other in inside)]
            whole.append(body)
            continue
        if body.turning:
            turned[body.turning] = body.reference
        name = f"rigid part of {body.reference}"
        coupled.append(Coupling(name, False, body.reference, "", nodes, frozenset(range(1, 7)), None, body.place))
        notes.append(
            f"{body.place}: *RIGID BODY is part of a body: its nodes are coupled to node {body.reference} (kinematic)"
        )
    fixed = tuple(each for value in deck.fixed for each in _as_turns(value, turned))
    steps = tuple(
        replace(step, values=tuple(each for value in step.values for each in _as_turns(value, turned)))
        for step in deck.steps
    )
    return replace(deck, rigid=tuple(whole), couplings=(*deck.couplings, *coupled), fixed=fixed, steps=steps)


def _as_turns(value: Prescribed, turned: Mapping[int, int]) -> list[Prescribed]:
    """A value with what it says of turning nodes, of which ``turned`` has the references, as that of directions 4 to 6."""
    here = [node for node in turned if node in value.numbers]
    if value.kind not in ("boundary", "force") or not here:
        return [value]
    directions = tuple(direction + 3 for direction in value.directions if direction <= 3)
    made = [replace(value, numbers=np.array([turned[node]]), directions=directions) for node in here if directions]
    left = np.setdiff1d(value.numbers, here)
    return [*([replace(value, numbers=left)] if len(left) else []), *made]


def _inside(deck: Deck, body: RigidBody, free: Sequence[Piece]) -> tuple[Numbers, list[Piece]]:
    """Nodes of a rigid body, and the bodies that are rigid as a whole."""
    nodes = np.unique(_nodes(deck, body.elements) if len(body.elements) else body.nodes)
    nodes = np.setdiff1d(nodes, [body.reference, body.turning])
    return nodes, [piece for piece in free if np.isin(_nodes(deck, piece.elements), nodes).all()]


def join(deck: Deck, parts: Sequence[Piece]) -> tuple[list[Piece], list[Piece]]:
    """All bodies, with those of each rigid body made one; and the rigid ones, in the order of the deck.

    Raises InputError where a rigid body is not whole bodies."""
    free, rigid = list(parts), []
    for body in deck.rigid:
        nodes, inside = _inside(deck, body, free)
        elements = np.concatenate([np.empty(0, np.int64), *(piece.elements for piece in inside)])
        left = np.setdiff1d(nodes, _nodes(deck, elements))
        if len(left) or not inside:
            which = f"node {left[0]} belongs to" if len(left) else "it is part of"
            raise DeckError(
                body.place,
                f"*RIGID BODY: {which} a body that is rigid in part only, or rigid already; abut makes whole bodies rigid: "
                "give that part its own *SOLID SECTION, or hold its nodes with *BOUNDARY",
            )
        rest = [piece for piece in free if not any(piece is other for other in inside)]
        name = inside[0].name if len(inside) == 1 else inside[0].section.name
        codes = tuple(sorted({code for piece in inside for code in piece.codes}))
        rigid.append(Piece(name, inside[0].section, inside[0].integration, codes, np.sort(elements)))
        free = rest
    return [*free, *rigid], rigid


def _nodes(deck: Deck, elements: Numbers) -> Numbers:
    nodes = [element_nodes(b, np.intersect1d(elements, b.ids)).ravel() for b in deck.blocks]
    return np.unique(np.concatenate(nodes)).astype(np.int64)
