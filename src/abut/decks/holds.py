"""Supports of a deck that come and go between its steps, as holds of a model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from abut.io.deck.groups import Groups
from abut.io.deck.nodal_constraints import Bonds
from abut.io.deck.passing_supports import Stay
from abut.io.deck.time_histories import Course, at, scaled, zero
from abut.model import Amplitude, Hold
from abut.model.hold import STAY
from abut.types import Json

AXES = "xyz"


@dataclass(frozen=True)
class _Alike:
    """What holds have in common that are one: times, and the course over its size (None where nothing moves)."""

    since: float
    reached: float
    until: float | None
    released: float | None
    unit: Course | None


def holds(bound: Bonds, groups: Groups) -> list[Hold]:
    """Nodes that are held alike together, components with the same times and course in one hold."""
    by_node: dict[int, dict[_Alike, dict[int, float | str]]] = {}
    for (node, axis), stays in bound.passing.items():
        for stay in stays:
            size, alike = _sized(stay)
            by_node.setdefault(node, {}).setdefault(alike, {})[axis] = size
    nodes: dict[tuple[_Alike, tuple[tuple[int, float | str], ...]], list[int]] = {}
    for node, each in by_node.items():
        for alike, sizes in each.items():
            nodes.setdefault((alike, tuple(sorted(sizes.items()))), []).append(node)
    result: list[Hold] = []
    for (alike, held), members in nodes.items():
        on = groups.node_set(np.array(members), f"hold-{len(result) + 1}")
        values: Json = {AXES[axis]: size for axis, size in held}
        times: Json = {"since": alike.since, "reached": alike.reached, "until": alike.until, "released": alike.released}
        result.append(Hold(on, **values, **times, amplitude=None if alike.unit is None else Amplitude(alike.unit)))
    return result


def _sized(stay: Stay) -> tuple[float | str, _Alike]:
    if stay.frozen:
        return STAY, _Alike(stay.since, stay.reached, stay.until, stay.released, None)
    size, unit = scaled(stay.course)
    if zero(stay.course):
        unit = None
    elif unit is None:
        unit = ((0.0, 0.0), (1.0, 1.0))
    if unit is not None:  # as a hold has it where no amplitude is given
        plain = at(unit, stay.since) == 0.0 and all(at(unit, t) == 1.0 for t, _ in unit if t >= stay.reached)
        steady = {t for t, _ in unit} <= {stay.since, stay.reached, 1.0, 0.0}
        unit = None if plain and steady and at(unit, stay.reached) == 1.0 else unit
    return size, _Alike(stay.since, stay.reached, stay.until, stay.released, unit)
