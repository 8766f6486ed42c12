"""Tables of the report: what bolts, connectors, shells and beams carry and how far fluids have got, where there are any."""

from __future__ import annotations

from abut.report import connectors, penetrations, preloads, thin
from abut.solution import Solution


def carried_tables(solution: Solution) -> list[tuple[list[str], list[list[str]], str]]:
    """Head, rows and title of each."""
    found = []
    if solution.model.connectors:
        found.append((connectors.HEAD, connectors.connector_rows(solution), "What connectors do"))
    if solution.model.preloads:
        found.append((preloads.HEAD, preloads.preload_rows(solution), "What preloads carry"))
        found.append(
            (preloads.FACTOR_HEAD, preloads.factor_rows(solution), "What preloads take of loads, after tightening")
        )
    if solution.model.penetrations:
        rows = penetrations.penetration_rows(solution)
        found.append((penetrations.HEAD, rows, "How far fluids have got into contacts, and what they exert"))
    return found + thin.thin_tables(solution)
