"""What the steps of a deck ask to be printed or written: *NODE PRINT, *EL FILE and their like, of CalculiX and Abaqus."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from abut.io.deck.cards import Card, as_integer
from abut.io.deck.reasons import Place

TABLES = {"NODEPRINT": "node", "ELPRINT": "element", "CONTACTPRINT": "contact"}
FILES = {"NODEFILE": "node", "ELFILE": "element", "CONTACTFILE": "contact"}
BOTH = {"NODEOUTPUT": "node", "ELEMENTOUTPUT": "element", "CONTACTOUTPUT": "contact"}  # after *OUTPUT, HISTORY: tables
REQUESTS = {*TABLES, *FILES, *BOTH, "OUTPUT"}


@dataclass(frozen=True)
class Request:
    """What one card asks for. kind: of "node", "element", "contact"; table: as numbers, else in result files; frd: as
    CalculiX writes these; of: name of the set, "" for everything; labels: in capitals; every: of the increments, every
    n-th and the last one of a step; first, last: numbers of the steps in which it holds, None for all that follow."""

    kind: str
    table: bool
    frd: bool
    of: str
    labels: tuple[str, ...]
    every: int
    first: int
    last: int | None
    title: str
    place: Place
    local: bool = False


def requests(cards: Sequence[tuple[int, Card]]) -> tuple[Request, ...]:
    """Of cards with the number of their step. One holds until a later step has a card of its name; none with FREQUENCY=0."""
    result: list[tuple[str, Request]] = []
    history, since = False, 0
    for number, card in cards:
        if card.key == "OUTPUT":  # of Abaqus: what follows it belongs to it
            history = card.has("HISTORY")
            if number > since:
                result, since = _ended(result, {*BOTH}, number), number
            continue
        if card.key not in BOTH:
            result = _ended(result, {card.key}, number)
        every = as_integer(card.get("FREQUENCY", "1") or "1") or 0
        kind = (TABLES | FILES | BOTH)[card.key]
        table = card.key in TABLES or (card.key in BOTH and history)
        labels = tuple(dict.fromkeys(field.upper() for line in card.lines for field in line.fields if field))
        of = card.get("NSET") or card.get("ELSET") or card.get("SLAVE") or ""
        local = (card.get("GLOBAL") or "").upper() == "NO"
        if every:
            request = Request(
                kind, table, card.key in FILES, of, labels, every, number, None, card.title, card.place, local
            )
            result.append((card.key, request))
    return tuple(request for _, request in result)


def _ended(known: list[tuple[str, Request]], keys: set[str], number: int) -> list[tuple[str, Request]]:
    """Those that a card of step ``number`` ends: of its kind, from steps before."""
    return [
        (key, replace(request, last=number - 1))
        if key in keys and request.last is None and request.first < number
        else (key, request)
        for key, request in known
    ]
