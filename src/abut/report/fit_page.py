"""Tests of rubber and the law fitted to them, as a page."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path

import numpy as np

from abut.materials.fitting import Fit
from abut.materials.rubber_tests import RubberTest, nominal_stress, stable_range
from abut.report.svg import Series, plot

STATIC = Path(__file__).parent / "static"
POINTS = 60  # of a line


def fit_page(law: str, names: Sequence[str], tests: Sequence[RubberTest], found: Fit) -> str:
    """A page without scripts; names: of the tests."""
    style = "".join((STATIC / name).read_text(encoding="utf-8") for name in ("report.css", "still.css"))
    body = "".join(_chart(name, test, found) for name, test in zip(names, tests))
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{escape(law)}</title><style>{style}</style>'
        f'<main class="still"><h1>{escape(law)}</h1>{body}</main></html>\n'
    )


def _chart(name: str, test: RubberTest, found: Fit) -> str:
    """The test as points, and the law between its ends."""
    order = np.argsort(test.stretch)
    line = np.linspace(float(test.stretch.min()), float(test.stretch.max()), POINTS)
    x = np.concatenate([test.stretch[order], line])
    law = nominal_stress(found.energy, test.kind, line)
    none: list[float | None] = [None] * len(order)
    low, high = stable_range(found.energy, test.kind)
    title = f"{name}: {test.kind}, stable for stretches {low:.3g} to {high:.3g}"
    series = [
        Series("test", [*test.stress[order].tolist(), *[None] * POINTS]),
        Series("law", [*none, *law.tolist()], "second", "6 3"),
    ]
    return plot(title, "stretch", x.tolist(), series)
