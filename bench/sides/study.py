"""Which side should be the contactor: local errors of the pressure with either side, and with the one that abut chooses.

python bench/sides/study.py [--full] [--kind line|rings|punch|ball] [--markdown]
The short form takes a few minutes, --full (all facet types and ratios) an hour.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from dataclasses import dataclass

from cases import KINDS, Case, cases

import abut
from abut.cells import CELLS
from abut.errors import AbutError

PLANE = ["quad4", "tri3", "quad8", "tri6", "quad9"]
SOLID = ["hex8", "tet4", "hex20", "tet10", "wedge6", "hex27", "wedge15"]
LIMITS = {"line": 0.04, "rings": 0.15, "punch": 0.1, "hex": 0.06, "wedge": 0.06, "tet": 0.09}
RATIOS = [1e-3, 1e-1, 1.0, 10.0, 1e3]
MORE_RATIOS = [1e-3, 1e-2, 0.1, 0.5, 0.8, 1.0, 1.25, 2.0, 10.0, 1e2, 1e3]
SIZES = {
    "line": [(8, 8), (8, 12), (12, 8), (8, 16), (16, 8), (8, 40), (40, 8)],
    "rings": [(8, 8), (8, 12), (12, 8), (8, 24), (24, 8)],
    "punch": [(10, 10), (10, 20), (20, 10), (10, 50), (50, 10)],
    "ball": [(8, 8), (8, 12), (12, 8)],
}
MORE_SIZES = {**SIZES, "ball": [(8, 8), (8, 10), (10, 8), (8, 12), (12, 8), (8, 16), (16, 8)]}


@dataclass(frozen=True)
class Row:
    """errors: at facet corners with the first side, and with the second, as contactor; everywhere: at all nodes; chosen: by
    abut, 0 or 1; why: in its words."""

    case: Case
    errors: tuple[float, float]
    everywhere: tuple[float, float]
    chosen: int
    why: str

    @property
    def limit(self) -> float:
        cell = self.case.cells[0]
        return LIMITS.get(self.case.kind) or next(LIMITS[k] for k in ("hex", "wedge", "tet") if cell.startswith(k))


def run(case: Case) -> Row:
    """Solve a case with either side, and see which one abut takes."""
    (contact,) = case.model().contacts
    found = []
    for side in (0, 1):
        try:
            solution = abut.solve(case.forced(side))
            found.append((case.error(solution, True), case.error(solution, False)))
        except AbutError:
            found.append((math.inf, math.inf))
    corner, every = zip(*found)
    return Row(case, corner, every, int(contact.turned), contact.chosen)


def chosen_cases(kind: str, full: bool) -> Iterator[Case]:
    """Cases of one kind: one cell type on both sides, and mixed ones."""
    types = SOLID if kind == "ball" else PLANE
    if not full:
        types = types[:4] if kind != "ball" else types[:2]
    pairs = [(cell, cell) for cell in types]
    if full:
        pairs += [(a, b) for a, b in ((types[0], types[2]), (types[2], types[0]))]
    ratios, sizes = (MORE_RATIOS, MORE_SIZES) if full else (RATIOS, SIZES)
    return cases(kind, pairs, ratios, sizes[kind])


def line_of(row: Row) -> list[str]:
    """A row of the table: the chosen side's errors are marked."""
    case = row.case
    cells = case.cells[0] if case.cells[0] == case.cells[1] else " on ".join(case.cells)
    text = [case.kind, cells, f"{case.ratio:g}", f"{case.sizes[0]}, {case.sizes[1]}"]
    for side in (0, 1):
        numbers = f"{100 * row.errors[side]:.1f}"
        if any(CELLS[cell].degree == 2 for cell in case.cells):
            numbers += f" ({100 * row.everywhere[side]:.1f})"
        text.append(numbers + (" *" if row.chosen == side else ""))
    return [*text, row.why]


HEADER = ["problem", "cells", "ratio", "facets", "first", "second", "abut's choice (*)"]


def summary(rows: list[Row]) -> list[list[str]]:
    """Worst errors of each kind and cell type: with abut's choice, with the better side, with the worse one."""
    result = []
    for key in dict.fromkeys((row.case.kind, row.case.cells) for row in rows):
        own = [row for row in rows if (row.case.kind, row.case.cells) == key]
        taken, best, worst = (
            max(f(row) for row in own)
            for f in (lambda r: r.errors[r.chosen], lambda r: min(r.errors), lambda r: max(r.errors))
        )
        mid = max(row.everywhere[row.chosen] for row in own)
        numbers = [f"{100 * v:.1f}" for v in (taken, mid, best, worst, own[0].limit)]
        result.append([key[0], " on ".join(dict.fromkeys(key[1])), str(len(own)), *numbers])
    return result


SUMMARY = ["problem", "cells", "models", "chosen", "with mid-nodes", "better side", "worse side", "limit"]


def show(header: list[str], rows: list[list[str]], markdown: bool) -> None:
    """Print a table."""
    width = [max(len(row[i]) for row in (header, *rows)) for i in range(len(header))]
    if markdown:
        rows = [["---"] * len(header), *rows]
    for row in (header, *rows):
        if markdown:
            print("| " + " | ".join(row) + " |")
        else:
            print("  ".join(text.ljust(w) for text, w in zip(row, width)).rstrip())


def main() -> int:
    """Run the study; 1 where abut's choice misses a limit at facet corners."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--full", action="store_true")
    parser.add_argument("--kind", choices=KINDS, action="append")
    parser.add_argument("--markdown", action="store_true")
    arguments = parser.parse_args()
    rows = [run(case) for kind in arguments.kind or KINDS for case in chosen_cases(kind, arguments.full)]
    show(HEADER, [line_of(row) for row in rows], arguments.markdown)
    print()
    show(SUMMARY, summary(rows), arguments.markdown)
    return int(any(row.errors[row.chosen] > row.limit for row in rows))


if __name__ == "__main__":
    raise SystemExit(main())
