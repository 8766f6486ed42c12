"""Materials, sections, contact, ties, equations, rigid bodies and symmetry of a deck."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np

from abut.errors import nearest
from abut.io.abaqus.cards import Card, Line, as_float, as_integer, key
from abut.io.abaqus.mesh_cards import MeshCards
from abut.io.abaqus.record import (
    CyclicSymmetry,
    Equation,
    GeneralContact,
    Material,
    Numbers,
    Pair,
    PreTension,
    RigidBody,
    Section,
    Transform,
)

EMPTY = np.empty(0, np.int64)
OVERCLOSURES = ("HARD", "LINEAR", "EXPONENTIAL", "TABULAR", "TRUNCATEDLINEAR", "TIED", "SCALEFACTOR")


def of(cards: Iterable[Card], name: str) -> Iterator[Card]:
    """The cards with a name."""
    own = key(name)
    return (card for card in cards if card.key == own)


def materials(cards: Sequence[Card]) -> dict[str, Material]:
    """Materials by name in capitals. Raises InputError for what is not isotropic with one row of numbers."""
    result = {}
    for i, card in enumerate(cards):
        if card.key != "MATERIAL":
            continue
        options: dict[str, Card] = {}
        for option in cards[i + 1 :]:
            if option.key not in ("ELASTIC", "DENSITY", "EXPANSION"):
                break
            options[option.key] = option
        name = card.need("NAME")
        if "ELASTIC" not in options:
            raise card.error(f"material '{name}' has no *ELASTIC; give Young's modulus and Poisson's ratio")
        elastic = _row(options["ELASTIC"], 2, "Young's modulus and Poisson's ratio")
        poisson = elastic.number(1, "Poisson's ratio", 0.0)
        density = _row(options["DENSITY"], 1, "density").number(0, "density") if "DENSITY" in options else 0.0
        expansion = 0.0
        if "EXPANSION" in options:
            expansion = _row(options["EXPANSION"], 1, "thermal expansion").number(0, "thermal expansion")
        result[name.upper()] = Material(name, elastic.number(0, "Young's modulus"), poisson, density, expansion)
    return result


def _row(card: Card, columns: int, what: str) -> Line:
    kind = key(card.get("TYPE", "ISO") or "")
    if kind not in ("ISO", "ISOTROPIC"):
        raise card.error(f"TYPE={kind} is not supported; abut's solids are isotropic")
    line = card.first(what)
    if len(card.lines) > 1:
        raise card.lines[1].error(
            "values that depend on temperature (several rows) are not supported; give one row, that of the temperature "
            "that matters"
        )
    return line


def sections(cards: Sequence[Card], mesh: MeshCards, known: Mapping[str, Material] | None) -> tuple[Section, ...]:
    """Solid sections, without materials where ``known`` is None; later ones override earlier ones for elements that stand
    in both, as in Abaqus and CalculiX."""
    result: list[Section] = []
    for card in of(cards, "SOLID SECTION"):
        name, material = card.need("ELSET"), card.need("MATERIAL")
        if name.upper() not in mesh.element_sets.sets:
            raise card.error(f"no element set named {name!r}{nearest(name, mesh.element_sets.spelled.values())}")
        if known is not None and material.upper() not in known:
            raise card.error(f"no material named {material!r}{nearest(material, [m.name for m in known.values()])}")
        if card.has("NODAL THICKNESS"):
            raise card.error(
                "NODALTHICKNESS: a thickness for each node is not supported; give the section one thickness"
            )
        thickness = card.lines[0].number(0, "thickness", 1.0) if card.lines else 1.0
        if not thickness > 0.0:
            raise card.lines[0].error(f"thickness: expected a number > 0, got {thickness:g}")
        elements = mesh.element_sets.sets[name.upper()]
        result = [Section(s.name, np.setdiff1d(s.elements, elements), s.material, s.thickness, s.place) for s in result]
        spelled = mesh.element_sets.spelled[name.upper()]
        own = known[material.upper()] if known is not None else Material(material, 1.0, 0.0, 0.0, 0.0)
        result.append(Section(spelled, elements, own, thickness, card.place))
    return tuple(s for s in result if len(s.elements))


def pairs(cards: Sequence[Card], mesh: MeshCards) -> tuple[Pair, ...]:
    """Contact pairs and ties in the order of the deck."""
    overclosures = _overclosures(cards)
    clearances = {(card.need("SLAVE").upper(), card.need("MASTER").upper()): card for card in of(cards, "CLEARANCE")}
    result: list[Pair] = []
    for card in cards:
        if card.key == "TIE" and not card.has("CYCLIC SYMMETRY"):
            for i, (line, slave, master) in enumerate(_sides(card, mesh)):
                name = (card.get("NAME") or f"{slave}-{master}") + (f"-{i + 1}" if i else "")
                result.append(Pair(name, slave, master, True, "TIED", "all", None, line.place))
        elif card.key == "CONTACTPAIR":
            interaction = card.need("INTERACTION")
            if interaction.upper() not in overclosures:
                raise card.error(f"no *SURFACE INTERACTION named {interaction!r}{nearest(interaction, overclosures)}")
            overclosure = overclosures[interaction.upper()]
            for line, slave, master in _sides(card, mesh):
                given = clearances.pop((slave.upper(), master.upper()), None)
                clearance = None
                if given is not None:
                    clearance = as_float(given.need("VALUE"))
                    if clearance is None:
                        raise given.error(f"VALUE: expected a number, got {given.need('VALUE')!r}")
                tied = overclosure == "TIED"
                name = f"{slave}-{master}"
                result.append(Pair(name, slave, master, tied, overclosure, _adjust(card, mesh), clearance, line.place))
    for (slave, master), card in clearances.items():
        raise card.error(f"no *CONTACT PAIR of slave {slave} and master {master}")
    return tuple(result)


def general_contact(cards: Sequence[Card]) -> GeneralContact | None:
    """Contact of everything outside, if the deck asks for it, with the interaction given to all of it."""
    overclosures = _overclosures(cards)
    found: Card | None = None
    for card in of(cards, "CONTACT INCLUSIONS"):
        if not card.has("ALL EXTERIOR"):
            raise card.error("only ALL EXTERIOR is supported; name single surfaces in *CONTACT PAIR")
        found = card
    overclosure = "HARD"
    for card in of(cards, "CONTACT PROPERTY ASSIGNMENT"):
        for line in card.lines:
            if line.text(0) or line.text(1):
                raise line.error("an interaction for single surfaces is not supported; name them in *CONTACT PAIR")
            name = line.text(2)
            if name.upper() not in overclosures:
                raise line.error(f"no *SURFACE INTERACTION named {name!r}{nearest(name, overclosures)}")
            overclosure = overclosures[name.upper()]
    if found is None:
        for card in of(cards, "CONTACT"):
            raise card.error("no *CONTACT INCLUSIONS, ALL EXTERIOR follows; add it, or name surfaces in *CONTACT PAIR")
    return None if found is None else GeneralContact(overclosure, found.place)


def _sides(card: Card, mesh: MeshCards) -> Iterator[tuple[Line, str, str]]:
    """Names of slave and master surface, line by line."""
    card.first("slave and master surface")
    for line in card.lines:
        names = []
        for i, what in enumerate(("slave", "master")):
            text = line.text(i)
            if text.upper() not in mesh.surfaces:
                spelled = [surface.name for surface in mesh.surfaces.values()]
                raise line.error(f"no {what} surface named {text!r}{nearest(text, spelled)}")
            names.append(mesh.surfaces[text.upper()].name)
        yield line, names[0], names[1]


def _adjust(card: Card, mesh: MeshCards) -> float | str | Numbers:
    text = card.get("ADJUST")
    if text is None:
        return 0.0
    value = as_float(text)
    if value is not None:
        if value < 0.0:
            raise card.error(f"ADJUST: expected a distance >= 0 or a node set, got {text}")
        return value
    if text.upper() not in mesh.node_sets.sets:
        raise card.error(f"ADJUST: no node set named {text!r}{nearest(text, mesh.node_sets.spelled.values())}")
    return mesh.node_sets.sets[text.upper()]


def _overclosures(cards: Sequence[Card]) -> dict[str, str]:
    """How pressure follows overclosure, by interaction."""
    result: dict[str, str] = {}
    current = ""
    for card in cards:
        if card.key == "SURFACEINTERACTION":
            current = card.need("NAME").upper()
            result[current] = "HARD"
        elif card.key == "SURFACEBEHAVIOR":
            if not current:
                raise card.error("it must follow a *SURFACE INTERACTION")
            overclosure = key(card.get("PRESSURE-OVERCLOSURE", "HARD") or "HARD")
            if overclosure not in OVERCLOSURES:
                raise card.error(f"PRESSURE-OVERCLOSURE={overclosure} is not known; use HARD")
            result[current] = overclosure
    return result


def equations(cards: Sequence[Card], mesh: MeshCards) -> tuple[Equation, ...]:
    """*EQUATION, and *MPC that say that displacements are equal."""
    result: list[Equation] = []
    for card in of(cards, "EQUATION"):
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
            result += _equations(head, fields, mesh)
    for card in of(cards, "MPC"):
        for line in card.lines:
            result += _multipoint(line, mesh)
    return tuple(result)


def _equations(head: Line, fields: list[tuple[Line, int]], mesh: MeshCards) -> list[Equation]:
    """One equation, or one for each node of the sets that stand in its terms."""
    sets, rest = [], []
    for (line, i), (other, j), (third, k) in zip(fields[::3], fields[1::3], fields[2::3]):
        sets.append(mesh.existing(line, i))
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
    if direction > 3:
        raise line.error(f"direction {direction}: only displacements (1, 2, 3) are supported")
    return direction


def _multipoint(line: Line, mesh: MeshCards) -> list[Equation]:
    kind = key(line.text(0))
    if kind not in ("TIE", "PIN"):
        raise line.error(f"*MPC of type {kind or '(none)'} is not supported; TIE and PIN are; or write *EQUATION")
    a, b = (mesh.existing(line, i) for i in (1, 2))
    if len(b) == 1:
        b = np.repeat(b, len(a))
    if len(a) != len(b):
        raise line.error(f"the two node sets have {len(a)} and {len(b)} nodes; they must have the same number")
    return [Equation(((int(n), d, 1.0), (int(m), d, -1.0)), line.place) for n, m in zip(a, b) for d in (1, 2, 3)]


def rigid_bodies(cards: Sequence[Card], mesh: MeshCards) -> tuple[RigidBody, ...]:
    result = []
    for card in of(cards, "RIGID BODY"):
        nodes, elements = EMPTY, EMPTY
        if card.get("NSET"):
            nodes = _named(card, "NSET", mesh.node_sets.sets, "node")
        elif card.get("ELSET"):
            elements = _named(card, "ELSET", mesh.element_sets.sets, "element")
        else:
            raise card.error("give the body's nodes (NSET) or elements (ELSET)")
        reference = _node(card, "REF NODE", card.need("REF NODE"))
        turning = _node(card, "ROT NODE", card.need("ROT NODE")) if card.has("ROT NODE") else 0
        result.append(RigidBody(nodes, elements, reference, turning, card.place))
    return tuple(result)


def _named(card: Card, parameter: str, sets: Mapping[str, Numbers], what: str) -> Numbers:
    name = card.need(parameter)
    if name.upper() not in sets:
        raise card.error(f"no {what} set named {name!r}{nearest(name.upper(), sets)}")
    return sets[name.upper()]


def _node(card: Card, parameter: str, text: str) -> int:
    number = as_integer(text)
    if number is None:
        raise card.error(f"{parameter}: expected a node number, got {text!r}")
    return number


def transforms(cards: Sequence[Card], mesh: MeshCards) -> tuple[Transform, ...]:
    result = []
    for card in of(cards, "TRANSFORM"):
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


def cyclic_symmetry(cards: Sequence[Card], mesh: MeshCards) -> tuple[CyclicSymmetry, ...]:
    ties = {card.need("NAME").upper(): card for card in of(cards, "TIE") if card.has("CYCLIC SYMMETRY")}
    result = []
    for card in of(cards, "CYCLIC SYMMETRY MODEL"):
        name = card.get("TIE") or next(iter(ties), "")
        tie = ties.pop(name.upper(), None)
        if tie is None:
            raise card.error(f"no *TIE, CYCLIC SYMMETRY named {name!r}; give one, and name it once")
        sectors = as_float(card.need("N"))
        if sectors is None or sectors < 2.0:
            raise card.error(f"N: expected the number of sectors in the whole turn, >= 2, got {card.need('N')!r}")
        a, b = two_points(card.first("two points of the axis"))
        _, slave, master = next(_sides(tie, mesh))
        result.append(CyclicSymmetry(sectors, slave, master, a, b, card.place))
    for tie in ties.values():
        raise tie.error("a *TIE, CYCLIC SYMMETRY without a *CYCLIC SYMMETRY MODEL that names it; add one")
    return tuple(result)


def pretension_sections(cards: Sequence[Card], mesh: MeshCards) -> tuple[PreTension, ...]:
    result = []
    for card in of(cards, "PRE-TENSION SECTION"):
        name = card.need("SURFACE")
        if name.upper() not in mesh.surfaces:
            raise card.error(f"no surface named {name!r}{nearest(name, [s.name for s in mesh.surfaces.values()])}")
        normal = None
        if card.lines:
            line = card.lines[0]
            normal = (line.number(0, "normal", 0.0), line.number(1, "normal", 0.0), line.number(2, "normal", 0.0))
            if normal == (0.0, 0.0, 0.0):
                raise line.error("the normal is zero; leave the line out for the surface's own")
        node = _node(card, "NODE", card.need("NODE"))
        result.append(PreTension(mesh.surfaces[name.upper()].name, node, normal, card.place))
    return tuple(result)
