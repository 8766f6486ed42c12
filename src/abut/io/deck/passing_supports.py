"""Supports of a deck that begin after its first step or end before its last (OP=NEW): when each acts, and what it says."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Deck, Prescribed
from abut.io.deck.time_histories import RAMP, Course, Key, course_within, given_in, over_total_time, tidy

LED = (
    "is held where it was (FIXED) in an earlier step, and led on from there in this one: not supported; hold it with the "
    "displacement as a number from the first step on that holds it"
)


@dataclass(frozen=True)
class Stay:
    """One time that a support acts, times on the axis from 0 to 1: it begins at ``since`` where the node is, has what is
    prescribed at ``reached``, acts to ``until`` (None: the end), and its force is gone at ``released``, as the step ends
    that takes it away. course: what it leads to; frozen: nothing, it holds the node where it is at ``since``."""

    since: float
    reached: float
    until: float | None
    released: float | None
    course: Course
    frozen: bool = False


def passing(deck: Deck) -> dict[Key, tuple[Stay, ...]]:
    """Every time that each support acts, by (node, direction), of those that do not act in all steps."""
    total = sum(step.period for step in deck.steps) or 1.0
    going: dict[Key, _Going] = {}
    result: dict[Key, list[Stay]] = {}
    start = 0.0
    for step in deck.steps:
        end, first = start + step.period, step is deck.steps[0]
        given = (given_in(deck.fixed, "boundary") if first else {}) | given_in(step.values, "boundary")
        ended = going.keys() - given.keys() if "boundary" in step.new else set()
        for key in ended:
            result.setdefault(key, []).append(going.pop(key).ended(start, end, total))
        onward = {key: of.last for key, of in going.items() if key not in given and over_total_time(deck, of.last[0])}
        for key, (value, size) in {**given, **onward}.items():
            begun = key not in going
            known = going.get(key) or _Going(start, end, [(start, 0.0)], (value, size), value.frozen and not first)
            if known.frozen and not value.frozen:
                raise DeckError(value.place, f"*BOUNDARY: node {int(key[0])} {LED}")
            if begun and value.amplitude and not first:
                known.reached = start + RAMP * step.period
            before = [p for p in known.points if p[0] <= start]
            known.points = [*before, *course_within(deck, value, size, before[-1][1], start, step)]
            known.last = (value, size)
            going[key] = known
        start = end
    for key, left in going.items():
        if left.since > 0.0 or key in result:
            result.setdefault(key, []).append(left.ended(None, None, total))
    return {key: tuple(stays) for key, stays in result.items()}


@dataclass
class _Going:
    """A support that acts. points: of its course so far; last: the value that gave it, and its size."""

    since: float
    reached: float
    points: list[tuple[float, float]]
    last: tuple[Prescribed, float]
    frozen: bool = False

    def ended(self, until: float | None, released: float | None, total: float) -> Stay:
        """With times over the whole."""
        course = tidy([(min(t / total, 1.0), v) for t, v in self.points])
        begun = self.since / total, min(self.reached / total, 1.0)
        if until is None or released is None:
            return Stay(*begun, None, None, course, self.frozen)
        return Stay(*begun, until / total, min(released / total, 1.0), course, self.frozen)


def check_passing(deck: Deck, stays: Mapping[Key, object], local: Collection[int], used: Collection[int]) -> None:
    """Raise InputError for those that abut does not let come or go: of references, in axes of their own, in equations."""
    bound = {node for equation in deck.equations for node, *_ in equation.terms}
    for node, direction in stays:
        what = ""
        if node in deck.references:
            what = "is the reference of a rigid body or coupling"
        elif node in local:
            what = "has axes of its own (*TRANSFORM)"
        elif node in bound:
            what = "stands in an equation"
        elif direction > 3:
            what = f"is held in direction {int(direction)}"
        elif node not in used:
            what = "belongs to no element"
        if what:
            every = [*deck.fixed, *(value for step in deck.steps for value in step.values)]
            place = next(v.place for v in every if v.kind == "boundary" and int(node) in v.numbers)
            raise DeckError(
                place,
                f"*BOUNDARY: node {int(node)} {what}, and its support comes or goes between steps: not supported there; "
                "make a deck for each state",
            )
