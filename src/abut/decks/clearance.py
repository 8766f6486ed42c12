"""What a deck adds to the gap of a contact: *CLEARANCE, and *CONTACT INTERFERENCE over the steps."""

from __future__ import annotations

from typing import TypedDict

import numpy as np

from abut.io.deck.faces import nodes_of_rows
from abut.io.deck.groups import Groups
from abut.io.deck.record import Deck, Pair
from abut.io.deck.ties import heights
from abut.io.deck.time_histories import ALLOWED, RAMP, Course, combine, courses, scaled
from abut.model import Amplitude
from abut.model.conditions import History

ROUND = 1e-9  # of the size of the deck: gaps that rounding leaves
RISE = ((0.0, 0.0), (1.0, 1.0))


class GapOptions(TypedDict):
    """Of a ``Contact``."""

    offset: float
    amplitude: History


def gap_options(deck: Deck, groups: Groups, pair: Pair, notes: list[str]) -> GapOptions:
    """Offset of a pair and its course: the clearance, and the overlap that is allowed, which is there at the beginning of
    the first step already. ``notes`` gets what SHRINK has become."""
    parts: list[tuple[float, Course]] = [(1.0, ((0.0, pair.clearance or 0.0),))]
    number = next(i for i, other in enumerate(deck.pairs) if other is pair)
    for kind in ALLOWED:
        course = courses(deck, kind).get((number, 0))
        if course is None:
            continue
        size = 1.0
        if kind == "shrink":
            size = _overlap(deck, groups, pair)
            notes.append(
                f"contact '{pair.name}': *CONTACT INTERFERENCE, SHRINK: the largest overlap, {size:.4g}, is allowed at "
                "first, all over the surface, and goes down to zero in the step"
            )
        parts.append((size, _at_once(course)))
    whole = combine(parts)
    if len(whole) == 1:
        return {"offset": whole[0][1], "amplitude": None}
    offset, unit = scaled(whole)
    return {"offset": offset, "amplitude": Amplitude(RISE if unit is None else unit)}


def bilateral_note(deck: Deck, groups: Groups, pair: Pair) -> str:
    """What NO SEPARATION has become."""
    zone = pair.adjust if isinstance(pair.adjust, float) else 0.0
    nodes = nodes_of_rows(deck, groups.rows(pair.slave))
    apart = float(heights(deck, groups.rows(pair.master), np.unique(nodes[nodes >= 0])).max(initial=0.0))
    closed = (
        f"; gaps of up to {apart:.3g} are closed, which may stay open there"
        if apart > max(zone, ROUND * float(np.ptp(deck.points, axis=0).max()))
        else ""
    )
    return f"contact '{pair.name}': NO SEPARATION: bilateral from the beginning on{closed}"


def _at_once(course: Course) -> Course:
    """A course that jumps as it begins, with the value after the jump from the beginning on."""
    (first, _), *rest = course
    return ((first, rest[0][1]), *rest[1:]) if rest and rest[0][0] <= 2.0 * RAMP else course


def _overlap(deck: Deck, groups: Groups, pair: Pair) -> float:
    """The largest of the slave's nodes under the master's faces, a length >= 0."""
    nodes = nodes_of_rows(deck, groups.rows(pair.slave))
    return max(0.0, float(-heights(deck, groups.rows(pair.master), np.unique(nodes[nodes >= 0])).min()))
