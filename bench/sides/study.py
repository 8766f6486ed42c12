"""Which side should be the contactor: local errors of the pressure with either side, and with the one that abut chooses.

python bench/sides/study.py [PART ...] [--cells CELL ...] [--chosen] [--markdown] [--rows]
Parts: those of ``PARTS`` with closed forms, and "edge" and "snap" (large sliding); all of them by default. A part takes a
minute or two, those of solids of second order and the finest ten a cell type, which --cells picks by that of the side named
first: --chosen solves each model once, with abut's choice.
The exit status is 1 where abut's choice misses a limit, or where the wrong side is off by more than that and no
line that says "swap" fails or warns.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from moving import MOVING
from problems import KINDS, Case

import abut
from abut.diagnosis.cures import cure
from abut.errors import AbutError

RATIOS = (1e-3, 1e-1, 1.0, 10.0, 1e3)
FLAT = ("quad4", "tri3", "quad8", "tri6", "quad9")
MIXED = (("quad4", "quad8"), ("tri6", "quad4"), ("quad9", "tri3"))
SOLID, SOLID_2 = ("hex8", "tet4", "wedge6"), ("hex20", "tet10", "hex27", "wedge15")
MIXED_SOLID = (("hex8", "tet10"), ("tet4", "hex20"))


@dataclass(frozen=True)
class Part:
    """kind: of problem; cells: of both sides; at: pairs of a ratio of moduli and numbers of facets; limit: of errors,
    of each cell type by how its name begins, largest of both sides."""

    kind: str
    cells: tuple[tuple[str, str], ...]
    at: tuple[tuple[float, tuple[int, int]], ...]
    limit: dict[str, float]

    def cases(self, only: Sequence[str] = ()) -> Iterator[Case]:
        """All models of the part; ``only`` those whose first side has such cells."""
        for pair in self.cells:
            if only and pair[0] not in only:
                continue
            for ratio, sizes in self.at:
                yield KINDS[self.kind](pair, ratio, sizes)


def _every(ratios: tuple[float, ...], *sizes: tuple[int, int]) -> tuple[tuple[float, tuple[int, int]], ...]:
    return tuple((ratio, both) for ratio in ratios for both in sizes)


def _corners(n: int, fine: int) -> tuple[tuple[float, tuple[int, int]], ...]:
    """Of the range of moduli and sizes, and its middle."""
    unlike = ((n, fine), (fine, n))
    return ((1.0, (n, n)), *_every((1e-3, 1.0, 1e3), *unlike))


def _diagonal(n: int, fine: int) -> tuple[tuple[float, tuple[int, int]], ...]:
    """The middle; the softer side finer, coarser, and alike bodies."""
    return ((1.0, (n, n)), (1e-3, (fine, n)), (1e3, (fine, n)), (1.0, (n, fine)))


def _alike(*cells: str) -> tuple[tuple[str, str], ...]:
    return tuple((cell, cell) for cell in cells)


HERTZ = {"quad": 0.04, "tri": 0.04, "hex": 0.06, "tet": 0.09, "wedge": 0.09}
LAME = {"quad": 0.15, "tri": 0.15}
# Of facets of 0.2 of the half width and a pressure without limit at its edge.
PUNCH = {"quad": 0.1, "tri": 0.15}
LINES = ((8, 8), (8, 12), (12, 8), (8, 16), (16, 8), (8, 40), (40, 8))
PARTS = {
    "line": Part("line", _alike(*FLAT), _every(RATIOS, *LINES), HERTZ),
    "line-near": Part("line", _alike(*FLAT), _every((1.5, 3.0), *LINES[1:]), HERTZ),
    "line-mixed": Part("line", MIXED, _corners(8, 24), HERTZ),
    "column": Part("column", _alike(*FLAT), _corners(10, 50), HERTZ),
    "rings": Part("rings", _alike(*FLAT), _every(RATIOS, (8, 8), (8, 12), (12, 8), (8, 24), (24, 8)), LAME),
    "punch": Part("punch", _alike(*FLAT), _every((1e4,), (10, 10), (10, 20), (20, 10), (10, 50), (50, 10)), PUNCH),
    "ball": Part("ball", _alike(*SOLID), _corners(8, 12), HERTZ),
    "ball-near": Part("ball", _alike("hex8", "tet4"), _every((1.5, 3.0), (8, 16)), HERTZ),
    "ball-fine": Part("ball", _alike(*SOLID), _diagonal(8, 40), HERTZ),
    "ball-2": Part("ball", _alike(*SOLID_2), _diagonal(8, 16), HERTZ),
    "ball-mixed": Part("ball", MIXED_SOLID, _diagonal(8, 12), HERTZ),
    "column-3d": Part("column", _alike(*SOLID, *SOLID_2), _diagonal(10, 14), HERTZ),
}
LONG = (
    "ball-near",
    "ball-fine",
    "ball-2",
    "ball-mixed",
    "column-3d",
)  # whose models docs/make/studies.py solves with abut's choice only


@dataclass(frozen=True)
class Row:
    """errors: with the first side, and with the second, as contactor, NaN where not solved; chosen: by abut, 0 or 1; why: in
    its words; said: whether with the other side a line fails or warns ("sides", "oscillation", "pressure error") whose cure
    says "swap"."""

    case: Case
    errors: tuple[float, float]
    chosen: int
    why: str
    said: bool
    limit: float

    @property
    def silent(self) -> bool:
        """Whether the other side is off by more than the limit, and no line says that it is the sides."""
        return self.errors[1 - self.chosen] > self.limit and not self.said


def run(case: Case, limit: float, both: bool) -> Row:
    """Solve a case with the side that abut takes, and with the other one."""
    (contact,) = case.model().contacts
    chosen, said, errors = int(contact.turned), False, [math.nan, math.nan]
    for side in (chosen, 1 - chosen) if both else (chosen,):
        try:
            solution = abut.solve(case.forced(side))
        except AbutError:
            errors[side] = math.inf
            continue
        errors[side] = case.error(solution)
        said = side != chosen and any("swap" in cure(check, solution) for check in solution.certificate)
    return Row(case, (errors[0], errors[1]), chosen, contact.chosen, said, limit)


def rows_of(part: Part, both: bool, only: Sequence[str] = ()) -> Iterator[Row]:
    """Solve a part's models, ``only`` of some cells."""
    for case in part.cases(only):
        limit = max(part.limit[key] for cell in case.cells for key in part.limit if cell.startswith(key))
        yield run(case, limit, both)


