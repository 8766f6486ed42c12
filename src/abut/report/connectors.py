"""Connectors in the report: motion and force of every one, step by step."""

from __future__ import annotations

from abut.report.contact_words import vector
from abut.solution import Solution
from abut.solution.connectors import ConnectorResult

HEAD = ["connector", "step", "motion", "force on the first body", "moment about the joint", "along the motion"]
MOST = 200  # rows


def connector_rows(solution: Solution) -> list[list[str]]:
    """One for each connector and step, of the last steps where they are many."""
    rows = []
    for step in solution.steps:
        for name, result in step.connectors.items():
            motion = ", ".join(f"{what} {value:.6g}" for what, value in result.motion.items())
            size = float(abs(result.force).max(initial=0.0))
            rows.append(
                [name, f"{step.number}", motion, vector(result.force), vector(result.moment, size), _along(result)]
            )
    return rows[-MOST:]


def _along(result: ConnectorResult) -> str:
    """What its stop or drive does, in words."""
    said = [] if result.drive is None else [f"drive {result.drive:.6g}"]
    stops = [("stop", result.stop), ("stop of the second", result.stop2)]
    said += [f"{what} {value:.6g}" for what, value in stops if value]
    limited = any(value is not None for _, value in stops)
    return ", ".join(said) or ("between its limits" if limited else "")
