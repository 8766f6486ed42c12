"""Materials, sections, equations, rigid bodies, symmetry and pre-tension of a deck."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import takewhile

import numpy as np

from abut.errors import nearest
from abut.io.deck.cards import Card, Line, as_float, as_integer, key, of
from abut.io.deck.contact_cards import sides
from abut.io.deck.elastic_cards import elastic, expansion
from abut.io.deck.gathered import Gathered
from abut.io.deck.mesh_cards import MeshCards
from abut.io.deck.multipoint_cards import gathered, multipoint
from abut.io.deck.plastic_cards import hardening
from abut.io.deck.pretension_record import PreTension
from abut.io.deck.reasons import Reasons
from abut.io.deck.record import (
    NO_CONSTANTS,
    CyclicSymmetry,
    Elastic,
    Equation,
    Expansion,
    Material,
    Numbers,
    RigidBody,
    Transform,
)
from abut.io.deck.rubber_cards import rubber

EMPTY = np.empty(0, np.int64)
SEVERAL = "values that depend on temperature (several rows) are not supported here; give one row, that which matters"


PROPERTIES = ("ELASTIC", "HYPERELASTIC", "PLASTIC", "CYCLICHARDENING", "DENSITY", "EXPANSION")  # of a material


def materials(cards: Sequence[Card], reasons: Reasons) -> dict[str, Material]:
    """Materials by name in capitals; ``reasons`` gets what abut does not know."""
    result: dict[str, Material] = {}
    for i, card in enumerate(cards):
        if card.key == "MATERIAL":
            with reasons.gathered(defines=True):
                material = _material(card, cards[i + 1 :])
                result[material.name.upper()] = material
    return result


def _material(card: Card, following: Sequence[Card]) -> Material:
    options = {
        option.key: option for option in takewhile(lambda following_card: following_card.key in PROPERTIES, following)
    }
    name = card.need("NAME")
    if "ELASTIC" in options and "HYPERELASTIC" in options:
        raise options["HYPERELASTIC"].error(f"material '{name}' has *ELASTIC as well; give one of them")
    law = rubber(options["HYPERELASTIC"]) if "HYPERELASTIC" in options else None
    if law is not None and "PLASTIC" in options:
        raise options["PLASTIC"].error(f"material '{name}' has *HYPERELASTIC as well; give one of them")
    if law is not None:
        constants = NO_CONSTANTS
    elif "ELASTIC" in options:
        constants = elastic(options["ELASTIC"])
    else:
        raise card.error(f"material '{name}' has no *ELASTIC; give Young's modulus and Poisson's ratio")
    density = _density(options["DENSITY"]) if "DENSITY" in options else 0.0
    swelling = expansion(options["EXPANSION"]) if "EXPANSION" in options else Expansion()
    metal = hardening(options)
    if law is not None or metal:
        _check_plain(options, constants, swelling, law is not None)
    return Material(name, constants, density, swelling, card.place, law, metal, "DENSITY" in options)


def _check_plain(options: Mapping[str, Card], constants: Elastic, swelling: Expansion, rubber: bool) -> None:
    """Raise for what metal that yields and rubber cannot have."""
    for name, rows in (("ELASTIC", constants.rows), ("EXPANSION", swelling.rows)):
        if rubber and len(rows) > 1:
            raise options[name].lines[1].error(SEVERAL)
    if constants.kind != "isotropic":
        raise options["ELASTIC"].error("metal that yields is isotropic here; give TYPE=ISO")
    if len(swelling.rows[0][1]) > 1:
        raise options["EXPANSION"].error(
            "metal that yields and rubber expand alike in all directions here; give TYPE=ISO"
        )


def _density(card: Card) -> float:
    """The same at every temperature."""
    result = card.first("density").number(0, "density")
    for line in card.lines[1:]:
        if line.number(0, "density") != result:
            raise line.error(SEVERAL)
    return result


def equations(cards: Sequence[Card], mesh: MeshCards, reasons: Reasons) -> tuple[Equation, ...]:
    """*EQUATION, and *MPC, which are equations between displacements."""
    result: list[Equation] = []
    finite = is_finite(cards)
    for card in of(cards, "EQUATION"):
        with reasons.gathered():
            for head, fields in _terms(card):
                result += _equations(head, fields, mesh)
    for card in of(cards, "MPC"):
        with reasons.gathered():
            result += multipoint(card, mesh, finite)
    return tuple(result)


def is_finite(cards: Sequence[Card]) -> bool:
    """Whether a step has NLGEOM."""
    return any(card.has("NLGEOM") and key(card.get("NLGEOM") or "") != "NO" for card in of(cards, "STEP"))


def bound_together(cards: Sequence[Card], mesh: MeshCards, reasons: Reasons) -> tuple[Gathered, ...]:
    """What *MPC binds by products of displacements."""
    result: list[Gathered] = []
    for card in of(cards, "MPC"):
        with reasons.gathered():
            result += gathered(card, mesh, is_finite(cards))
    return tuple(result)


def _terms(card: Card) -> Iterator[tuple[Line, list[tuple[Line, int]]]]:
    """For each equation of a card its first line, and the entries (line, field) of its terms."""
    lines = list(card.lines)
    while lines:
        head = lines.pop(0)
        count = head.integer(0, "number of terms")
        fields: list[tuple[Line, int]] = []
        while len(fields) < 3 * count:
            if not lines:
                raise head.error(f"{count} terms announced, but {len(fields) // 3} given; add the missing lines")
            line = lines.pop(0)
            last = len(line.fields) - (line.fields[-1] == "")
            fields += [(line, i) for i in range(last)]
        if len(fields) > 3 * count:
            raise head.error(f"{count} terms announced, but more entries follow; check the lines")
        yield head, fields


def _equations(head: Line, fields: list[tuple[Line, int]], mesh: MeshCards) -> list[Equation]:
    """One equation, or one for each node of the sets that stand in its terms."""
    sets, rest = [], []
    for (line, i), (other, j), (third, k) in zip(fields[::3], fields[1::3], fields[2::3]):
        sets.append(mesh.existing(line, i, ordered=True))
        rest.append((_direction(other, j), third.number(k, "coefficient")))
    count = max(len(numbers) for numbers in sets)
    if any(len(numbers) not in (1, count) for numbers in sets):
        raise head.error("node sets of one equation must have the same number of nodes")
    if rest[0][1] == 0.0:
        raise head.error("the first coefficient is zero; take the term out")
    return [
        Equation(
            tuple((int(n[i if len(n) > 1 else 0]), d, c) for n, (d, c) in zip(sets, rest)),
            head.place,
        )
        for i in range(count)
    ]


def _direction(line: Line, i: int) -> int:
    direction = line.integer(i, "direction")
    if direction > 6:
        raise line.error(f"direction {direction}: expected 1 to 3 (displacements) or 4 to 6 (turns of nodes of shells)")
    return direction


def rigid_bodies(cards: Sequence[Card], mesh: MeshCards, reasons: Reasons) -> tuple[RigidBody, ...]:
    """*RIGID BODY; the reference node is 0 where none is named."""
    result = []
    for card in of(cards, "RIGID BODY"):
        with reasons.gathered():
            nodes, elements = EMPTY, EMPTY
            if card.get("NSET"):
                nodes = _named(card, "NSET", mesh.node_sets.sets, "node")
            elif card.get("ELSET"):
                elements = _named(card, "ELSET", mesh.element_sets.sets, "element")
            else:
                raise card.error("give the body's nodes (NSET) or elements (ELSET)")
            reference = one_node(card, "REF NODE", mesh) if card.has("REF NODE") else 0
            turning = one_node(card, "ROT NODE", mesh) if card.has("ROT NODE") else 0
            result.append(RigidBody(nodes, elements, reference, turning, card.place))
    return tuple(result)


def _named(card: Card, parameter: str, sets: Mapping[str, Numbers], what: str) -> Numbers:
    name = card.need(parameter)
    if name.upper() not in sets:
        raise card.unknown(f"no {what} set named {name!r}{nearest(name.upper(), sets)}")
    return sets[name.upper()]


def one_node(card: Card, parameter: str, mesh: MeshCards) -> int:
    """The node that a parameter names, by its number or a set of it alone."""
    text = card.need(parameter)
    number = as_integer(text)
    if number is not None:
        return number
    if text.upper() not in mesh.node_sets.sets:
        raise card.unknown(
            f"{parameter}: expected a node number or a set of one node, got {text!r}{mesh.node_sets.like(text)}"
        )
    nodes = mesh.node_sets.sets[text.upper()]
    if len(nodes) != 1:
        raise card.error(f"{parameter}: expected one node, but the set '{text}' has {len(nodes)}")
    return int(nodes[0])


def transforms(cards: Sequence[Card], mesh: MeshCards, reasons: Reasons) -> tuple[Transform, ...]:
    result = []
    for card in of(cards, "TRANSFORM"):
        with reasons.gathered():
            kind = key(card.get("TYPE", "R") or "R")
            if kind not in ("R", "C"):
                raise card.error(f"TYPE={kind} is not supported; R (rectangular) and C (cylindrical) are")
            a, b = two_points(card.first("two points"))
            result.append(Transform(_named(card, "NSET", mesh.node_sets.sets, "node"), kind, a, b, card.place))
    return tuple(result)


def two_points(line: Line) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Six numbers of a line as two different points."""
    x = [line.number(i, "coordinate", 0.0) for i in range(6)]
    a, b = (x[0], x[1], x[2]), (x[3], x[4], x[5])
    if a == b:
        raise line.error("the two points are the same")
    return a, b


