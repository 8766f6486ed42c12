"""Metal that yields: *PLASTIC and *CYCLIC HARDENING."""

from __future__ import annotations

from collections.abc import Mapping

from abut.io.deck.cards import Card, key
from abut.io.deck.record import Hardening

KINDS = ("ISOTROPIC", "KINEMATIC", "COMBINED")
Rows = tuple[tuple[float, float], ...]


def hardening(options: Mapping[str, Card]) -> Hardening | None:
    """Of a material whose cards are ``options``, None where it does not yield."""
    if "PLASTIC" not in options:
        if "CYCLICHARDENING" in options:
            raise options["CYCLICHARDENING"].error("there is no *PLASTIC, HARDENING=COMBINED before it; add that")
        return None
    card = options["PLASTIC"]
    kind = key(card.get("HARDENING", "ISOTROPIC") or "")
    if kind not in KINDS:
        raise card.error(f"HARDENING={kind} is not supported; abut knows {', '.join(KINDS)}")
    if ("CYCLICHARDENING" in options) != (kind == "COMBINED"):
        raise card.error("HARDENING=COMBINED and *CYCLIC HARDENING go together; give both or none")
    rows = _rows(card)
    if kind == "ISOTROPIC":
        return Hardening(rows, ())
    slope = _slope(card, rows)
    size = _rows(options["CYCLICHARDENING"]) if kind == "COMBINED" else rows[:1]
    return Hardening(size, ((slope, 0.0),) if slope else ())


def _slope(card: Card, rows: Rows) -> float:
    """Of a back stress that grows with the plastic strain."""
    if len(rows) > 2:
        raise card.error("a back stress over more than two rows is not supported; give the first and the last one")
    return (rows[1][1] - rows[0][1]) / (rows[1][0] - rows[0][0]) if len(rows) == 2 else 0.0


def _rows(card: Card) -> Rows:
    """Equivalent plastic strains from zero on, and yield stresses, which stand the other way round in the deck."""
    card.first("yield stress and plastic strain")
    result: list[tuple[float, float]] = []
    temperature = card.lines[0].number(2, "temperature", 0.0)
    for line in card.lines:
        stress, strain = line.number(0, "yield stress"), line.number(1, "plastic strain", 0.0)
        if line.number(2, "temperature", temperature) != temperature:
            raise line.error(
                "yield stresses that depend on temperature are not supported; give the rows of the temperature that matters"
            )
        if not result and strain != 0.0:
            raise line.error(f"plastic strain: the first row must have 0, got {strain:g}")
        if not stress > 0.0:
            raise line.error(f"yield stress: expected a number > 0, got {stress:g}")
        if result and not strain > result[-1][0]:
            raise line.error(f"plastic strain: must grow from row to row, got {strain:g} after {result[-1][0]:g}")
        if result and stress < result[-1][1]:
            raise line.error(
                f"yield stress: falls from {result[-1][1]:g} to {stress:g}; a law that softens has no unique results; keep "
                "the larger one"
            )
        result.append((strain, stress))
    return tuple(result)
