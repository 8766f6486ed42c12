"""Rigid bodies of a deck."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from abut.io.deck.faces import element_nodes
from abut.io.deck.groups import Piece
from abut.io.deck.nodal_constraints import coordinates
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Deck, Numbers, RigidBody
from abut.io.deck.time_histories import Course, courses, scaled, zero
from abut.model import Amplitude, Rigid


def rigid_bodies(deck: Deck, names: Sequence[str], plane: str | None) -> list[Rigid]:
    """Bodies that move as a whole, ``names`` those of their bodies in the mesh. Raises InputError for one that carries a
    force."""
    result = []
    supported = courses(deck, "boundary") if deck.rigid else {}
    for name, body in zip(names, deck.rigid):
        _check_forces(deck, body)
        components = _components(supported, body, plane)
        values = {name: scaled(course)[0] for name, course in components.items()}
        units = {name: scaled(course)[1] for name, course in components.items() if not zero(course)}
        own = {name: Amplitude(unit) for name, unit in units.items() if unit is not None}
        alike = len(own) == len(units) and len(set(own.values())) == 1
        amplitude = next(iter(own.values())) if alike else None
        if body.reference not in deck.nodes:
            raise DeckError(body.place, f"*RIGID BODY: REF NODE {body.reference} does not exist; give it in *NODE")
        reference = tuple(coordinates(deck, np.array([body.reference]))[0][: 2 if plane else 3].tolist())
        result.append(Rigid(name, reference, **values, amplitude=amplitude, amplitudes={} if alike else own))
    return result


def _check_forces(deck: Deck, body: RigidBody) -> None:
    for step in deck.steps:
        for value in step.values:
            if value.kind == "force" and value.value and {body.reference, body.turning} & set(value.numbers.tolist()):
                raise DeckError(
                    value.place,
                    "*CLOAD: forces on a rigid body are not supported; give its displacement with *BOUNDARY",
                )


def _components(supported: Mapping[tuple[float, ...], Course], body: RigidBody, plane: str | None) -> dict[str, Course]:
    """Prescribed components by their name in ``abut.Rigid``."""
    known = {None: ("x", "y", "z", "rx", "ry", "rz"), "axisymmetric": ("y",)}.get(plane, ("x", "y", "rz"))
    result = {}
    for (node, direction), course in supported.items():
        if node == body.reference:
            name = ("x", "y", "z", "rx", "ry", "rz")[int(direction) - 1]
        elif node == body.turning and direction <= 3:
            name = ("rx", "ry", "rz")[int(direction) - 1]
        else:
            continue
        if name in known:
            result[name] = course
    return result


def join(deck: Deck, parts: Sequence[Piece]) -> tuple[list[Piece], list[Piece]]:
    """All bodies, with those of each rigid body made one; and the rigid ones, in the order of the deck.

    Raises InputError where a rigid body is not whole bodies."""
    free, rigid = list(parts), []
    for body in deck.rigid:
        nodes = np.unique(_nodes(deck, body.elements) if len(body.elements) else body.nodes)
        nodes = np.setdiff1d(nodes, [body.reference, body.turning])
        inside = [piece for piece in free if np.isin(_nodes(deck, piece.elements), nodes).all()]
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