def cyclic_symmetry(cards: Sequence[Card], mesh: MeshCards, reasons: Reasons) -> tuple[CyclicSymmetry, ...]:
    ties: dict[str, Card] = {}
    for card in of(cards, "TIE"):
        with reasons.gathered():
            if card.has("CYCLIC SYMMETRY"):
                ties[card.need("NAME").upper()] = card
    result = []
    for card in of(cards, "CYCLIC SYMMETRY MODEL"):
        with reasons.gathered():
            name = card.get("TIE") or next(iter(ties), "")
            tie = ties.pop(name.upper(), None)
            if tie is None:
                raise card.unknown(f"no *TIE, CYCLIC SYMMETRY named {name!r}; give one, and name it once")
            sectors = as_float(card.need("N"))
            if sectors is None or sectors < 2.0:
                raise card.error(f"N: expected the number of sectors in the whole turn, >= 2, got {card.need('N')!r}")
            a, b = two_points(card.first("two points of the axis"))
            _, slave, master = next(sides(tie, mesh))
            result.append(CyclicSymmetry(sectors, slave, master, a, b, card.place))
    for tie in ties.values():
        reasons.add(tie.error("a *TIE, CYCLIC SYMMETRY without a *CYCLIC SYMMETRY MODEL that names it; add one"))
    return tuple(result)


