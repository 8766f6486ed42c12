"""Reference nodes of rigid bodies that name none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from abut.io.deck.record import Deck, RigidBody


def with_references(deck: Deck) -> Deck:
    """The deck with a node of no element in the middle of each rigid body that names no REF NODE. Nothing acts there, so
    that it does not matter where it is: a force-free body turns as its ROT NODE says, or as what touches it moves it."""
    if all(body.reference for body in deck.rigid):
        return deck
    number = int(max(deck.nodes.max(initial=0), *(body.turning for body in deck.rigid)))
    bodies: list[RigidBody] = []
    nodes, points, notes = [deck.nodes], [deck.points], list(deck.notes)
    for body in deck.rigid:
        members = np.concatenate(
            [body.nodes, *(block.nodes[np.isin(block.ids, body.elements)].ravel() for block in deck.blocks)]
        )
        here = np.isin(deck.nodes, members)
        if body.reference or not here.any():
            bodies.append(body)
            continue
        number += 1
        nodes.append(np.array([number]))
        points.append(deck.points[here].mean(axis=0, keepdims=True))
        bodies.append(replace(body, reference=number))
        notes.append(f"{body.place}: *RIGID BODY: no REF NODE: node {number} in the middle of its nodes")
    return replace(
        deck, nodes=np.concatenate(nodes), points=np.concatenate(points), rigid=tuple(bodies), notes=tuple(notes)
    )
