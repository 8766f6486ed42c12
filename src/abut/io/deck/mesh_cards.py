"""Nodes, elements, sets and surfaces of a deck."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from abut.cells import CELLS
from abut.errors import nearest
from abut.io.deck.cards import Card, Line, as_integer, key
from abut.io.deck.elements import DASHPOTS, ELEMENTS, FACES, refusal
from abut.io.deck.mass_cards import ELEMENTS as MASSES
from abut.io.deck.reasons import Place, Reasons
from abut.io.deck.record import Block, Faces, Numbers
from abut.io.deck.spring_cards import ELEMENTS as SPRINGS

SIDES = {"SNEG": "S1", "SPOS": "S2"}  # of shells and membranes
SURFACES = ("shell", "membrane")
POINTS = "DCOUP"  # elements that only bear the weights of *DISTRIBUTING COUPLING
MOST = 10_000_000  # numbers in one GENERATE, or elements of a set, beyond which a deck is wrong


@dataclass
class Names:
    """Sets by their name in any case; ``spelled`` keeps the first spelling, ``order`` the members of sets that are UNSORTED
    in the order of the deck, ``repeated`` those that a set names more than once. Filled while the mesh cards are read."""

    sets: dict[str, Numbers] = field(default_factory=dict)
    spelled: dict[str, str] = field(default_factory=dict)
    order: dict[str, Numbers] = field(default_factory=dict)
    repeated: dict[str, Numbers] = field(default_factory=dict)

    def add(self, name: str, numbers: Numbers, unsorted: bool = False) -> None:
        upper = name.upper()
        self.spelled.setdefault(upper, name)
        known = self.sets.get(upper, numbers[:0])
        if unsorted or upper in self.order:
            self.order[upper] = np.concatenate([self.order.get(upper, known), numbers])
        members, times = np.unique(np.concatenate([known, numbers]), return_counts=True)
        self.sets[upper] = members
        self.repeated[upper] = np.union1d(self.repeated.get(upper, known[:0]), members[times > 1])

    def by_name(self) -> dict[str, Numbers]:
        return {self.spelled[name]: numbers for name, numbers in self.sets.items()}

    def like(self, name: str) -> str:
        """What may have been meant, to end a message; not the sets that Abaqus/CAE makes for itself, _NAME."""
        return nearest(name, [each for each in self.spelled.values() if not each.rpartition(".")[2].startswith("_")])

    def resolve(self, line: Line, i: int, what: str, ordered: bool = False) -> Numbers:
        """Field i of a line: a number, or the name of a set, in its own order where that counts (``ordered``)."""
        text = line.text(i)
        number = as_integer(text)
        if number is not None:
            return np.array([number], dtype=np.int64)
        if text.upper() not in self.sets:
            raise line.unknown(f"no {what} set named {text!r}{self.like(text)}")
        members = self.sets[text.upper()]
        return self.order.get(text.upper(), members) if ordered else members


@dataclass(frozen=True)
class MeshCards:
    """What the mesh cards say; see ``record.Deck``. numbers: of all nodes; kinds: cell type of each element,
    expanded where it is thin; shells: their numbers, and those of membranes."""

    nodes: Numbers
    points: np.ndarray[tuple[int, ...], np.dtype[np.float64]]
    blocks: tuple[Block, ...]
    node_sets: Names
    element_sets: Names
    surfaces: Mapping[str, Faces]
    numbers: frozenset[int]
    kinds: Mapping[int, str]
    shells: frozenset[int]
    virtual: frozenset[int] = frozenset()  # nodes that only *PRE-TENSION SECTION names

    def existing(self, line: Line, i: int, ordered: bool = False) -> Numbers:
        """The nodes that field i of a line names. Raises InputError for none, and for a number that no node has."""
        nodes = self.node_sets.resolve(line, i, "node", ordered)
        if not len(nodes):
            raise line.unknown(f"node set '{line.text(i)}' is empty")
        if len(nodes) == 1 and int(nodes[0]) not in self.numbers and int(nodes[0]) not in self.virtual:
            raise line.unknown(f"node {nodes[0]} does not exist; give it in *NODE")
        return nodes


def mesh_cards(cards: Iterable[Card], notes: list[str], reasons: Reasons) -> MeshCards:
    """Read the mesh cards: nodes, elements, then sets in their order, then surfaces; ``notes`` gets what was left out,
    ``reasons`` what is wrong."""
    nodes: dict[int, tuple[float, float, float]] = {}
    elements: dict[int, tuple[str, tuple[int, ...]]] = {}
    node_sets, element_sets = Names(), Names()
    surfaces: dict[tuple[str, bool], Faces] = {}
    cards = tuple(cards)
    virtual = _of_sections(cards)

    def read(card: Card) -> None:
        if card.key == "NODE":
            members = _nodes(card, nodes)
            if card.get("NSET"):
                node_sets.add(card.need("NSET"), members)
        elif card.key == "ELEMENT":
            members = _elements(card, elements, nodes, notes)
            if card.get("ELSET"):
                element_sets.add(card.need("ELSET"), members)
        elif card.key == "NSET":
            members = _set(card, "node", node_sets, element_sets, elements)
            node_sets.add(card.need("NSET"), _present(card, "node", members, there, notes), card.has("UNSORTED"))
        elif card.key == "ELSET":
            members = _set(card, "element", element_sets, element_sets, elements)
            members = _present(card, "element", members, {*elements, *springs} if springs else elements, notes)
            element_sets.add(card.need("ELSET"), np.array([e for e in members.tolist() if e in elements], np.int64))
        elif card.key in (POINTS, SPRINGS, MASSES, DASHPOTS):
            if card.key != POINTS:
                springs.update(number for line in card.lines if (number := as_integer(line.text(0))) is not None)
            if card.get("ELSET"):  # of elements with a volume
                element_sets.add(card.need("ELSET"), np.empty(0, np.int64))
        else:
            surface = _surface(card, node_sets, element_sets, elements)
            here = (surface.name.upper(), surface.nodes is not None)
            surfaces[here] = _joined(surfaces[here], surface) if here in surfaces else surface

    springs: set[int] = set()
    there: Collection[int] = ()
    for keys in (("NODE",), ("ELEMENT",), (SPRINGS, POINTS, MASSES, DASHPOTS), ("NSET", "ELSET"), ("SURFACE",)):
        there = {*nodes, *virtual}
        for card in cards:
            if card.key in keys:
                with reasons.gathered(defines=True):
                    read(card)
    ids = np.array(sorted(nodes), dtype=np.int64)
    points = np.array([nodes[i] for i in ids.tolist()], dtype=float).reshape(-1, 3)
    places = {key(card.get("TYPE") or ""): card.place for card in reversed(cards) if card.key == "ELEMENT"}
    kinds = {number: ELEMENTS[code].solid for number, (code, _) in elements.items()}
    return MeshCards(
        ids,
        points,
        _blocks(elements, places),
        node_sets,
        element_sets,
        _named(surfaces),
        frozenset(nodes),
        kinds,
        frozenset(number for number, (code, _) in elements.items() if ELEMENTS[code].thin in SURFACES),
        virtual,
    )


def _of_sections(cards: Iterable[Card]) -> frozenset[int]:
    """Nodes that stand for the shortening of pre-tension sections; they need no place."""
    named = (as_integer(card.get("NODE") or "") for card in cards if card.key == "PRE-TENSIONSECTION")
    return frozenset(number for number in named if number is not None)


def _joined(one: Faces, other: Faces) -> Faces:
    """A surface that is given twice."""
    if one.nodes is None or other.nodes is None:
        return replace(one, faces=(*one.faces, *other.faces))
    return replace(one, nodes=np.union1d(one.nodes, other.nodes))


def _named(surfaces: dict[tuple[str, bool], Faces]) -> dict[str, Faces]:
    """By name; where a name stands for faces and for nodes (CalculiX allows both), faces win."""
    return {name: s for (name, by_nodes), s in surfaces.items() if not (by_nodes and (name, False) in surfaces)}


def _nodes(card: Card, nodes: dict[int, tuple[float, float, float]]) -> Numbers:
    numbers = []
    system = key(card.get("SYSTEM", "R") or "R")
    if system not in ("R", "C"):
        raise card.error(
            f"SYSTEM={system} is not read; write coordinates along x, y and z, or SYSTEM=C (radius, degrees, z)"
        )
    for line in card.lines:
        number = line.integer(0, "node number")
        x = (line.number(1, "x", 0.0), line.number(2, "y", 0.0), line.number(3, "z", 0.0))
        if system == "C":
            angle = math.radians(x[1])
            x = (x[0] * math.cos(angle), x[0] * math.sin(angle), x[2])
        if nodes.setdefault(number, x) != x:
            raise line.error(f"node {number} is given twice, in different places; take one of them out")
        numbers.append(number)
    return np.array(numbers, dtype=np.int64)


def _elements(
    card: Card,
    elements: dict[int, tuple[str, tuple[int, ...]]],
    nodes: Mapping[int, tuple[float, float, float]],
    notes: list[str],
) -> Numbers:
    code = key(card.need("TYPE"))
    if code not in ELEMENTS:
        raise card.error(refusal(code))
    count = CELLS[ELEMENTS[code].kind].nodes
    listed: list[int] = []
    numbers: list[int] = []
    start = card.lines[0] if card.lines else None
    excess: Line | None = None
    for line in card.lines:
        start = start if numbers and start else line
        last = len(line.fields) - (line.fields[-1] == "")
        numbers += [line.integer(i, "node number" if numbers or i else "element number") for i in range(last)]
        if len(numbers) <= count:
            continue
        if len(numbers) > count + 1 and start is line and line.fields[-1] == "":  # a line for each, ended by a comma
            excess, numbers = excess or start, numbers[: count + 1]
        if len(numbers) > count + 1:
            raise start.error(f"element {numbers[0]} has {len(numbers) - 1} nodes, but {code} needs {count}")
        for node in numbers[1:]:
            if node not in nodes:
                raise start.unknown(f"element {numbers[0]}: node {node} does not exist; give it in *NODE")
        if numbers[0] in elements:
            raise start.error(f"element {numbers[0]} is given twice; give each element its own number")
        elements[numbers[0]] = (code, tuple(numbers[1:]))
        listed.append(numbers[0])
        numbers = []
    if numbers and start:
        raise start.error(f"element {numbers[0]} has {len(numbers) - 1} nodes, but {code} needs {count}")
    if excess is not None:
        notes.append(f"{excess.place}: *ELEMENT: more nodes on a line than {code} has: the first {count} count")
    return np.array(listed, dtype=np.int64)


def _blocks(elements: dict[int, tuple[str, tuple[int, ...]]], places: Mapping[str, Place]) -> tuple[Block, ...]:
    by_code: dict[str, list[int]] = {}
    for number, (code, _) in elements.items():
        by_code.setdefault(code, []).append(number)
    return tuple(
        Block(
            code,
            ELEMENTS[code],
            np.array(of_type, np.int64),
            np.array([elements[i][1] for i in of_type], np.int64),
            places[code],
        )
        for code, of_type in by_code.items()
    )


def _set(
    card: Card, what: str, names: Names, element_sets: Names, elements: Mapping[int, tuple[str, tuple[int, ...]]]
) -> Numbers:
    if what == "node" and card.get("ELSET"):
        name = card.need("ELSET")
        if name.upper() not in element_sets.sets:
            raise card.unknown(f"no element set named {name!r}{element_sets.like(name)}")
        members = element_sets.sets[name.upper()].tolist()
        return np.unique(np.array([n for e in members for n in elements[e][1]], dtype=np.int64))
    parts: list[Numbers] = [np.empty(0, np.int64)]
    for line in card.lines:
        if card.has("GENERATE"):
            first, last = (
                line.integer(0, "first number"),
                line.integer(1, "last number", line.integer(0, "first number")),
            )
            step = line.integer(2, "increment", 1)
            if (last - first) // step > MOST:
                raise line.error(f"{(last - first) // step} numbers in one set; check the line")
            parts.append(np.arange(first, last + 1, step, dtype=np.int64))
            continue
        parts += [names.resolve(line, i, what, card.has("UNSORTED")) for i, text in enumerate(line.fields) if text]
    return np.concatenate(parts)


def _present(card: Card, what: str, numbers: Numbers, known: Collection[int], notes: list[str]) -> Numbers:
    """The members that exist. GENERATE may jump over gaps; others that are missing are noted, as CalculiX warns of them."""
    there = np.array([number in known for number in numbers.tolist()], dtype=bool)
    missing = np.unique(numbers[~there])
    if len(missing) and not card.has("GENERATE"):
        name = card.need("NSET" if what == "node" else "ELSET")
        more = f" and {len(missing) - 1} more" if len(missing) > 1 else ""
        notes.append(f"{card.place}: {card.title}: {what} {missing[0]}{more} of set '{name}' does not exist: left out")
    return numbers[there]


def _surface(
    card: Card, node_sets: Names, element_sets: Names, elements: Mapping[int, tuple[str, tuple[int, ...]]]
) -> Faces:
    name, kind = card.need("NAME"), key(card.get("TYPE", "ELEMENT") or "")
    if kind not in ("ELEMENT", "NODE"):
        raise card.error(f"TYPE={kind}: only surfaces of element faces (ELEMENT) and of nodes (NODE) are read")
    if kind == "NODE":
        nodes = [np.empty(0, np.int64), *(node_sets.resolve(line, 0, "node") for line in card.lines)]
        return Faces(name, card.place, (), np.unique(np.concatenate(nodes)))
    faces = []
    for line in card.lines:
        members = element_sets.resolve(line, 0, "element")
        for number in members.tolist():
            if number not in elements:
                raise line.unknown(f"element {number} does not exist")
        face = 0
        if line.text(1):
            label = line.text(1).upper()
            types = [ELEMENTS[elements[e][0]] for e in members.tolist()]
            label = SIDES.get(label, label) if all(t.thin in SURFACES for t in types) else label
            face = face_number(line, label, "S", {t.solid for t in types})
        faces.append((members, face))
    return Faces(name, card.place, tuple(faces))


def face_number(line: Line, label: str, letter: str, kinds: Iterable[str]) -> int:
    """The number in S1 or P1, which every one of the cell kinds must have."""
    number = as_integer(label[1:]) if label.startswith(letter) else None
    most = min((len(FACES[kind]) for kind in kinds), default=6)
    if number is None or number > most:
        raise line.error(f"face label {label!r}: expected {letter}1 to {letter}{most}")
    return number