def pretension_sections(cards: Sequence[Card], mesh: MeshCards, reasons: Reasons) -> tuple[PreTension, ...]:
    result = []
    for card in of(cards, "PRE-TENSION SECTION"):
        with reasons.gathered():
            result.append(_pretension(card, mesh))
    return tuple(result)


def _pretension(card: Card, mesh: MeshCards) -> PreTension:
    normal = None
    if card.lines:
        line = card.lines[0]
        normal = (line.number(0, "normal", 0.0), line.number(1, "normal", 0.0), line.number(2, "normal", 0.0))
        if normal == (0.0, 0.0, 0.0):
            raise line.error("the normal is zero; leave the line out for the surface's own")
    node = one_node(card, "NODE", mesh)
    if card.has("ELEMENT"):
        return PreTension("", node, normal, card.place, _one_element(card, mesh))
    name = card.need("SURFACE")
    if name.upper() not in mesh.surfaces:
        raise card.unknown(f"no surface named {name!r}{nearest(name, [s.name for s in mesh.surfaces.values()])}")
    return PreTension(mesh.surfaces[name.upper()].name, node, normal, card.place)


def _one_element(card: Card, mesh: MeshCards) -> int:
    """The element that ELEMENT names, by its number or a set of it alone."""
    text = card.need("ELEMENT")
    number = as_integer(text)
    sets = mesh.element_sets.sets
    every = [number] if number is not None else sets[text.upper()].tolist() if text.upper() in sets else []
    if len(every) != 1:
        raise card.error(f"ELEMENT: expected an element number or a set of one element, got {text!r}")
    return every[0]
