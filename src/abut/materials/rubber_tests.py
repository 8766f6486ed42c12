"""Tests of rubber: their data, and the nominal stress that an incompressible material has in them, theory (D22)."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from abut.errors import InputError, nearest
from abut.materials.evaluated import Array
from abut.materials.rubber import Energy

ACROSS = {
    "uniaxial": (1.0, -0.5, -0.5),
    "planar": (1.0, 0.0, -1.0),
    "biaxial": (1.0, 1.0, -2.0),
}  # powers of the stretch
AXES = ("stretch", "strain")
FIRST, LAST = 0.1, 10.0  # stretches between which stability is looked at
STEPS = 600


@dataclass(frozen=True)
class RubberTest:
    """kind: a key of ``ACROSS``; stretch (n,), > 0, along the pull; stress (n,): force per undeformed area."""

    kind: str
    stretch: Array
    stress: Array


def read_test(path: Path, kind: str) -> RubberTest:
    """A CSV file with a line of names: "stress", and "stretch" or "strain" (nominal, stretch less one). Separators are
    commas, semicolons or tabs; lines that begin with # are comments. Raises InputError."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read: {error}") from None
    lines = [(i, line) for i, line in enumerate(text.splitlines(), start=1) if line.strip() and line[0] != "#"]
    if len(lines) < 2:
        raise InputError(f"{path}: expected a line of names, as stretch,stress, and lines of numbers")
    separator = next((mark for mark in (";", "\t") if mark in lines[0][1]), ",")
    names, *rows = csv.reader((line for _, line in lines), delimiter=separator)
    names = [name.strip().lower() for name in names]
    for name in names:
        if name not in (*AXES, "stress"):
            raise InputError(
                f"{path}: line {lines[0][0]}: expected the names stretch or strain, and stress, got {name!r}"
                f"{nearest(name, [*AXES, 'stress'])}"
            )
    if sorted(names) not in (["stress", "stretch"], ["strain", "stress"]):
        raise InputError(
            f"{path}: line {lines[0][0]}: expected two columns, stretch or strain, and stress, got {names}"
        )
    values = np.array([_numbers(path, number, row) for (number, _), row in zip(lines[1:], rows)])
    along = "stretch" if "stretch" in names else "strain"
    stretch = values[:, names.index(along)] + (along == "strain")
    if (stretch <= 0.0).any():
        number = lines[1 + int(np.argmax(stretch <= 0.0))][0]
        raise InputError(f"{path}: line {number}: a stretch must be > 0, and a strain > -1")
    return RubberTest(kind, stretch, values[:, names.index("stress")])


def _numbers(path: Path, number: int, row: list[str]) -> list[float]:
    try:
        values = [float(value) for value in row]
    except ValueError:
        values = []
    if len(values) != 2 or not np.isfinite(values).all():
        raise InputError(f"{path}: line {number}: expected two numbers, got {', '.join(row)!r}")
    return values


def nominal_stress(energy: Energy, kind: str, stretch: Array) -> Array:
    """Force per undeformed area, (n,), of an incompressible material at stretches (n,)."""
    _, _, third = powers = ACROSS[kind]
    logarithm = np.log(stretch)
    squares = np.exp(2.0 * np.outer(powers, logarithm))
    push = np.zeros(len(stretch))  # difference of true stresses along the pull and where there is none
    for mu, alpha in energy.terms:
        push += mu * (np.exp(alpha * logarithm) - np.exp(alpha * third * logarithm))
    first = squares.sum(axis=0) - 3.0
    slope = sum((i + 1) * c * first**i for i, c in enumerate(energy.powers))
    push += 2.0 * slope * (squares[0] - squares[2])
    return np.asarray(push / stretch)


def stable_range(energy: Energy, kind: str) -> tuple[float, float]:
    """Stretches about 1 between which every further strain takes work (Drucker), within ``FIRST`` to ``LAST``."""
    ends = []
    for end in (FIRST, LAST):
        stretch = np.geomspace(1.0, end, STEPS)
        sound = _stable(energy, np.outer(ACROSS[kind], np.log(stretch)))
        ends.append(float(stretch[-1] if sound.all() else stretch[max(int(np.argmin(sound)) - 1, 0)]))
    return ends[0], ends[1]


def _stable(energy: Energy, strain: Array) -> np.ndarray:
    """Whether the second derivatives of the energy by two of the logarithmic strains (3, n) are positive definite, (n,)."""
    square = np.exp(2.0 * strain)
    first = square.sum(axis=0) - 3.0
    slope = sum((i + 1) * c * first**i for i, c in enumerate(energy.powers)) + 0.0 * first
    bend = sum(i * (i + 1) * c * first ** (i - 1) for i, c in enumerate(energy.powers) if i) + 0.0 * first
    by = 2.0 * (square[:2] - square[2])
    own = [4.0 * slope * (square[a] + square[2]) + bend * by[a] ** 2 for a in (0, 1)]
    mixed = 4.0 * slope * square[2] + bend * by[0] * by[1]
    for mu, alpha in energy.terms:
        power = mu * alpha * np.exp(alpha * strain)
        own = [own[a] + power[a] + power[2] for a in (0, 1)]
        mixed = mixed + power[2]
    return (own[0] > 0.0) & (own[0] * own[1] > mixed**2)
