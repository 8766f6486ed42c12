"""Models at large displacements that once stopped on the way: how far they go, in how many steps and iterations.

    python bench/once_stopped.py [--only "over an edge *"]

Prints a table. Iterations are all that were made, those of failed steps among them.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Mapping
from dataclasses import replace
from fnmatch import fnmatch
from pathlib import Path

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

import numpy as np

import abut
from abut.solution import Iteration
from models.clamps import WHOLE, wrung
from models.sharp_edges import over_edge

TENTHS = abut.SolveOptions(times=tuple(np.linspace(0.1, 1.0, 10)))
MODELS: Mapping[str, Callable[[], abut.Model]] = {
    "over an edge, tri3, friction 0.3, block whole": lambda: over_edge("tri3", "block", "ground", 0.3),
    "over an edge, tri3, friction 0.3, ground whole": lambda: over_edge("tri3", "ground", "block", 0.3),
    "over an edge, quad4, friction 0.3, block whole": lambda: over_edge("quad4", "block", "ground", 0.3),
    "over an edge, quad4, friction 0.3, ground whole": lambda: over_edge("quad4", "ground", "block", 0.3),
    "over an edge, quad8, block whole": lambda: over_edge("quad8", "block", "ground", 0.0),
    "over an edge, quad8, friction 0.3, block whole": lambda: over_edge("quad8", "block", "ground", 0.3),
    "over an edge, quad8, ground whole": lambda: over_edge("quad8", "ground", "block", 0.0),
    "over an edge, quad8, friction 0.3, ground whole": lambda: over_edge("quad8", "ground", "block", 0.3),
    "jaws wrung, tet10, steps of a tenth": lambda: replace(wrung("tet10", WHOLE), solve=TENTHS),
}


def row(name: str, model: abut.Model) -> str:
    """A line of the table."""
    rows: list[Iteration] = []

    def observe(what: object) -> None:
        if isinstance(what, Iteration):
            rows.append(what)

    solution = abut.solve(model, observer=observe)
    done = [step for step in solution.steps if step.converged]
    return f"| {name} | {done[-1].factor if done else 0.0:.3g} | {len(done)} | {len(rows)} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="*")
    only = parser.parse_args().only
    print("| model | gets to | steps | iterations |\n|---|---|---|---|")
    for name, model in MODELS.items():
        if fnmatch(name, only):
            print(row(name, model()), flush=True)


if __name__ == "__main__":
    main()
