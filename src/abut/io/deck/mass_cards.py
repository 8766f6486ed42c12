"""Elements MASS with *MASS: in a static step what they weigh, a force at their node."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from abut.io.deck.cards import Card, Line, as_integer, of
from abut.io.deck.reasons import Reasons
from abut.io.deck.spring_cards import members

CODE = "MASS"  # type of the elements, and key of the card that gives their mass
ELEMENTS = "MASSELEMENTS"  # key of *ELEMENT cards with them
LOADS = "DLOAD"


def with_weights(cards: Sequence[Card], vibrates: bool, reasons: Reasons) -> tuple[Card, ...]:
    """The cards with forces (*CLOAD) at the nodes of masses in place of gravity (*DLOAD, GRAV) on these; ``reasons`` gets
    what cannot be said so: other loads on masses, a node that has forces of its own, OP=NEW, and masses that count in
    frequencies (``vibrates``)."""
    nodes: dict[int, int] = {}
    sets: dict[str, list[int]] = {}
    masses: dict[int, float] = {}
    with reasons.gathered():
        _read(cards, nodes, sets, masses)
    if not nodes:
        return tuple(cards)
    if vibrates:
        reasons.add(next(of(cards, CODE)).error("point masses are not there in frequencies; give a dense solid"))
    pushed = {text for card in of(cards, "CLOAD") for line in card.lines if (text := line.text(0))}
    result: list[Card] = []
    for card in cards:
        result.append(card)
        if card.key == LOADS:
            with reasons.gathered():
                rest, forces = _split(card, nodes, sets, masses, pushed)
                result[-1:] = [*([replace(card, lines=rest)] if rest else []), *forces]
    return tuple(result)


def _read(cards: Sequence[Card], nodes: dict[int, int], sets: dict[str, list[int]], masses: dict[int, float]) -> None:
    """Node and mass of each element, and the masses in each set. Raises InputError for elements without a mass."""
    for card in of(cards, ELEMENTS):
        for line in card.lines:
            number = line.integer(0, "element number")
            nodes[number] = line.integer(1, "node number")
            if card.get("ELSET"):
                sets.setdefault(card.need("ELSET").upper(), []).append(number)
    for card in of(cards, "ELSET") if nodes else ():
        sets.setdefault(card.need("ELSET").upper(), []).extend(members(card, nodes, sets))
    for card in of(cards, CODE):
        value = card.first("the mass").number(0, "mass")
        if value < 0.0:
            raise card.lines[0].error(f"mass: expected a number >= 0, got {value:g}")
        masses |= dict.fromkeys(sets.get(card.need("ELSET").upper(), []), value)
    for number in sorted(nodes.keys() - masses.keys())[:1]:
        raise next(of(cards, ELEMENTS)).error(f"element {number} without *MASS; give its set one")


def _split(
    card: Card, nodes: Mapping[int, int], sets: Mapping[str, list[int]], masses: Mapping[int, float], pushed: set[str]
) -> tuple[tuple[Line, ...], list[Card]]:
    """Lines of a *DLOAD that are left, and a card with the forces of the others."""
    rest: list[Line] = []
    forces: list[Line] = []
    for line in card.lines:
        number = as_integer(line.text(0))
        own = sets.get(line.text(0).upper(), []) if number is None else [number] if number in nodes else []
        own = list(nodes) if not line.text(0) else own
        label = line.text(1).upper()
        if number not in nodes:  # a set, which may have solids, too
            rest.append(line)
        if not own:
            continue
        if label != "GRAV":
            raise line.error(f"{label} on point masses is not supported, GRAV is; give their forces by *CLOAD")
        if (card.get("OP") or "").upper() == "NEW":
            raise card.error("OP=NEW with gravity on point masses is not read; give their weight by *CLOAD")
        for element in own:
            forces += _weight(line, str(nodes[element]), masses[element], pushed)
    parameters = {name: value for name, value in card.parameters.items() if name != "OP"}
    made = [Card("CLOAD", "*CLOAD", parameters, tuple(forces), card.place)] if forces else []
    return tuple(rest), made


def _weight(line: Line, node: str, mass: float, pushed: set[str]) -> list[Line]:
    """The force at a node along the axes."""
    if node in pushed:
        raise line.error(f"node {node} has a point mass and a force (*CLOAD); give both as one by *CLOAD")
    value = line.number(2, "magnitude")
    along = [line.number(i, "direction", 0.0) for i in (3, 4, 5)]
    size = sum(x * x for x in along) ** 0.5
    if size == 0.0:
        raise line.error("the direction of gravity is missing; write set, GRAV, value, x, y, z")
    return [
        Line((node, str(k + 1), repr(mass * value * x / size)), line.place, line.card) for k, x in enumerate(along) if x
    ]
