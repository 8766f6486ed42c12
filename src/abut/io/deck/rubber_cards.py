"""Rubber: *HYPERELASTIC of the kinds that abut knows."""

from __future__ import annotations

from abut.io.deck.cards import Card, key
from abut.io.deck.record import Rubber

KINDS = {  # the parameter, as names are compared, and the kind of a job file
    "NEOHOOKE": "neo-hooke", "MOONEY-RIVLIN": "mooney-rivlin", "YEOH": "yeoh", "OGDEN": "ogden",
    "ARRUDA-BOYCE": "arruda-boyce", "POLYNOMIAL": "polynomial", "REDUCEDPOLYNOMIAL": "reduced polynomial",
}  # fmt: skip
STIFF_IN_VOLUME = 0.1  # D1 times the shear modulus where D1 is 0, as in CalculiX: Poisson's ratio .475


def rubber(card: Card) -> Rubber:
    """Constants of a kind and factors 1/D1, 1/D2, ... of (J - 1)^2, (J - 1)^4, ..."""
    kind = next((kind for name, kind in KINDS.items() if any(key(own) == name for own in card.parameters)), None)
    if kind is None:
        raise card.error(
            "the kind is missing; abut reads NEO HOOKE, MOONEY-RIVLIN, YEOH, OGDEN, ARRUDA-BOYCE, POLYNOMIAL, N=1, and "
            "REDUCED POLYNOMIAL"
        )
    terms = _terms(card)
    if kind == "polynomial":
        if terms != 1:
            raise card.error("POLYNOMIAL is supported with N=1 only; fit REDUCED POLYNOMIAL or OGDEN")
        kind = "mooney-rivlin"
    names = {
        "neo-hooke": ["C10"], "mooney-rivlin": ["C10", "C01"], "yeoh": ["C10", "C20", "C30"],
        "ogden": [f"{name}{i + 1}" for i in range(terms) for name in ("mu", "alpha")],
        "arruda-boyce": ["mu", "lambda"], "reduced polynomial": [f"C{i + 1}0" for i in range(terms)],
    }[kind]  # fmt: skip
    count = {"yeoh": 3, "ogden": terms, "reduced polynomial": terms}.get(kind, 1)
    numbers = _numbers(card, [*names, *(f"D{i + 1}" for i in range(count))])
    constants, volume = numbers[: len(names)], numbers[len(names) :]
    shear = _check(card, kind, constants, volume)
    assumed = volume[0] == 0.0
    if assumed:
        volume = (STIFF_IN_VOLUME / shear, *volume[1:])
    if kind == "reduced polynomial":
        kind, constants = "yeoh", (*constants, 0.0, 0.0)[:3]
    return Rubber(kind, tuple(constants), tuple(1.0 / d if d > 0.0 else 0.0 for d in volume), assumed)


def _terms(card: Card) -> int:
    text = card.get("N", "1") or ""
    if text not in ("1", "2", "3"):
        raise card.error(f"N: expected 1, 2 or 3, got {text!r}")
    return int(text)


def _numbers(card: Card, names: list[str]) -> tuple[float, ...]:
    """The first numbers of the data, eight a line; a temperature may follow, once."""
    first = card.first(" ".join(names))
    used = -(-len(names) // 8)
    if len(card.lines) > used:
        raise card.lines[used].error(
            "values that depend on temperature (several rows) are not supported; give one row, that of the temperature "
            "that matters"
        )
    lines = [*card.lines, first]
    return tuple(
        lines[min(i // 8, len(card.lines) - 1)].number(
            i % 8 if i // 8 < len(card.lines) else 99, name, 0.0 if i else None
        )
        for i, name in enumerate(names)
    )


def _check(card: Card, kind: str, constants: tuple[float, ...], volume: tuple[float, ...]) -> float:
    """The shear modulus at rest. Raises InputError for what has none."""
    line = card.lines[0]
    name = "mu" if kind == "arruda-boyce" else "C10"
    if kind in ("neo-hooke", "arruda-boyce") and not constants[0] > 0.0:
        raise line.error(f"{name}: expected a number > 0, got {constants[0]:g}")
    shear = {
        "ogden": sum(constants[::2]), "arruda-boyce": constants[0], "mooney-rivlin": 2.0 * sum(constants),
    }.get(kind, 2.0 * constants[0])  # fmt: skip
    if volume[0] < 0.0 or (volume[0] == 0.0 and not shear > 0.0):
        raise line.error(f"D1: expected a number > 0, got {volume[0]:g}: D1 = 2 / K, with the bulk modulus K")
    return shear
