"""Rigid bodies of a deck."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from abut.errors import InputError
from abut.io.abaqus.bonds import coordinates
from abut.io.abaqus.courses import Course, courses, scaled, zero
from abut.io.abaqus.faces import element_nodes
from abut.io.abaqus.groups import Piece
from abut.io.abaqus.record import Deck, Numbers, RigidBody
from abut.model import Amplitude, Rigid


def rigid_bodies(deck: Deck, parts: Mapping[str, Piece], plane: str | None) -> list[Rigid]:
    """Bodies that move as a whole. Raises InputError where a *RIGID BODY is not whole bodies, or carries a force."""
    result = []
    held = courses(deck, "boundary") if deck.rigid else {}
    for body in deck.rigid:
        where = f"{body.place}: *RIGID BODY"
        _check_forces(deck, body)
        components = _components(held, body, plane)
        units = {scaled(course)[1] for course in components.values() if not zero(course)}
        if len(units) > 1:
            raise InputError(f"{where}: its displacements and turns follow different amplitudes; give them one")
        values = {name: scaled(course)[0] for name, course in components.items()}
        unit = next(iter(units), None)
        amplitude = None if unit is None else Amplitude(unit)
        if body.reference not in deck.nodes:
            raise InputError(f"{where}: REF NODE {body.reference} does not exist; give it in *NODE")
        reference = tuple(coordinates(deck, np.array([body.reference]))[0][: 2 if plane else 3].tolist())
        names = _bodies(deck, body, parts, where)
        wanted = {None: 6, "axisymmetric": 1}.get(plane, 3)
        if len(names) > 1 and len(values) < wanted:
            raise InputError(
                f"{where}: it takes in several bodies ({', '.join(names)}), each of which would move by itself; hold all "
                "directions of its reference node, or give each body its own"
            )
        result += [Rigid(name, reference, **values, amplitude=amplitude) for name in names]
    return result


def _check_forces(deck: Deck, body: RigidBody) -> None:
    for step in deck.steps:
        for value in step.values:
            if value.kind == "force" and value.value and {body.reference, body.turning} & set(value.numbers.tolist()):
                raise InputError(
                    f"{value.place}: *CLOAD: forces on a rigid body are not supported; give its displacement with *BOUNDARY"
                )


def _components(held: Mapping[tuple[float, ...], Course], body: RigidBody, plane: str | None) -> dict[str, Course]:
    """Prescribed components by their name in ``abut.Rigid``."""
    known = {None: ("x", "y", "z", "rx", "ry", "rz"), "axisymmetric": ("y",)}.get(plane, ("x", "y", "rz"))
    result = {}
    for (node, direction), course in held.items():
        if node == body.reference:
            name = ("x", "y", "z", "rx", "ry", "rz")[int(direction) - 1]
        elif node == body.turning and direction <= 3:
            name = ("rx", "ry", "rz")[int(direction) - 1]
        else:
            continue
        if name in known:
            result[name] = course
    return result


def _bodies(deck: Deck, body: RigidBody, parts: Mapping[str, Piece], where: str) -> list[str]:
    """Names of the bodies all of whose nodes belong to the rigid body."""
    nodes = {name: _nodes(deck, piece.elements) for name, piece in parts.items()}
    own = np.unique(_nodes(deck, body.elements) if len(body.elements) else body.nodes)
    own = np.setdiff1d(own, [body.reference, body.turning])
    names = [name for name, members in nodes.items() if np.isin(members, own).all()]
    covered = np.unique(np.concatenate([np.empty(0, np.int64), *(nodes[name] for name in names)]))
    left = np.setdiff1d(own, covered)
    if len(left):
        raise InputError(
            f"{where}: node {left[0]} belongs to a body that is rigid in part only; abut makes whole bodies rigid: give "
            "that part its own *SOLID SECTION, or hold its nodes with *BOUNDARY"
        )
    return names


def _nodes(deck: Deck, elements: Numbers) -> Numbers:
    own = [element_nodes(b, np.intersect1d(elements, b.ids)).ravel() for b in deck.blocks]
    return np.unique(np.concatenate(own))
