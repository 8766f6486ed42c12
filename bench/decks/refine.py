"""Decks with every hexahedron cut into eight, for asking what several codes converge to.

New nodes lie where the parent's own shape functions put them, so that a curved cell keeps its shape. A new node is in a node
set if all nodes of the parent's edge or face that it lies on are; nodes keep their numbers, and forces at them stay.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from cards import Card

from abut._core import shape_functions
from abut.cells import CELLS

KINDS = {"C3D8": "hex8", "C3D20": "hex20", "C3D20R": "hex20"}
CORNERS = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], dtype=float
)
EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
# Axis and side of the faces 1 to 6
FACES = ((2, -1), (2, 1), (1, -1), (0, 1), (1, 1), (0, -1))
FLAT = 1e-9  # thickness over extent
DIGITS = 9  # of a shape function, to tell nodes by


def refine(cards: Sequence[Card]) -> list[Card]:
    """A deck of hexahedra, each cut into eight. Raises ValueError for other elements."""
    nodes = {int(row[0]): np.array(row[1:4], dtype=float) for row in _rows(cards, "NODE")}
    made: dict[tuple[tuple[int, float], ...], int] = {}
    parents: dict[int, list[int]] = {}
    children: dict[int, list[int]] = {}
    result: list[Card] = []
    free = max(nodes) + 1
    number = 1

    for card in cards:
        if card.name != "ELEMENT":
            continue
        kind = card.options["TYPE"].upper()
        if kind not in KINDS:
            raise ValueError(f"*ELEMENT, TYPE={kind}: only hexahedra are cut into eight")
        positions = _positions(KINDS[kind])
        values, _ = shape_functions(CELLS[KINDS[kind]].code, np.ascontiguousarray(positions.reshape(-1, 3)))
        lines = []
        for own in _elements(card):
            found = []
            for value in values:
                used = np.flatnonzero(abs(value) > 1e-12)
                key = tuple(sorted((own[i + 1], round(float(value[i]), DIGITS)) for i in used))
                if key not in made:
                    if len(key) == 1:
                        made[key] = key[0][0]
                    else:
                        made[key] = free
                        nodes[free] = sum(value[i] * nodes[own[i + 1]] for i in used)
                        free += 1
                    parents[made[key]] = [n for n, _ in key]
                found.append(made[key])
            children[own[0]] = list(range(number, number + 8))
            for row in np.array(found).reshape(8, -1):
                lines += _lines([number, *row.tolist()])
                number += 1
        result.append(replace(card, data=tuple(lines)))

    def face(element: int, number: int) -> list[int]:
        axis, side = FACES[number - 1]
        return [children[element][i] for i in range(8) if CORNERS[i, axis] == side]

    head = next(card for card in cards if card.name == "NODE")
    others = [_carried(card, parents, children, face) for card in cards if card.name not in ("NODE", "ELEMENT")]
    lines = [f"{n}, " + ", ".join(f"{float(x):.12e}" for x in at) for n, at in nodes.items()]
    return [replace(head, data=tuple(lines)), *result, *others]


def _carried(
    card: Card, parents: dict[int, list[int]], children: dict[int, list[int]], face: Callable[[int, int], list[int]]
) -> Card:
    """A card of a set, a surface or a pressure for the cut cells; any other as it is."""
    if card.name == "NSET":
        inside = {int(x) for line in card.data for x in line.split(",") if x.strip()}
        inside |= {n for n, of in parents.items() if inside.issuperset(of)}
        return replace(card, data=tuple(f"{n}," for n in sorted(inside)))
    if card.name == "ELSET":
        numbers = [n for line in card.data for x in line.split(",") if x.strip() for n in children[int(x)]]
        return replace(card, data=tuple(f"{n}," for n in numbers))
    if card.name in ("SURFACE", "DLOAD"):
        lines = []
        for line in card.data:
            element, label, *rest = (x.strip() for x in line.split(","))
            lines += [", ".join([str(n), label, *rest]) for n in face(int(element), int(label[1:]))]
        return replace(card, data=tuple(lines))
    return card


def _positions(kind: str) -> np.ndarray:
    """Reference coordinates (8, nodes, 3) of the nodes of the eight cells, in the parent's order of nodes and directions."""
    own = CORNERS
    if kind == "hex20":
        own = np.vstack([CORNERS, [0.5 * (CORNERS[i] + CORNERS[j]) for i, j in EDGES]])
    return np.array([0.5 * own + 0.5 * corner for corner in CORNERS])


def _rows(cards: Sequence[Card], name: str) -> list[list[str]]:
    return [line.split(",") for card in cards if card.name == name for line in card.data]


def _elements(card: Card) -> list[list[int]]:
    """Number and nodes of each element of a card."""
    width = 1 + CELLS[KINDS[card.options["TYPE"].upper()]].nodes
    numbers = [int(x) for line in card.data for x in line.split(",") if x.strip()]
    return [numbers[i : i + width] for i in range(0, len(numbers), width)]


def _lines(numbers: Sequence[int]) -> list[str]:
    rows = [", ".join(map(str, numbers[i : i + 11])) for i in range(0, len(numbers), 11)]
    return [row + "," for row in rows[:-1]] + rows[-1:]


def adjusted(cards: Sequence[Card]) -> list[Card]:
    """A deck with what ADJUST asks for done to its nodes: slave nodes are moved onto the master surface, which is flat, and
    ADJUST is left out. Raises ValueError for a master that is not flat."""
    nodes = {int(row[0]): np.array(row[1:4], dtype=float) for row in _rows(cards, "NODE")}
    cells = {own[0]: (card, own[1:]) for card in cards if card.name == "ELEMENT" for own in _elements(card)}
    surfaces = {card.options["NAME"].upper(): card for card in cards if card.name == "SURFACE"}
    sets = {card.options["NSET"].upper(): card for card in cards if card.name == "NSET"}

    def on(name: str) -> list[int]:
        found: set[int] = set()
        for line in surfaces[name.upper()].data:
            element, label = (x.strip() for x in line.split(",")[:2])
            card, own = cells[int(element)]
            cell = KINDS[card.options["TYPE"].upper()]
            places = (
                CORNERS if cell == "hex8" else np.vstack([CORNERS, [0.5 * (CORNERS[i] + CORNERS[j]) for i, j in EDGES]])
            )
            axis, side = FACES[int(label[1:]) - 1]
            found |= {n for n, place in zip(own, places) if place[axis] == side}
        return sorted(found)

    for pair in (card for card in cards if card.name == "CONTACT PAIR" and "ADJUST" in card.options):
        slave, master = (name.strip() for name in pair.data[0].split(","))
        flat = np.array([nodes[n] for n in on(master)])
        centre = flat.mean(axis=0)
        _, size, axes = np.linalg.svd(flat - centre)
        if size[2] > FLAT * size[0]:
            raise ValueError(f"*CONTACT PAIR, ADJUST: master surface {master} is not flat")
        which = pair.options["ADJUST"]
        listed = sets.get(which.upper())
        chosen = None if listed is None else {int(x) for line in listed.data for x in line.split(",") if x.strip()}
        for n in on(slave):
            distance = (nodes[n] - centre) @ axes[2]
            if abs(distance) <= float(which) if chosen is None else n in chosen:
                nodes[n] = nodes[n] - distance * axes[2]
    lines = tuple(f"{n}, " + ", ".join(f"{float(x):.12e}" for x in at) for n, at in nodes.items())
    head = next(card for card in cards if card.name == "NODE")
    return [
        replace(head, data=lines) if card is head else card.without("ADJUST")
        for card in cards
        if card.name != "NODE" or card is head
    ]
