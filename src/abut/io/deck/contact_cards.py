"""Contact pairs, ties and general contact of a deck."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from abut.errors import nearest
from abut.io.deck.cards import Card, Line, as_float, key, of
from abut.io.deck.friction_cards import changed, changes, friction
from abut.io.deck.mesh_cards import MeshCards
from abut.io.deck.reasons import DeckError, Reasons
from abut.io.deck.record import NO_FRICTION, Behaviour, Friction, GeneralContact, Numbers, Pair


@dataclass(frozen=True)
class Interaction:
    """What surfaces do to each other. overclosure: HARD, LINEAR, ...; bilateral: they never separate (NO SEPARATION);
    changing: the pressure over the overclosure is another one in a later step; kinds: steps from which on surfaces are glued
    (TIED), never separate (NO SEPARATION), or are in contact (HARD)."""

    overclosure: str = "HARD"
    behaviour: Behaviour = ()
    friction: Friction = NO_FRICTION
    bilateral: bool = False
    changing: bool = False
    kinds: tuple[tuple[int, str], ...] = ()


BILATERAL = "NO SEPARATION"
FINE = 40  # points of an exponential curve over the clearance in which the pressure falls to a hundredth: 0.2 % off between
OVERCLOSURES = ("HARD", "LINEAR", "EXPONENTIAL", "TABULAR", "TRUNCATEDLINEAR", "TIED", "SCALEFACTOR")


def pairs(cards: Sequence[Card], mesh: MeshCards, reasons: Reasons) -> tuple[Pair, ...]:
    """Contact pairs and ties in the order of the deck."""
    interactions = _interactions(cards, reasons)
    clearances: dict[tuple[str, str], Card] = {}
    for card in of(cards, "CLEARANCE"):
        with reasons.gathered():
            clearances[card.need("SLAVE").upper(), card.need("MASTER").upper()] = card
    result: list[Pair] = []
    for card in cards:
        with reasons.gathered():
            if card.key == "TIE" and not card.has("CYCLIC SYMMETRY"):
                result += _ties(card, mesh)
            elif card.key == "CONTACTPAIR":
                result += _contact_pairs(card, mesh, interactions, clearances)
    _check_once(result, reasons)
    for (slave, master), card in clearances.items():
        reasons.add(card.unknown(f"no *CONTACT PAIR of slave {slave} and master {master}"))
    return tuple(result)


def _check_once(every: Sequence[Pair], reasons: Reasons) -> None:
    """``reasons`` gets pairs of surfaces that are a pair already, with either as the slave; those of one line act after each
    other."""
    known: dict[frozenset[str], Pair] = {}
    for pair in every:
        first = known.setdefault(frozenset((pair.slave, pair.master)), pair)
        if first is not pair and first.place != pair.place:
            text = (
                f"'{pair.slave}' and '{pair.master}' are a pair already ({first.place}): contact between them would count "
                "twice; take one of the two out"
            )
            if first.slave != pair.slave:
                text += ", and keep the one whose slave is the softer side"
            reasons.add(DeckError(pair.place, text))


def _ties(card: Card, mesh: MeshCards) -> Iterator[Pair]:
    text = card.get("POSITION TOLERANCE")
    tolerance = None if text is None else as_float(text)
    if text is not None and (tolerance is None or tolerance < 0.0):
        raise card.error(f"POSITIONTOLERANCE: expected a distance >= 0, got {text!r}")
    of_abaqus = card.has("ADJUST") or card.has("TYPE")
    for i, (line, slave, master) in enumerate(sides(card, mesh)):
        name = (card.get("NAME") or f"{slave}-{master}") + (f"-{i + 1}" if i else "")
        yield Pair(
            name, slave, master, True, "TIED", "all", None, line.place,
            is_tie=True, tolerance=tolerance or None, of_abaqus=of_abaqus,
        )  # fmt: skip


def _contact_pairs(
    card: Card, mesh: MeshCards, interactions: Mapping[str, Interaction], clearances: dict[tuple[str, str], Card]
) -> list[Pair]:
    """The pairs of one card; takes what belongs to them from ``clearances``."""
    interaction, result = card.need("INTERACTION"), list[Pair]()
    if interaction.upper() not in interactions:
        raise card.unknown(f"no *SURFACE INTERACTION named {interaction!r}{nearest(interaction, interactions)}")
    properties = interactions[interaction.upper()]
    for line, slave, master in sides(card, mesh):
        given = clearances.pop((slave.upper(), master.upper()), None)
        clearance = None
        if given is not None:
            clearance = as_float(given.need("VALUE"))
            if clearance is None:
                raise given.error(f"VALUE: expected a number, got {given.need('VALUE')!r}")
        pair = Pair(
            f"{slave}-{master}", slave, master, False, properties.overclosure, _adjust(card, mesh), clearance, line.place,
            behaviour=properties.behaviour, changing=properties.changing,
        )  # fmt: skip
        result += _phases(pair, properties, line, interaction)
    return result


def _phases(pair: Pair, properties: Interaction, line: Line, interaction: str) -> Iterator[Pair]:
    """A pair, or one for each span of steps in which its surfaces are glued, never separate, or are in contact."""
    kinds = properties.kinds or ((1, _kind(properties.overclosure, properties.bilateral)),)
    ends = [*(step for step, _ in kinds[1:]), None]
    for (begin, kind), end in zip(kinds, ends):
        rub = NO_FRICTION if kind == "TIED" else properties.friction
        if kind == BILATERAL and rub != NO_FRICTION:
            raise line.error(
                f"INTERACTION={interaction}: NO SEPARATION goes without friction; take *FRICTION out, or NO SEPARATION"
            )
        yield replace(
            pair,
            name=pair.name if begin == 1 else f"{pair.name} from step {begin}",
            tied=kind == "TIED",
            bilateral=kind == BILATERAL,
            friction=rub,
            overclosure="TIED" if kind == "TIED" else "HARD" if pair.overclosure == "TIED" else pair.overclosure,
            span=(begin, end) if len(kinds) > 1 else None,
        )


def general_contact(cards: Sequence[Card], reasons: Reasons) -> GeneralContact | None:
    """Contact of everything outside, if the deck asks for it, with the interaction given to all of it."""
    interactions = _interactions(cards, reasons)
    found: GeneralContact | None = None
    with reasons.gathered():
        found = _general_contact(cards, interactions)
    return found


def _general_contact(cards: Sequence[Card], interactions: Mapping[str, Interaction]) -> GeneralContact | None:
    found: Card | None = None
    for card in of(cards, "CONTACT INCLUSIONS"):
        if not card.has("ALL EXTERIOR"):
            raise card.error("only ALL EXTERIOR is supported; name single surfaces in *CONTACT PAIR")
        found = card
    properties = Interaction()
    for card in of(cards, "CONTACT PROPERTY ASSIGNMENT"):
        for line in card.lines:
            if line.text(0) or line.text(1):
                raise line.error("an interaction for single surfaces is not supported; name them in *CONTACT PAIR")
            name = line.text(2)
            if name.upper() not in interactions:
                raise line.unknown(f"no *SURFACE INTERACTION named {name!r}{nearest(name, interactions)}")
            properties = interactions[name.upper()]
            if properties.bilateral:
                raise line.error("NO SEPARATION goes with named surfaces; name them in *CONTACT PAIR")
            if properties.changing:
                raise line.error("*CHANGE SURFACE BEHAVIOR goes with named surfaces; name them in *CONTACT PAIR")
    if found is None:
        for card in of(cards, "CONTACT"):
            raise card.error("no *CONTACT INCLUSIONS, ALL EXTERIOR follows; add it, or name surfaces in *CONTACT PAIR")
    return (
        None
        if found is None
        else GeneralContact(properties.overclosure, found.place, properties.friction, properties.behaviour)
    )


def sides(card: Card, mesh: MeshCards) -> Iterator[tuple[Line, str, str]]:
    """Names of slave and master surface, line by line; of a contact pair with one, which touches itself, twice that."""
    card.first("slave and master surface")
    for line in card.lines:
        names = []
        for i, what in enumerate(("slave", "master")):
            text = line.text(i) or (line.text(0) if card.key == "CONTACTPAIR" else "")
            if text.upper() not in mesh.surfaces:
                spelled = [surface.name for surface in mesh.surfaces.values()]
                raise line.unknown(f"no {what} surface named {text!r}{nearest(text, spelled)}")
            names.append(mesh.surfaces[text.upper()].name)
        yield line, names[0], names[1]


def _adjust(card: Card, mesh: MeshCards) -> float | Numbers | None:
    text = card.get("ADJUST")
    if text is None:
        return None
    value = as_float(text)
    if value is not None:
        if value < 0.0:
            raise card.error(f"ADJUST: expected a distance >= 0 or a node set, got {text}")
        return value
    if text.upper() not in mesh.node_sets.sets:
        raise card.unknown(f"ADJUST: no node set named {text!r}{mesh.node_sets.like(text)}")
    return mesh.node_sets.sets[text.upper()]


def _interactions(cards: Sequence[Card], reasons: Reasons) -> dict[str, Interaction]:
    """Interactions by name, with the changes of their friction in later steps."""
    result: dict[str, Interaction] = {}
    current, change, step = "", "", 0
    law: Card | None = None
    for card in cards:
        with reasons.gathered(defines=True):
            step += card.key == "STEP"
            if card.key == "SURFACEINTERACTION":
                current = card.need("NAME").upper()
                result[current] = Interaction()
            elif card.key == "CHANGESURFACEBEHAVIOR":
                law = card
            elif card.key == "SURFACEBEHAVIOR" and law is not None:
                name, law = changes(law, result), None
                result[name] = _other_law(result[name], step, card)
            elif card.key == "SURFACEBEHAVIOR":
                if not current:
                    raise card.error("it must follow a *SURFACE INTERACTION")
                result[current] = replace(
                    result[current],
                    overclosure=_overclosure(card),
                    behaviour=_behaviour(card),
                    bilateral=card.has(BILATERAL),
                )
            elif card.key == "CHANGEFRICTION":
                change = changes(card, result)
            elif card.key == "FRICTION":
                if not (change or current):
                    raise card.error("it must follow a *SURFACE INTERACTION")
                properties = result[change or current]
                rub = changed(properties.friction, card, step) if change else Friction(friction(card))
                result[change or current], change = replace(properties, friction=rub), ""
    return result


def _other_law(properties: Interaction, step: int, card: Card) -> Interaction:
    """With another law from a step on: which one of contact makes no difference to contact without penetration."""
    kinds = properties.kinds or ((1, _kind(properties.overclosure, properties.bilateral)),)
    now = _kind(_overclosure(card), card.has(BILATERAL))
    if now != kinds[-1][1]:
        return replace(properties, changing=True, kinds=(*kinds, (step, now)))
    return replace(properties, changing=True)


def _kind(overclosure: str, bilateral: bool) -> str:
    return "TIED" if overclosure == "TIED" else BILATERAL if bilateral else "HARD"


def _overclosure(card: Card) -> str:
    overclosure = key(card.get("PRESSURE-OVERCLOSURE", "HARD") or "HARD")
    if overclosure not in OVERCLOSURES:
        raise card.error(f"PRESSURE-OVERCLOSURE={overclosure} is not known; use HARD")
    return overclosure


def _behaviour(card: Card) -> Behaviour:
    """Pairs of overclosure and pressure of LINEAR and TABULAR contact; of EXPONENTIAL, close enough for straight lines."""
    kind = _overclosure(card)
    if not card.lines or kind not in ("LINEAR", "TABULAR", "EXPONENTIAL"):
        return ()
    line = card.lines[0]
    if kind == "LINEAR":
        return ((0.0, 0.0), (1.0, line.number(0, "slope")))
    if kind == "TABULAR":
        rows = [(each.number(1, "overclosure"), each.number(0, "pressure")) for each in card.lines]
        return tuple(row for i, row in enumerate(rows) if row[1] > 0.0 or i + 1 == len(rows) or rows[i + 1][1] > 0.0)
    clearance, pressure = line.number(0, "clearance"), line.number(1, "pressure")
    rows = [(clearance * k / FINE, pressure * 100.0 ** (k / FINE)) for k in range(-2 * FINE, 3 * FINE + 1)]
    return ((rows[0][0] - clearance / FINE, 0.0), *rows)
