"""Elasticity and expansion of a deck's materials, by direction and over temperature, and the axes that these have."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from abut.io.deck.cards import Card, Line, as_float, key
from abut.io.deck.record import Elastic, Expansion, Orientation, Rows

ISOTROPIC = ("ISO", "ISOTROPIC")
TYPES = {  # of *ELASTIC: the kind, and how many numbers it has
    **dict.fromkeys(ISOTROPIC, ("isotropic", 2)), **dict.fromkeys(("ORTHO", "ORTHOTROPIC"), ("orthotropic", 9)),
    "ENGINEERINGCONSTANTS": ("engineering", 9), **dict.fromkeys(("ANISO", "ANISOTROPIC"), ("anisotropic", 21)),
}  # fmt: skip
ENTRY = {0: 0, 1: 1, 2: 2, 3: 3, 4: 4, 5: 5, 6: 9, 7: 14, 8: 20}  # of the nine of ORTHO among the 21
ORTHO = ("ORTHO", "ORTHOTROPIC")
PER_LINE = 8
Vector = NDArray[np.float64]


def elastic(card: Card) -> Elastic:
    """*ELASTIC."""
    name = key(card.get("TYPE", "ISO") or "")
    if name not in TYPES:
        raise card.error(f"TYPE={name} is not supported; abut knows ISO, ORTHO, ENGINEERING CONSTANTS and ANISO")
    kind, count = TYPES[name]
    card.first("elastic constants")
    rows = _rows(card, count, "constant", 1 if kind == "isotropic" else count)
    if kind == "orthotropic":
        kind, rows = "anisotropic", tuple((temperature, _whole(values)) for temperature, values in rows)
    return Elastic(kind, rows)


def expansion(card: Card) -> Expansion:
    """*EXPANSION."""
    name = key(card.get("TYPE", "ISO") or "")
    if name not in (*ISOTROPIC, *ORTHO):
        raise card.error(
            f"TYPE={name} is not supported; abut knows ISO and ORTHO: expansion along the local directions"
        )
    card.first("thermal expansion")
    count = 1 if name in ISOTROPIC else 3
    text = card.get("ZERO", "0") or ""
    zero = as_float(text)
    if zero is None:
        raise card.error(f"ZERO: expected a temperature, got {text!r}")
    return Expansion(_rows(card, count, "thermal expansion", count), zero)


def _whole(nine: Sequence[float]) -> tuple[float, ...]:
    """The 21 entries of those that are not zero in axes of symmetry."""
    result = np.zeros(21)
    for here, there in ENTRY.items():
        result[there] = nine[here]
    return tuple(result.tolist())


def _rows(card: Card, count: int, what: str, needed: int) -> Rows:
    """Rows of ``count`` numbers and a temperature, eight numbers a line; those from ``needed`` on are 0 where left out."""
    each = -(-(count + 1) // PER_LINE)
    lines: Sequence[Line] = card.lines
    if count + 1 > PER_LINE and len(lines) % each:
        raise lines[-1].error(f"expected {count} numbers in {each} lines for each temperature, got {len(lines)} lines")
    rows: dict[float, tuple[float, ...]] = {}
    for start in range(0, len(lines), each):
        numbers = []
        for i in range(count + 1):
            line, field = lines[start + i // PER_LINE], i % PER_LINE
            if i == count:
                numbers.append(line.number(field, "temperature", 0.0))
            else:
                numbers.append(line.number(field, what, None if i < needed else 0.0))
        if rows and not numbers[-1] > max(rows):
            raise lines[start].error(f"temperature: must grow from row to row, got {numbers[-1]:g} after {max(rows):g}")
        rows[numbers[-1]] = tuple(numbers[:-1])
    return tuple(rows.items())


def orientation(card: Card) -> Orientation:
    """*ORIENTATION."""
    system = key(card.get("SYSTEM", "RECTANGULAR") or "")
    if system not in ("RECTANGULAR", "CYLINDRICAL"):
        raise card.error(f"SYSTEM={system} is not supported; abut knows RECTANGULAR and CYLINDRICAL")
    definition = key(card.get("DEFINITION", "COORDINATES") or "")
    if definition != "COORDINATES":
        raise card.error(f"DEFINITION={definition} is not supported; give the coordinates of two points")
    line = card.first("two points")
    x = [line.number(i, "coordinate", 0.0) for i in range(9)]
    a, b = np.array(x[:3]), np.array(x[3:6])
    if system == "RECTANGULAR":
        a, b = _turned(card, a - x[6:], b - x[6:])
    elif any(turn.number(1, "angle", 0.0) for turn in card.lines[1:]):
        raise card.lines[1].error("a turn of cylindrical axes is not read; give constants along radius, turn and axis")
    across = np.linalg.norm(np.cross(a, b)) if system == "RECTANGULAR" else np.linalg.norm(a - b)
    if not across > 0.0:
        raise line.error(
            "a and b lie on one line with the origin: they give no axes"
            if system == "RECTANGULAR"
            else "the two points are the same"
        )
    return Orientation(system.lower(), _point(a), _point(b), card.place)


def _turned(card: Card, a: Vector, b: Vector) -> tuple[Vector, Vector]:
    """Vectors along x' and near y', turned about one of the axes by the degrees of the second line, where there is one."""
    if len(card.lines) < 2 or not (angle := card.lines[1].number(1, "angle", 0.0)):
        return a, b
    number = card.lines[1].integer(0, "axis", 1)
    if number not in (1, 2, 3):
        raise card.lines[1].error(f"axis: expected 1, 2 or 3, got {number}")
    x, z = (v / max(float(np.linalg.norm(v)), 1e-300) for v in (a, np.cross(a, b)))
    y, (c, s) = np.cross(z, x), (np.cos(np.radians(angle)), np.sin(np.radians(angle)))
    if number == 1:
        return x, c * y + s * z
    return (c * x - s * z, y) if number == 2 else (c * x + s * y, c * y - s * x)


def _point(vector: Vector) -> tuple[float, float, float]:
    x, y, z = vector.tolist()
    return x, y, z
