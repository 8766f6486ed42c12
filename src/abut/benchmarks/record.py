"""What a benchmark is: a family of models by level of refinement, quantities, references with their sources."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from abut.analysis import solve
from abut.errors import InputError
from abut.model import Model

NO_RATE = 1e-10  # errors below are rounding: they follow no power of the mesh size
Measure = Callable[[Any], Mapping[str, float]]


@dataclass(frozen=True)
class Reference:
    """What a quantity should be. ``tolerance`` is relative to ``value``, absolute where that is zero; ``reason`` says why
    it is as large as it is. ``rate``: the order of convergence expected of errors (their value is then zero), met within
    ``rate_tolerance``; asked for only where levels are refined."""

    value: float
    tolerance: float
    source: str
    reason: str
    rate: float | None = None
    rate_tolerance: float = 0.1


@dataclass(frozen=True)
class Benchmark:
    """A problem with a known answer.

    model: level -> Model; level 0 is what ``abut verify`` runs by default, each next one is finer.
    size: level -> mesh size, up to a factor; halved from level to level if not given.
    solve: Model -> what ``measure`` looks at; ``abut.solve`` if not given.
    measure: solution -> value of each quantity named in ``references``.
    levels: how many levels are run by default (more than one where a rate is asked for).
    """

    name: str
    title: str
    model: Callable[[int], Model]
    measure: Measure
    references: Mapping[str, Reference]
    levels: int = 1
    size: Callable[[int], float] = lambda level: 0.5**level
    solve: Callable[[Model], Any] = solve


@dataclass(frozen=True)
class Outcome:
    """One quantity of one benchmark: its values by level against the reference; ``rate``: p of errors ~ h^p, fitted over
    all levels (None for one level, and where errors are rounding)."""

    benchmark: str
    quantity: str
    values: tuple[float, ...]
    reference: Reference
    rate: float | None
    seconds: float

    @property
    def error(self) -> float:
        """Of the finest level, relative to the reference (absolute where that is zero)."""
        return self.errors[-1]

    @property
    def errors(self) -> tuple[float, ...]:
        """Of every level, coarse to fine."""
        return _errors(self.values, self.reference)

    @property
    def passed(self) -> bool:
        """The finest level is within tolerance, and the rate is the reference's where there is one."""
        sound = bool(np.isfinite(self.values[-1]) and self.error <= self.reference.tolerance)
        if self.rate is None or self.reference.rate is None:
            return sound
        return sound and self.rate > self.reference.rate - self.reference.rate_tolerance


def run(benchmark: Benchmark, levels: int | None = None) -> list[Outcome]:
    """Run a benchmark at levels 0 .. levels - 1 and compare. Raises InputError for fewer levels than one."""
    count = benchmark.levels if levels is None else levels
    if count < 1:
        raise InputError(f"levels: expected a whole number >= 1, got {count}")
    start = time.perf_counter()
    measured = [dict(benchmark.measure(benchmark.solve(benchmark.model(level)))) for level in range(count)]
    seconds = time.perf_counter() - start
    sizes = [benchmark.size(level) for level in range(count)]
    outcomes = []
    for quantity, reference in benchmark.references.items():
        values = tuple(float(row[quantity]) for row in measured)
        rate = _rate(sizes, _errors(values, reference))
        outcomes.append(Outcome(benchmark.name, quantity, values, reference, rate, seconds))
    return outcomes


def _errors(values: Sequence[float], reference: Reference) -> tuple[float, ...]:
    return tuple(abs(value - reference.value) / (abs(reference.value) or 1.0) for value in values)


def _rate(sizes: Sequence[float], errors: Sequence[float]) -> float | None:
    """Order p of errors ~ h^p by a fit over all levels."""
    if not np.isfinite(errors).all():
        return float("nan")  # which passes no comparison
    if len(errors) < 2 or min(errors) < NO_RATE:
        return None
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])
