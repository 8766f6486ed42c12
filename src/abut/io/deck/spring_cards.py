"""Springs of a deck: elements SPRING1, SPRING2 and SPRINGA with their *SPRING, GAPUNI with *GAP."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from abut.io.deck.cards import Card, as_integer, of
from abut.io.deck.gap_cards import gap_law
from abut.io.deck.reasons import DeckError, Place, Reasons
from abut.io.deck.record import Spring

NODES = {"SPRING1": 1, "SPRING2": 2, "SPRINGA": 2, "GAPUNI": 2}
CARD = dict.fromkeys(NODES, "SPRING") | {"GAPUNI": "GAP"}  # that has the law
ELEMENTS = "SPRINGELEMENTS"  # key of *ELEMENT cards with them
Found = dict[int, tuple[str, tuple[int, ...], Place]]  # by number: type, nodes, where


def springs(cards: Sequence[Card], nodes: frozenset[int], reasons: Reasons) -> tuple[Spring, ...]:
    """All of them, by card and type; ``reasons`` gets what is wrong with them."""
    found: Found = {}
    sets: dict[str, list[int]] = {}
    for card in of(cards, ELEMENTS):
        with reasons.gathered():
            listed = _elements(card, nodes, found)
            if card.get("ELSET"):
                sets.setdefault(card.need("ELSET").upper(), []).extend(listed)
    if found:
        for card in of(cards, "ELSET"):
            with reasons.gathered():
                sets.setdefault(card.need("ELSET").upper(), []).extend(members(card, found, sets))
    result: list[Spring] = []
    for card in (*of(cards, "SPRING"), *of(cards, "GAP")):
        with reasons.gathered():
            result += _with_law(card, sets.get(card.need("ELSET").upper(), []), found)
    left = found.keys() - {number for spring in result for number in spring.elements.tolist()}
    for number in sorted(left)[:1]:
        if not reasons.found:
            code, _, place = found[number]
            more = f" and {len(left) - 1} more" if len(left) > 1 else ""
            reasons.add(DeckError(place, f"*ELEMENT: {code} {number}{more} without *{CARD[code]}; give its set one"))
    return tuple(result)


def _elements(card: Card, nodes: frozenset[int], found: Found) -> list[int]:
    code = card.need("TYPE").upper()
    result = []
    for line in card.lines:
        number = line.integer(0, "element number")
        ends = tuple(line.integer(i, "node number") for i in range(1, 1 + NODES[code]))
        for node in ends:
            if node not in nodes:
                raise line.unknown(f"element {number}: node {node} does not exist; give it in *NODE")
        if len(set(ends)) < len(ends):
            raise line.error(f"element {number}: both ends are node {ends[0]}; give two nodes")
        found[number] = code, ends, line.place
        result.append(number)
    return result


def members(card: Card, found: Collection[int], sets: Mapping[str, list[int]]) -> list[int]:
    """Those of the elements ``found`` that are in a set."""
    numbers: list[int] = []
    for line in card.lines:
        if card.has("GENERATE"):
            first = line.integer(0, "first number")
            numbers += range(first, line.integer(1, "last number", first) + 1, line.integer(2, "increment", 1))
            continue
        for text in line.fields:
            number = as_integer(text)
            numbers += sets.get(text.upper(), []) if number is None else [number]
    return [number for number in numbers if number in found]


def _with_law(card: Card, members: Sequence[int], found: Found) -> list[Spring]:
    name = card.need("ELSET")
    wanted = [code for code, own in CARD.items() if own == card.key]
    if not members:
        raise card.error(f"ELSET={name}: no spring elements are in it; give {' or '.join(wanted)}")
    by_code: dict[str, list[int]] = {}
    for number in dict.fromkeys(members):
        by_code.setdefault(found[number][0], []).append(number)
    if len(by_code) > 1:
        raise card.error(f"ELSET={name}: it has elements {' and '.join(by_code)}; give each type a set of its own")
    ((code, numbers),) = by_code.items()
    if code not in wanted:
        raise card.error(f"ELSET={name}: it has elements {code}; give their set *{CARD[code]}")
    ends = np.array([found[number][1] for number in numbers], np.int64)
    if code == "GAPUNI":
        direction, table, rigid = gap_law(card)
        return [Spring(name, code, np.array(numbers, np.int64), ends, (direction,), table, card.place, rigid)]
    rows = [line for line in card.lines if any(line.fields)]
    directions: tuple[int, ...] = ()
    if code != "SPRINGA":
        if not rows:
            raise card.error("the direction is missing; write its number (1 to 3) in the line after the card")
        directions = tuple(rows[0].integer(i, "direction") for i in range(NODES[code]))
        if any(not 1 <= direction <= 3 for direction in directions):
            raise rows[0].error(
                f"direction {max(directions)}: solids have displacements only; give 1 to 3, or hold turns by two springs"
            )
        if len(set(directions)) > 1:
            raise rows[0].error(
                f"directions {directions[0]} and {directions[1]}: both ends of a spring need the same one; write "
                "*EQUATION for others"
            )
        rows = rows[1:]
    if not rows:
        raise card.error("the stiffness is missing; write it in the last line of the card")
    if card.has("NONLINEAR"):
        law: float | tuple[tuple[float, float], ...] = tuple(
            (row.number(1, "elongation"), row.number(0, "force")) for row in rows
        )
    else:
        if len(rows) > 1:
            raise rows[1].error("stiffnesses for several temperatures are not read; give one")
        law = rows[0].number(0, "stiffness")
    return [Spring(name, code, np.array(numbers, np.int64), ends, directions[:1], law, card.place)]
