"""Temperatures of a deck as loads of a model."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from abut.io.deck.groups import Groups
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Deck
from abut.io.deck.time_histories import Course, combine, courses, scaled, zero
from abut.model import Amplitude, Load, Temperature


def history(course: Course) -> tuple[float, Amplitude | None]:
    """The size of a course, and its amplitude."""
    size, unit = scaled(course)
    return size, None if unit is None else Amplitude(unit)


def temperatures(deck: Deck, groups: Groups) -> Iterator[Load]:
    """Changes from the initial temperature."""
    for step in deck.steps:
        for value in step.values:
            if value.kind == "temperature":
                for node in [n for n in value.numbers.tolist() if n not in deck.initial][:1]:
                    raise DeckError(
                        value.place,
                        f"*TEMPERATURE: node {node} has no temperature to begin with; add "
                        "*INITIAL CONDITIONS, TYPE=TEMPERATURE",
                    )
    alike: dict[Course, list[int]] = {}
    for (node, *_), course in courses(deck, "temperature", lambda key: deck.initial[int(key[0])]).items():
        change = combine([(1.0, course), (-deck.initial[int(node)], ((0.0, 1.0),))])
        if not zero(change):
            alike.setdefault(change, []).append(int(node))
    count = 0
    for change, nodes in alike.items():
        here = np.intersect1d(np.array(nodes, np.int64), groups.used)
        if len(here):
            count += 1
            yield Temperature(groups.node_set(here, f"temperature-{count}"), *history(change))
