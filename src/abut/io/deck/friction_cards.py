"""Friction of a deck's surface interactions, and its changes between steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

from abut.errors import nearest
from abut.io.deck.cards import Card, Line, as_float, key
from abut.io.deck.record import Friction

ROUGH, STICKY = "rough", 1e5  # coefficients from which on a deck means that nothing slips
STICK_SLOPES = ("ELASTIC SLIP", "SLIP TOLERANCE", "SHEAR TRACTION SLOPE")  # Abaqus' words for how soft sticking is
RATE, PRESSURE, TEMPERATURE = 1, 2, 3  # entries of a table's line after the coefficient


def friction(card: Card) -> float | str | tuple[tuple[float, float], ...]:
    """What a *FRICTION card gives: coefficient, "rough", or pairs of pressure and coefficient."""
    if card.has("ROUGH"):
        if card.lines:
            raise card.error("ROUGH: surfaces that never slip have no coefficient; take the data line out, or ROUGH")
        return ROUGH
    card.first("coefficient of friction")
    if len(card.lines) == 1:
        value = _coefficient(card.lines[0])
        return ROUGH if value >= STICKY else value
    for entry, what in ((RATE, "slip rate"), (TEMPERATURE, "temperature")):
        if len({line.number(entry, what, 0.0) for line in card.lines}) > 1:
            raise card.error(
                f"a coefficient over the {what} (entry {entry + 1}) is not supported; keep the lines of one"
            )
    result = tuple((line.number(PRESSURE, "contact pressure"), _coefficient(line)) for line in card.lines)
    for (before, _), (after, _) in pairwise(result):
        if after <= before:
            raise card.error(
                f"contact pressures (entry 3) must increase from line to line, but {after:g} follows {before:g}"
            )
    if result[0][0] < 0.0:
        raise card.error(f"contact pressures (entry 3) must be >= 0, got {result[0][0]:g}")
    return result


def _coefficient(line: Line) -> float:
    value = line.number(0, "coefficient of friction")
    if value < 0.0:
        raise line.error(f"expected a coefficient >= 0, got {line.text(0)!r}")
    return value


def changed(before: Friction, card: Card, step: int) -> Friction:
    """Friction with the coefficient of a *FRICTION card from the beginning of a step on. Raises InputError where it is more
    than a number."""
    values = friction(card)
    if isinstance(before.value, (str, tuple)) or isinstance(values, (str, tuple)):
        raise card.error(
            "*CHANGE FRICTION from one coefficient to another is read, not from or to tables and surfaces that never slip; "
            "make a deck for each state"
        )
    return replace(before, changes=(*before.changes, (step, values)))


def changes(card: Card, known: Mapping[str, object]) -> str:
    """The interaction, in capitals, that a *CHANGE FRICTION is for."""
    name = card.need("INTERACTION")
    if name.upper() not in known:
        raise card.unknown(f"no *SURFACE INTERACTION named {name!r}{nearest(name, known)}")
    return name.upper()


def friction_notes(cards: Sequence[Card]) -> list[str]:
    """What is read otherwise than it stands: a stick slope, which abut's friction does without, and large coefficients."""
    notes = []
    for card in cards:
        if card.key != "FRICTION":
            continue
        soft = any(card.has(name) for name in STICK_SLOPES)
        if soft or (len(card.lines) == 1 and card.lines[0].text(1).strip("0.") != ""):
            notes.append(f"{card.place}: *FRICTION: the stick slope is left out: points stick exactly")
        if len(card.lines) == 1 and (as_float(card.lines[0].text(0)) or 0.0) >= STICKY:
            notes.append(
                f"{card.place}: *FRICTION: with a coefficient of {card.lines[0].text(0)} nothing slips: taken as rough"
            )
    return notes


def without_tied_friction(cards: Sequence[Card], notes: list[str]) -> list[Card]:
    """Cards without the friction of tied contact, which only gives its stick stiffness; ``notes`` gets that. What is glued
    in some steps only may rub in others."""
    tied, interaction = set(), ""
    changed = {(card.get("INTERACTION") or "").upper() for card in cards if card.key == "CHANGESURFACEBEHAVIOR"}
    for card in cards:
        if card.key == "SURFACEINTERACTION":
            interaction = "" if (card.get("NAME") or "").upper() in changed else str(card.place)
        elif interaction and card.key == "SURFACEBEHAVIOR" and key(card.get("PRESSURE-OVERCLOSURE") or "") == "TIED":
            tied.add(interaction)
    result: list[Card] = []
    for card in cards:
        if card.key == "SURFACEINTERACTION":
            interaction = str(card.place)
        elif card.key == "CHANGEFRICTION":
            interaction = ""
        elif card.key == "FRICTION" and interaction in tied:
            notes.append(f"{card.place}: *FRICTION of tied contact gives its stick stiffness; tied exactly instead")
            continue
        result.append(card)
    return result
