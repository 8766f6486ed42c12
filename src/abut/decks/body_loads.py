"""Gravity and centrifugal forces of a deck."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from abut.io.deck.groups import Piece
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Deck
from abut.io.deck.time_histories import BODY_LOADS, Course, courses, scaled, zero
from abut.model import Amplitude, Centrifugal, Gravity, Load

ALONG = {"axisymmetric": (0.0, 1.0, 0.0), "strain": (0.0, 0.0, 1.0), "stress": (0.0, 0.0, 1.0)}  # axes of plane models
SAME = 1e-9  # of directions and places: the same


def body_loads(deck: Deck, parts: Mapping[str, Piece], plane: str | None) -> Iterator[Load]:
    """Of all bodies, each of which has a load on all of its elements or on none. Raises InputError for a body without
    density and for an axis that a plane model does not have."""
    for kind in BODY_LOADS:
        alike: dict[tuple[tuple[float, ...], Course], list[int]] = {}
        for key, course in courses(deck, kind).items():
            if not zero(course):
                alike.setdefault((key[1:], course), []).append(int(key[0]))
        for (vector, course), elements in alike.items():
            size, unit = scaled(course)
            amplitude = None if unit is None else Amplitude(unit)
            for name, piece in parts.items():
                if not np.isin(piece.elements[0], elements):
                    continue
                _check_density(deck, kind, piece)
                if piece.section.material.density == 0.0:
                    continue
                if kind == "gravity":
                    yield Gravity(tuple(size * x for x in vector[: 2 if plane else 3]), name, amplitude)
                    continue
                yield _centrifugal(deck, vector, size, name, amplitude, plane)


def _centrifugal(
    deck: Deck, vector: tuple[float, ...], size: float, name: str, amplitude: Amplitude | None, plane: str | None
) -> Centrifugal:
    """size: square of the speed."""
    through, axis = np.array(vector[:3]), np.array(vector[3:]) / np.linalg.norm(vector[3:])
    if plane is None:
        return Centrifugal(math.sqrt(size), tuple(axis), tuple(through), name, amplitude)
    wanted = np.array(ALONG[plane])
    beside = plane == "axisymmetric" and abs(through[0]) > SAME * np.abs(deck.points).max()
    if abs(axis @ wanted) < 1.0 - SAME or beside:
        place = next(v.place for s in deck.steps for v in s.values if v.kind == "centrifugal")
        which = "y, through the origin" if plane == "axisymmetric" else "z"
        raise DeckError(place, f"*DLOAD: CENTRIF: the axis of this model is {which}; give that one")
    return Centrifugal(math.sqrt(size), None, None if plane == "axisymmetric" else tuple(through[:2]), name, amplitude)


def _check_density(deck: Deck, kind: str, piece: Piece) -> None:
    material = piece.section.material
    if not material.weighed:
        place = next(v.place for s in deck.steps for v in s.values if v.kind == kind)
        what = "gravity needs" if kind == "gravity" else "CENTRIF needs"
        raise DeckError(place, f"*DLOAD: {what} a *DENSITY of material '{material.name}'")
