"""By how much the numbers of two runs differ: relative to the largest of their array, or to what gives it its size."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from same.quantities import Quantities

ROUNDING = 1e-10
# Errors that are relative already; where they are nothing but rounding they are compared as they are.
ERRORS = {"residual", "contact_residual", "balance_error", "value", "error"}


@dataclass(frozen=True)
class Scale:
    """Quantities that may cancel down to rounding (``names``) are compared relative to what they cancel from (``of``), the
    largest in the run; both by the last part of their paths."""

    names: frozenset[str]
    of: frozenset[str]


FORCES = frozenset({"force", "force_*", "reaction", "reactions", "load", "target_forces"})
SCALES = (
    Scale(FORCES | {"moment", "moment_*", "contact_moment_*"}, FORCES),
    Scale(frozenset({"gap", "max_penetration", "slip"}), frozenset({"displacement", "max_displacement"})),
    Scale(frozenset({"centre_*", "centre_of_pressure", "max_pressure_at"}), frozenset({"coordinates"})),
)
BY_BODY = {"reactions", "target_forces"}  # a part of the path that names a body or surface follows


@dataclass(frozen=True)
class Difference:
    """One array or number: how many values, the largest relative difference (inf where sizes differ, or a number is not a
    number on one side only), and whether every bit is the same."""

    name: str
    count: int
    relative: float
    identical: bool


@dataclass(frozen=True)
class Comparison:
    """Two runs: a Difference for every quantity that both have; names of quantities and files on one side only; words that
    differ."""

    differences: tuple[Difference, ...]
    missing: tuple[str, ...]
    new: tuple[str, ...]
    words: tuple[str, ...]

    @property
    def count(self) -> int:
        return sum(d.count for d in self.differences)

    @property
    def identical(self) -> bool:
        return all(d.identical for d in self.differences)

    @property
    def worst(self) -> Difference | None:
        """The largest difference; None where nothing was compared."""
        return max(self.differences, key=lambda d: d.relative, default=None)

    def above(self, tolerance: float) -> list[Difference]:
        """Differences that exceed ``tolerance``, the largest first."""
        return sorted((d for d in self.differences if d.relative > tolerance), key=lambda d: -d.relative)

    def passes(self, tolerance: float) -> bool:
        """Nothing is missing, nothing exceeds ``tolerance``, and there was something to compare."""
        return bool(self.differences) and not self.missing and not self.above(tolerance)


def compare(before: Quantities, after: Quantities) -> Comparison:
    """Every number of two runs."""
    sizes = {id(scale): max(_largest(before, scale), _largest(after, scale)) for scale in SCALES}
    differences = []
    for name in before.numbers.keys() & after.numbers.keys():
        scale = _scale(name)
        least = sizes[id(scale)] if scale else 0.0
        differences.append(difference(name, before.numbers[name], after.numbers[name], least))
    names = [q.files | q.numbers.keys() | q.words.keys() for q in (before, after)]
    return Comparison(
        differences=tuple(sorted(differences, key=lambda d: d.name)),
        missing=tuple(sorted(names[0] - names[1])),
        new=tuple(sorted(names[1] - names[0])),
        words=tuple(sorted(n for n in before.words.keys() & after.words.keys() if before.words[n] != after.words[n])),
    )


def difference(name: str, before: np.ndarray, after: np.ndarray, least: float = 0.0) -> Difference:
    """Of two arrays, relative to the largest absolute value of both, or to ``least`` where that is larger."""
    count = max(before.size, after.size)
    if before.shape != after.shape:
        return Difference(name, count, np.inf, False)
    identical = before.dtype == after.dtype and before.tobytes() == after.tobytes()
    one, other = before.astype(float), after.astype(float)
    equal = (one == other) | (np.isnan(one) & np.isnan(other))
    if equal.all():
        return Difference(name, count, 0.0, identical)
    if not np.isfinite(one[~equal]).all() or not np.isfinite(other[~equal]).all():
        return Difference(name, count, np.inf, False)
    size = max(_size(one), _size(other))
    if _leaf(name) in ERRORS and size < ROUNDING:
        size = 1.0
    largest = float(np.abs(one[~equal] - other[~equal]).max())
    return Difference(name, count, largest / max(size, least), False)


def _size(values: np.ndarray) -> float:
    finite = np.abs(values[np.isfinite(values)])
    return float(finite.max(initial=0.0))


def _largest(quantities: Quantities, scale: Scale) -> float:
    return max(
        (_size(v.astype(float)) for name, v in quantities.numbers.items() if _leaf(name) in scale.of), default=0.0
    )


def _scale(name: str) -> Scale | None:
    return next((scale for scale in SCALES if _leaf(name) in scale.names), None)


def _leaf(name: str) -> str:
    """What a quantity is: the last part of its path; of what is given by body, the part before."""
    *parts, last = name.split("/")
    return parts[-1] if parts and parts[-1] in BY_BODY else last
