"""Errors of the stresses at contact nodes, cell by cell, against closed forms: the table of docs/verification/stresses.md.

OMP_NUM_THREADS=1 python bench/stress/table.py [--cells quad4,hex8]
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import abut
from abut.cells import CELLS

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
from models.stresses import ball_errors, fit_errors, hertz_ball, hertz_line, line_errors, press_fit

SIZES = {1: {"line": (8, 16), "ball": (6, 12), "fit": (8, 16)}, 2: {"line": (8, 16), "ball": (6, 12), "fit": (3, 6)}}
SOLID = {1: (6, 10), 2: (4, 6)}
CASES = {
    "line": (hertz_line, line_errors),
    "ball": (hertz_ball, ball_errors),
    "fit": (press_fit, fit_errors),
}


def main() -> None:
    """Print a row for each case, cell and size."""
    parser = argparse.ArgumentParser(description=__doc__)
    every = [kind for kind, cell in CELLS.items() if cell.dim > 1 and not kind.startswith("wedge")]
    parser.add_argument("--cells", type=lambda text: text.split(","), default=every)
    print(
        "| case | cells | n | normal % | von Mises % | shear below % | stress error near % |\n|---|---|---|---|---|---|---|"
    )
    for kind in parser.parse_args().cells:
        cell = CELLS[kind]
        for case, sizes in SIZES[cell.degree].items() if cell.dim == 2 else (("ball", SOLID[cell.degree]),):
            model, errors = CASES[case]
            for n in sizes:
                solution = abut.solve(model(kind, n))
                found, estimate = errors(solution), solution.steps[-1].stress_error
                off = max(e.error for e in estimate.near) if estimate else 0.0
                values = [found["normal"], found["von Mises"], found.get("shear"), off]
                text = " | ".join("" if value is None else f"{100 * value:.1f}" for value in values)
                print(f"| {case} | {kind} | {n} | {text} |", flush=True)


if __name__ == "__main__":
    main()
