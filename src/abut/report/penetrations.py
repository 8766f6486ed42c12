"""Pressure penetration in the report: how far every fluid has got, step by step."""

from __future__ import annotations

from abut.report.contact_words import vector
from abut.solution import Solution

HEAD = [
    "fluid",
    "step",
    "pressure",
    "area that it wets",
    "share of the contactor",
    "force on contactor",
    "force on target",
]
MOST = 200  # rows


def penetration_rows(solution: Solution) -> list[list[str]]:
    """One for each fluid and step, of the last steps where they are many."""
    rows = []
    for step in solution.steps:
        for name, fluid in step.penetrations.items():
            numbers = (fluid.pressure, fluid.area, fluid.share)
            forces = (vector(fluid.contactor), vector(fluid.target))
            rows.append([name, f"{step.number}", *(f"{value:.6g}" for value in numbers), *forces])
    return rows[-MOST:]
