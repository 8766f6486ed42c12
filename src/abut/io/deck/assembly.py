"""Parts, instances and the assembly of a deck written out as the same cards without them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from abut.errors import nearest
from abut.io.deck.cards import Card, Line, as_integer, key
from abut.io.deck.reasons import Reasons
from abut.io.deck.supported import READ

Matrix = NDArray[np.float64]
Change = Callable[[str], str]  # of the text of a field
ENDS = {"PART": "ENDPART", "INSTANCE": "ENDINSTANCE", "ASSEMBLY": "ENDASSEMBLY"}
NAMES = ("NSET", "ELSET", "NAME", "SURFACE")  # parameters with names that belong to the part
INSIDE = ("NODE", "ELEMENT", "NSET", "ELSET", "SURFACE", "SOLIDSECTION", "SHELLSECTION", "MEMBRANESECTION", "BEAMSECTION",
          "NODALTHICKNESS", "NORMAL", "SPRING", "RIGIDBODY", "COUPLING", "KINEMATIC", "DISTRIBUTING", "KINEMATICCOUPLING",
          "DISTRIBUTINGCOUPLING")  # fmt: skip
_READ = {key(name) for name in READ}


@dataclass(frozen=True)
class _Instance:
    """A part in its place: x = turn X + move; ``shift`` is added to its numbers of nodes and elements."""

    name: str
    cards: tuple[Card, ...]
    turn: Matrix
    move: Matrix
    shift: int = 0

    def number(self, text: str) -> str:
        """A number as the whole deck counts, or any other text as it is."""
        value = as_integer(text)
        return text if value is None else str(value + self.shift)

    def member(self, text: str) -> str:
        """A number, or the name of a set of the part, as the whole deck says it."""
        return self.number(text) if not text or as_integer(text) is not None else f"{self.name}.{text}"


def without_parts(cards: tuple[Card, ...], notes: list[str], reasons: Reasons) -> tuple[Card, ...]:
    """The cards of a deck, those of parts once for each instance: their sets and surfaces are called INSTANCE.NAME, their
    nodes and elements have numbers of their own. ``notes`` says which; ``reasons`` gets what is wrong.

    A deck without parts and assembly stays as it is, but for what is left of them, as where their cards were taken out by
    hand."""
    if not any(card.key in ENDS for card in cards):
        return tuple(_left_over(cards, notes))
    flat, instances = _sorted_out(cards, notes, reasons)
    own = _largest(card for card in flat if isinstance(card, Card))
    step = 10 ** len(str(max([own, *(_largest(i.cards) for i in instances.values())])))
    for i, (upper, instance) in enumerate(instances.items()):
        instances[upper] = replace(instance, shift=(i + (own > 0)) * step)
    told = [f"'{i.name}' + {i.shift}" for i in instances.values() if i.shift]
    if told:
        notes.append(f"numbers of nodes and elements are those of the part, in instance {', '.join(told)}")
    result: list[Card] = []
    assembly = next((card.get("NAME") or "" for card in cards if card.key == "ASSEMBLY"), "")
    for item in flat:
        with reasons.gathered(defines=True):
            if isinstance(item, Card):
                result.append(_outside(item, instances, assembly.upper()))
            else:
                result += _written_out(instances[item])
    return tuple(result)


def _left_over(cards: Sequence[Card], notes: list[str]) -> Iterator[Card]:
    """The cards without ends of parts that nothing begins, and without instances that there are none of."""
    for card in cards:
        if card.key in ENDS.values():
            notes.append(f"{card.place}: {card.title}: nothing begins that ends here: left out")
        elif card.key in ("NSET", "ELSET") and card.has("INSTANCE"):
            notes.append(f"{card.place}: {card.title}: INSTANCE: the deck has no instances: left out")
            yield replace(card, parameters={k: v for k, v in card.parameters.items() if k != key("INSTANCE")})
        else:
            yield card


def _sorted_out(
    cards: Sequence[Card], notes: list[str], reasons: Reasons
) -> tuple[list[Card | str], dict[str, _Instance]]:
    """Cards outside of parts, with the name of each instance in its place, in capitals; the instances."""
    parts: dict[str, list[Card]] = {}
    flat: list[Card | str] = []
    instances: dict[str, _Instance] = {}
    used: set[str] = set()
    spelled: list[str] = []
    opened: list[tuple[Card, list[Card]]] = []
    for card in cards:
        with reasons.gathered(defines=True):
            if card.key in ("PART", "INSTANCE"):
                if opened:
                    first = opened.pop()[0]
                    reasons.add(first.error(f"*END {first.key} is missing; add it before line {card.place.line}"))
                opened.append((card, []))
            elif opened and card.key == ENDS[opened[-1][0].key]:
                head, inside = opened.pop()
                if head.key == "PART":
                    spelled.append(head.need("NAME"))
                    parts[spelled[-1].upper()] = inside
                    continue
                name, part = head.need("NAME"), head.need("PART")
                if part.upper() not in parts:
                    raise head.error(f"no *PART named {part!r}{nearest(part, spelled)}")
                used.add(part.upper())
                turn, move = _position(head)
                instances[name.upper()] = _Instance(name, (*parts[part.upper()], *inside), turn, move)
                flat.append(name.upper())
            elif opened:
                opened[-1][1].append(card)
            elif card.key not in (*ENDS, *ENDS.values()):
                flat.append(card)
    for head, _ in opened:
        reasons.add(head.error(f"*END {head.key} is missing; add it"), defines=True)
    notes += [f"part '{name}' has no instance: left out" for name in spelled if name.upper() not in used]
    return flat, instances


def _largest(cards: Sequence[Card] | Iterator[Card]) -> int:
    """The largest number of a node or element."""
    numbers = (as_integer(line.text(0)) for card in cards if card.key in ("NODE", "ELEMENT") for line in card.lines)
    return max((number or 0 for number in numbers), default=0)


def _position(card: Card) -> tuple[Matrix, Matrix]:
    """Turn and move of an instance: its first line moves it, its second one turns it about the axis from a to b."""
    move = np.zeros(3)
    if card.lines:
        move = np.array([card.lines[0].number(i, "translation", 0.0) for i in range(3)])
    if len(card.lines) < 2:
        return np.eye(3), move
    line = card.lines[1]
    a, b = (np.array([line.number(i + k, "point of the axis", 0.0) for k in range(3)]) for i in (0, 3))
    length = float(np.linalg.norm(b - a))
    if length == 0.0:
        raise line.error("the two points of the axis are the same")
    angle = line.number(6, "angle in degrees")
    turn = Rotation.from_rotvec(np.radians(angle) * (b - a) / length).as_matrix()
    return turn, turn @ (move - a) + a


def _written_out(instance: _Instance) -> Iterator[Card]:
    """The cards of a part as they stand for one instance."""
    for card in instance.cards:
        if card.key not in INSIDE:
            if card.key in _READ:
                raise card.error("it is not read within a *PART; move it behind *END ASSEMBLY")
            yield card
            continue
        parameters = {
            name: instance.member(value) if value and (name in NAMES or name.endswith("NODE")) else value
            for name, value in card.parameters.items()
        }
        yield replace(card, parameters=parameters, lines=tuple(_line(card, line, instance) for line in card.lines))


def _line(card: Card, line: Line, instance: _Instance) -> Line:
    if card.key == "NODE":
        x = np.array([line.number(i, "coordinate", 0.0) for i in (1, 2, 3)])
        x = instance.turn @ x + instance.move
        return replace(line, fields=(instance.number(line.text(0)), *(repr(float(c)) for c in x)))
    if card.key == "ELEMENT":
        return _changed(line, instance.number)
    if card.key in ("NSET", "ELSET"):
        return _changed(line, instance.member, 2 if card.has("GENERATE") else None)
    if card.key == "NORMAL":
        normal = instance.turn @ np.array([line.number(i, "component of the normal", 0.0) for i in (2, 3, 4)])
        return replace(line, fields=(*map(instance.member, line.fields[:2]), *(repr(float(c)) for c in normal)))
    return (
        _changed(line, instance.member, 1)
        if card.key in ("SURFACE", "NODALTHICKNESS", "KINEMATICCOUPLING", "DISTRIBUTINGCOUPLING")
        else line
    )


def _changed(line: Line, change: Change, count: int | None = None) -> Line:
    """With the first ``count`` fields changed, or all."""
    fields = line.fields if count is None else line.fields[:count]
    return replace(line, fields=(*map(change, fields), *line.fields[len(fields) :]))


def _outside(card: Card, instances: Mapping[str, _Instance], assembly: str) -> Card:
    """A card of the assembly or the model, with INSTANCE.NUMBER as the number in the whole deck."""

    def named(text: str) -> str:
        before, _, rest = text.partition(".")
        if assembly and before.upper() == assembly:
            return named(rest)
        instance = instances.get(before.upper())
        return text if instance is None or as_integer(rest) is None else instance.number(rest)

    name = card.get("INSTANCE") if card.key in ("NSET", "ELSET") else None
    if name is None:
        parameters = {p: named(value) if value else value for p, value in card.parameters.items()}
        return replace(card, parameters=parameters, lines=tuple(_changed(line, named) for line in card.lines))
    if name.upper() not in instances:
        raise card.error(f"no *INSTANCE named {name!r}{nearest(name, [i.name for i in instances.values()])}")
    instance = instances[name.upper()]
    parameters = {p: value for p, value in card.parameters.items() if p != "INSTANCE"}
    if card.key == "NSET" and parameters.get("ELSET"):
        parameters["ELSET"] = instance.member(str(parameters["ELSET"]))
    count = 2 if card.has("GENERATE") else None
    return replace(card, parameters=parameters, lines=tuple(_changed(x, instance.member, count) for x in card.lines))
