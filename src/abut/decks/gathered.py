"""Products of displacements (*MPC at large displacements) of a deck as connectors between points."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from abut.decks.temperatures import history
from abut.io.deck.groups import Groups
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Deck
from abut.io.deck.time_histories import courses
from abut.model import Connector
from abut.types import Json

KINDS = {"STRAIGHT": "straight", "PLANE": "plane", "MEANROT": "mean-turn", "BEAM": "distance", "DIST": "distance"}


def connectors(deck: Deck, groups: Groups, plane: str | None, thickness: float) -> Iterator[Connector]:
    """One for each *MPC. Raises InputError for nodes of no element, and for what plane models lack."""
    used = set(groups.used.tolist())
    moved, pushed = (courses(deck, kind) if deck.gathered else {} for kind in ("boundary", "force"))
    for i, found in enumerate(deck.gathered):
        if lost := [node for node in found.nodes if node not in used or node in deck.thin]:
            raise DeckError(
                found.place,
                f"*MPC {found.kind}: node {lost[0]} is no node of a solid element; leave it out of the card",
            )
        if plane == "axisymmetric" or (plane is not None and found.kind == "PLANE"):
            raise DeckError(found.place, f"*MPC {found.kind}: it is read in 3D models only; write *EQUATION")
        keys: Json = {}
        if found.kind == "BEAM":
            keys["motion"] = 0.0
        if found.kind == "DIST":
            if (found.pilot, 1) not in moved:
                continue  # a distance that is free
            if history(moved[found.pilot, 1])[0]:
                raise DeckError(
                    found.place,
                    f"*MPC DIST: *BOUNDARY moves direction 1 of node {found.pilot}; only 0 there is read, which says that "
                    "the distance is bounded",
                )
            keys["limits"] = (-math.inf, found.limit)
        if found.kind == "MEANROT":
            keys |= {} if plane else {"axis": found.axis}
            pilot = (found.pilot, 1)
            key, course = ("motion", moved.get(pilot)) if pilot in moved else ("load", pushed.get(pilot))
            if course is None:
                continue  # a turn that is free
            keys[key], keys["amplitude"] = history(course)
            keys[key] /= thickness if key == "load" else 1.0
        on = groups.node_set(np.array(found.nodes), f"mpc-{i + 1}-nodes")
        yield Connector(groups.free_name(f"mpc-{i + 1}"), KINDS[found.kind], on, **keys)
