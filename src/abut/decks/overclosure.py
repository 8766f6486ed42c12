"""PRESSURE-OVERCLOSURE of a deck: replaced by exact contact, with the overlap that it would have had, or solved as it is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from abut.contact.overclosure import PressureOverclosure
from abut.errors import InputError
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Deck, Pair
from abut.model import Contact
from abut.solution import Solution

EXACT = ("HARD", "TIED")
WORTH = 0.01  # of the largest displacement: an overlap from which on the deck's own contact is another problem


def own_laws(deck: Deck, contacts: Sequence[Contact]) -> dict[str, PressureOverclosure]:
    """The deck's own law of each contact, by its name, where it has one."""
    pairs = [pair.behaviour for pair in deck.pairs]
    general = () if deck.general is None else deck.general.behaviour
    found = [*pairs, *([general] * (len(contacts) - len(pairs)))]
    result = {}
    for contact, points in zip(contacts, found):
        rising = points and all(b[0] > a[0] and b[1] > a[1] for a, b in pairwise(points))
        if contact.kind == "contact" and rising and points[0][1] == 0.0:
            result[contact.name] = PressureOverclosure(points)
    return result


def softened(contacts: Sequence[Contact], laws: Mapping[str, PressureOverclosure]) -> list[Contact]:
    """Contacts with the deck's own laws. Raises InputError for one with friction, which goes with exact contact only."""
    for contact in contacts:
        if contact.name in laws and contact.frictional:
            raise InputError(
                f"contact '{contact.name}': friction goes with exact contact; leave --soft-contact out, or solve without "
                "friction: --ignore FRICTION"
            )
    return [replace(c, law=laws[c.name]) if c.name in laws else c for c in contacts]


def overclosure_notes(deck: Deck, soft: bool) -> list[str]:
    """What becomes of PRESSURE-OVERCLOSURE, pair by pair. Raises InputError for one that changes and is asked for."""
    for pair in deck.pairs:
        if pair.changing and soft:
            raise DeckError(
                pair.place,
                f"*CONTACT PAIR: the law of contact '{pair.name}' changes between steps, which --soft-contact does not do; "
                "leave it out, or make a deck for each state",
            )
    named = [(f"contact '{pair.name}'", pair.overclosure, pair.behaviour) for pair in deck.pairs]
    if deck.general is not None:
        named.append(("general contact", deck.general.overclosure, deck.general.behaviour))
    return [
        f"{what}: PRESSURE-OVERCLOSURE={kind} "
        + ("solved as it is" if soft and points else "replaced by exact contact, without penetration")
        for what, kind, points in named
        if kind not in EXACT
    ] + [
        f"contact '{pair.name}': *CHANGE SURFACE BEHAVIOR: "
        + ("exact contact before and after" if pair.span is None else _acts(pair, pair.span))
        for pair in deck.pairs
        if pair.changing
    ]


def _acts(pair: Pair, span: tuple[int, int | None]) -> str:
    """In which steps, and as what."""
    what = "glued" if pair.tied else "never separates" if pair.bilateral else "exact contact"
    first, after = span
    return f"{what} from step {first} on" if after is None else f"{what} in steps {first} to {after - 1}"


def overlaps(solution: Solution, laws: Mapping[str, PressureOverclosure]) -> list[str]:
    """How far the deck's own laws would let surfaces overlap under the largest pressures found."""
    notes = []
    moved = max((float(np.abs(step.displacement).max(initial=0.0)) for step in solution.steps), default=0.0)
    for contact in solution.model.contacts:
        law = laws.get(contact.name)
        pressures = [own.max_pressure for step in solution.steps for own in step.contacts if own.name == contact.name]
        if law is None or contact.law == law or not pressures or max(pressures) <= 0.0:
            continue
        depth = law.overclosure(max(pressures))
        much = "; --soft-contact solves it as it is" if abs(depth) > WORTH * moved else ""
        notes.append(
            f"contact '{contact.name}': under its largest pressure, {max(pressures):.4g}, the deck's own "
            f"PRESSURE-OVERCLOSURE would let the surfaces overlap by {depth:.3g}, {abs(depth) / max(moved, 1e-300):.2g} of "
            f"the largest displacement{much}"
        )
    return notes
