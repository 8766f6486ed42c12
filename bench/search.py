"""How many linear solutions the search for the active set takes, and how long, whatever the mesh and the linear solver.

python bench/search.py [--most 400] [--paths elimination,saddle,multigrid] [--problems beam,ball]

A count is the number of rows in the table of a run, in its worst load step. The clevis has a script of its own, clevis.py.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

import abut
from abut.job import load_job
from abut.linear import static_condensation
from models.search import ball, beam, layer, line, pin, solid_beam

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
PATHS = ("elimination", "saddle", "multigrid")
MOST, GROWTH, MORE = 20, 1.3, 3  # linear solutions; of the finest mesh, over those of the coarsest
PLANE, SOLID = ("tri3", "quad4", "tri6", "quad8", "quad9"), ("hex8", "hex20", "tet10")


@dataclass(frozen=True)
class Problem:
    """name: of what is solved; detail: cells, pressure or load steps; sizes: of the mesh; model: for a size."""

    name: str
    detail: str
    sizes: tuple[int, ...]
    model: Callable[[int], abut.Model]


@dataclass(frozen=True)
class Count:
    """solutions: of each load step; direct: whether a direct solver had to take over."""

    solutions: tuple[int, ...]
    seconds: float
    direct: bool


def pin_lug(_: int) -> abut.Model:
    return load_job(EXAMPLES / "pin-lug" / "job.toml").model


def problems() -> list[Problem]:
    """All of them."""
    facets, cells = (50, 100, 200, 400, 800), (48, 96, 192, 384, 768)
    return [
        *(Problem("beam", cell, facets, lambda n, c=cell: beam(n, c)) for cell in PLANE),
        *(Problem("beam in space", cell, (25, 50, 100), lambda n, c=cell: solid_beam(n, c)) for cell in SOLID),
        *(Problem("ball", cell, cells, lambda n, c=cell: ball(n, cell=c)) for cell in ("quad4", "quad8")),
        *(Problem("ball", f"quad8, {k} steps", cells, lambda n, k=k: ball(n, cell="quad8", steps=k)) for k in (4, 10)),
        *(Problem("layer", cell, facets, lambda n, c=cell: layer(n, c)) for cell in ("quad4", "quad8")),
        *(
            Problem("cylinder", f"{cell}, {space}", (10, 20, 40), lambda n, c=cell, s=space: line(n, c, pressure=s))
            for cell in ("quad8", "tri6")
            for space in ("auto", "P1", "P2")
        ),
        *(
            Problem("loose pin", f"force {force:g}", (12, 24, 48), lambda n, f=force: pin(n, f))
            for force in (0.05, 5.0)
        ),
        Problem("pin in a lug", "tet10", (1,), pin_lug),
    ]


@contextmanager
def without_elimination(active: bool) -> Iterator[None]:
    """Direct solution of the whole matrix, at every iteration, as of interfaces too large for dense matrices."""
    before = static_condensation.LARGEST
    static_condensation.LARGEST = 0 if active else before
    try:
        yield
    finally:
        static_condensation.LARGEST = before


def count(model: abut.Model, path: str) -> Count:
    """Solve a model by one of ``PATHS``. Raises RuntimeError where it does not converge."""
    linear = "amg" if path == "multigrid" else "direct"
    clock = time.perf_counter()
    with without_elimination(path == "saddle"):
        solution = abut.solve(replace(model, solve=replace(model.solve, linear=linear)))
    if not solution.converged:
        raise RuntimeError("not converged")
    taken = tuple(len(step.iterations) for step in solution.steps)
    direct = any("going on with the direct solver" in note for note in solution.notes)
    return Count(taken, time.perf_counter() - clock, direct)


def bounded(worst: list[int]) -> bool:
    """Whether counts, from the coarsest mesh to the finest, are few and do not grow."""
    return max(worst) <= MOST and worst[-1] <= GROWTH * worst[0] + MORE


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--most", type=int, default=400, help="facets of the finest mesh")
    parser.add_argument("--paths", default=",".join(PATHS))
    parser.add_argument("--problems", default="", help="names that begin so; all")
    options = parser.parse_args()
    print("problem | | size | path | solutions of each step | seconds")
    failed = 0
    for own in problems():
        if not own.name.startswith(tuple(options.problems.split(","))):
            continue
        for path in options.paths.split(","):
            worst = []
            for size in (n for n in own.sizes if n <= options.most):
                found = count(own.model(size), path)
                worst.append(max(found.solutions))
                cells = (own.name, own.detail, size, path, "/".join(map(str, found.solutions)), f"{found.seconds:.2f}")
                print(*cells, "(by the direct solver)" if found.direct else "", sep=" | ", flush=True)
            if worst and not bounded(worst):
                failed += 1
                print(f"more than {MOST}, or more than {GROWTH} times the first and {MORE}: {worst}")
    raise SystemExit(1 if failed else 0)


if __name__ == "__main__":
    main()
