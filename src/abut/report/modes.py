"""Frequencies and buckling loads in the report."""

from __future__ import annotations

import numpy as np

from abut.solution import ModesResult, Solution
from abut.solution.modes import COMPLEX, FREQUENCIES

MOST = 200  # rows
PER_LINE = 10


def modes_tables(solution: Solution) -> list[tuple[list[str], list[list[str]], str]]:
    """Head, rows and title of each."""
    return [_table(solution, result) for result in solution.modes]


def mode_lines(result: ModesResult) -> list[str]:
    """For the terminal: what was found, a few numbers a line."""
    if result.kind == COMPLEX:
        return _complex_lines(result)
    shown = [f"{value:.6g}" for value in result.values[:MOST]]
    head = f"{result.words} {'(cycles per time)' if result.kind == FREQUENCIES else '(factors)'}:"
    rows = [", ".join(shown[i : i + PER_LINE]) for i in range(0, len(shown), PER_LINE)]
    more = [f"and {len(result) - MOST} more, in modes.csv"] if len(result) > MOST else []
    return [f"{head} {rows[0]}", *(f"  {row}" for row in (*rows[1:], *more))]


def stability(result: ModesResult) -> str:
    """Of complex frequencies, in a line."""
    if not (result.slips or len(result.whirl)):
        return "nothing slips at the end of the last step, so friction makes none of them complex"
    count = int(result.unstable.sum())
    if not count:
        return f"all {len(result)} stable"
    worst = int(np.argmax(result.growth))
    return (
        f"{count} of {len(result)} unstable: the fastest grows at {result.growth[worst]:.6g} per time, "
        f"frequency {result.values[worst]:.6g} (mode {worst + 1})"
    )


def _complex_lines(result: ModesResult) -> list[str]:
    rows = [
        f"  {value:.6g}, {growth:.6g}{f', {around:.3g}' if around is not None else ''}{', unstable' if unstable else ''}"
        for value, growth, unstable, around in zip(
            result.values[:MOST], result.growth, result.unstable, _around(result)
        )
    ]
    more = [f"  and {len(result) - MOST} more, in modes.csv"] if len(result) > MOST else []
    whirl = ", whirl from -1 (against the rotation) to 1" if len(result.whirl) else ""
    return [f"{result.kind} (cycles per time, rate of growth per time{whirl}): {stability(result)}", *rows, *more]


def _around(result: ModesResult) -> list[float] | list[None]:
    """How each mode whirls, None where nothing turns."""
    return result.whirl.tolist() if len(result.whirl) else [None] * len(result)


def _complex_table(result: ModesResult) -> tuple[list[str], list[list[str]], str]:
    parts = zip(result.values[:MOST], result.growth, result.unstable, _around(result))
    rows = [
        [
            f"{i + 1}", f"{value:.6g}", f"{growth:.6g}", *([] if around is None else [f"{around:.3f}"]),
            "unstable" if unstable else "",
        ]
        for i, (value, growth, unstable, around) in enumerate(parts)
    ]  # fmt: skip
    head = ["mode", "frequency (cycles per time)", "rate of growth (per time)"]
    head += ["whirl (1: with the rotation, -1: against it)", ""] if len(result.whirl) else [""]
    return head, rows, f"Complex frequencies about the end of the last step: {stability(result)}"


def _table(solution: Solution, result: ModesResult) -> tuple[list[str], list[list[str]], str]:
    """Of the modes of a kind, the first ones where they are many."""
    if result.kind == COMPLEX:
        return _complex_table(result)
    if result.kind != FREQUENCIES:
        rows = [[f"{i + 1}", f"{value:.6g}"] for i, value in enumerate(result.values[:MOST])]
        return ["mode", "factor of the state's stresses"], rows, "Linear buckling about the end of the last step"
    if result.diameter:
        rows = [[f"{i + 1}", f"{value:.6g}"] for i, value in enumerate(result.values[:MOST])]
        title = f"Natural frequencies with nodal diameter {result.diameter} about the end of the last step"
        return ["mode", "frequency (cycles per time)"], rows, title
    along = "y" if solution.model.mesh.axisymmetric else "xyz"[: solution.model.dim]
    share = 100.0 * result.effective[:, : len(along)] / np.maximum(result.mass[: len(along)], 1e-300)
    rows = [
        [f"{i + 1}", f"{value:.6g}", *(f"{part:.3g} %" for part in shares)]
        for i, (value, shares) in enumerate(zip(result.values[:MOST].tolist(), share.tolist()))
    ]
    rows.append([f"{len(result)} together", "", *(f"{part:.3g} %" for part in share.sum(axis=0))])
    head = ["mode", "frequency (cycles per time)", *(f"effective mass along {a}" for a in along)]
    return head, rows, "Natural frequencies about the end of the last step"
