"""A plot of the report."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Beside:
    """A section that compares a solution with another one: title, what it says, head and rows of a table, charts."""

    title: str
    text: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    charts: tuple[Chart, ...]


@dataclass(frozen=True)
class Chart:
    """title, label of the axis, x (n,), series by name (n,), NaN where a line is broken."""

    title: str
    label: str
    x: NDArray[np.float64]
    series: dict[str, NDArray[np.float64]]
