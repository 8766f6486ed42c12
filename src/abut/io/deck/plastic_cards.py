"""Metal that yields: *PLASTIC and *CYCLIC HARDENING."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from abut.io.deck.cards import Card, Line, key
from abut.io.deck.record import Hardening

KINDS = ("ISOTROPIC", "KINEMATIC", "COMBINED")
Rows = tuple[tuple[float, float], ...]
Tables = tuple[tuple[float, Rows], ...]  # by temperature, growing


def hardening(options: Mapping[str, Card]) -> tuple[tuple[float, Hardening], ...]:
    """Of a material whose cards are ``options``, by temperature, growing; nothing where it does not yield."""
    if "PLASTIC" not in options:
        if "CYCLICHARDENING" in options:
            raise options["CYCLICHARDENING"].error("there is no *PLASTIC, HARDENING=COMBINED before it; add that")
        return ()
    card = options["PLASTIC"]
    kind = key(card.get("HARDENING", "ISOTROPIC") or "")
    if kind not in KINDS:
        raise card.error(f"HARDENING={kind} is not supported; abut knows {', '.join(KINDS)}")
    if ("CYCLICHARDENING" in options) != (kind == "COMBINED"):
        raise card.error("HARDENING=COMBINED and *CYCLIC HARDENING go together; give both or none")
    tables = _tables(card)
    if kind == "ISOTROPIC":
        return tuple((temperature, Hardening(rows, ())) for temperature, rows in tables)
    slopes = [_slope(card, rows) for _, rows in tables]
    given = [temperature for temperature, _ in tables]
    first = tuple((temperature, rows[:1]) for temperature, rows in tables)
    sizes = _tables(options["CYCLICHARDENING"]) if kind == "COMBINED" else first
    result = []
    for temperature in sorted({*given, *(at for at, _ in sizes)}):
        slope = float(np.interp(temperature, given, slopes))
        result.append((temperature, Hardening(table_at(sizes, temperature), ((slope, 0.0),) if any(slopes) else ())))
    return tuple(result)


def table_at(tables: Sequence[tuple[float, Rows]], temperature: float) -> Rows:
    """Linear in the temperature at every plastic strain, constant beyond."""
    if len(tables) == 1:
        return tables[0][1]
    strains = sorted({strain for _, rows in tables for strain, _ in rows})
    each = np.array([np.interp(strains, *np.array(rows).T) for _, rows in tables])
    at = [own for own, _ in tables]
    return tuple((strain, float(np.interp(temperature, at, column))) for strain, column in zip(strains, each.T))


def _slope(card: Card, rows: Rows) -> float:
    """Of a back stress that grows with the plastic strain."""
    if len(rows) > 2:
        raise card.error("a back stress over more than two rows is not supported; give the first and the last one")
    return (rows[1][1] - rows[0][1]) / (rows[1][0] - rows[0][0]) if len(rows) == 2 else 0.0


def _tables(card: Card) -> Tables:
    """Equivalent plastic strains from zero on, and yield stresses, which stand the other way round in the deck; those of a
    temperature one after the other."""
    card.first("yield stress and plastic strain")
    result: dict[float, list[tuple[float, float]]] = {}
    temperature = card.lines[0].number(2, "temperature", 0.0)
    for line in card.lines:
        before, temperature = temperature, line.number(2, "temperature", temperature)
        if result and (temperature < before or (temperature > before and temperature in result)):
            raise line.error(f"temperature: must grow, got {temperature:g} after {before:g}")
        _add(line, result.setdefault(temperature, []))
    return tuple((at, tuple(rows)) for at, rows in result.items())


def _add(line: Line, rows: list[tuple[float, float]]) -> None:
    stress, strain = line.number(0, "yield stress"), line.number(1, "plastic strain", 0.0)
    if not rows and strain != 0.0:
        raise line.error(f"plastic strain: the first row must have 0, got {strain:g}")
    if not stress > 0.0:
        raise line.error(f"yield stress: expected a number > 0, got {stress:g}")
    if rows and not strain > rows[-1][0]:
        raise line.error(f"plastic strain: must grow from row to row, got {strain:g} after {rows[-1][0]:g}")
    if rows and stress < rows[-1][1]:
        raise line.error(
            f"yield stress: falls from {rows[-1][1]:g} to {stress:g}; a law that softens has no unique results; keep "
            "the larger one"
        )
    rows.append((strain, stress))