def line_of(row: Row) -> list[str]:
    """One model: the chosen side's error is marked, and where the other one is called a wrong choice."""
    case = row.case
    text = [_named(case), f"{case.ratio:g}", f"{case.sizes[0]}, {case.sizes[1]}"]
    marks = [" *" if row.chosen == side else " said" if row.said else "" for side in (0, 1)]
    return [*text, *(_percent(error) + mark for error, mark in zip(row.errors, marks)), row.why]


def summary(part: str, rows: list[Row]) -> list[list[str]]:
    """Worst errors of each kind and cell type: with abut's choice, with the better side, with the worse one; of how many
    models the other side is off by more than the limit, and of how many of these a line says so."""
    result = []
    for key in dict.fromkeys(row.case.cells for row in rows):
        own = [row for row in rows if row.case.cells == key]
        both = [row for row in own if not any(map(math.isnan, row.errors))]
        taken = max(row.errors[row.chosen] for row in own)
        best, worst = (max((f(row.errors) for row in both), default=math.nan) for f in (min, max))
        wrong = [row for row in both if row.errors[1 - row.chosen] > row.limit]
        said = f"{sum(row.said for row in wrong)} of {len(wrong)}" if both else "-"
        numbers = [_percent(value) for value in (taken, own[0].limit, best, worst)]
        result.append([part, _named(own[0].case), str(len(own)), *numbers, said])
    return result


def _named(case: Case) -> str:
    return " on ".join(dict.fromkeys(case.cells))


def _percent(value: float) -> str:
    return "-" if math.isnan(value) else f"{100 * value:.1f}"


SUMMARY = ["part", "cells", "models", "abut's choice", "limit", "better side", "worse side", "wrong and said"]


def show(header: list[str], rows: list[list[str]], markdown: bool) -> None:
    """Print a table."""
    width = [max(len(row[i]) for row in (header, *rows)) for i in range(len(header))]
    if markdown:
        rows = [["---"] * len(header), *rows]
    for row in (header, *rows):
        if markdown:
            print("| " + " | ".join(row) + " |", flush=True)
        else:
            print("  ".join(text.ljust(w) for text, w in zip(row, width)).rstrip(), flush=True)


def main() -> int:
    """Run the study, part by part."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", choices=[*PARTS, *MOVING, []], metavar="PART")
    parser.add_argument("--cells", nargs="+", default=(), help="only models whose first side has such cells")
    parser.add_argument("--chosen", action="store_true", help="solve with abut's choice only")
    parser.add_argument(
        "--rows", action="store_true", help="show every model: cells, ratio, facets, errors of both sides"
    )
    parser.add_argument("--markdown", action="store_true")
    arguments = parser.parse_args()
    missed = False
    for name in arguments.parts or [*PARTS, *MOVING]:
        if name in MOVING:
            show(*MOVING[name](), arguments.markdown)
            continue
        rows = []
        for row in rows_of(PARTS[name], not arguments.chosen, arguments.cells):
            rows.append(row)
            if arguments.rows:
                print("  ".join(line_of(row)), flush=True)
        show(SUMMARY, summary(name, rows), arguments.markdown)
        missed |= any(row.errors[row.chosen] > row.limit or row.silent for row in rows)
    return int(missed)


if __name__ == "__main__":
    raise SystemExit(main())
