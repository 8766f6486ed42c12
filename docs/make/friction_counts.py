"""Table "friction" of docs/verification/search.md: python docs/make/friction_counts.py (about four minutes)."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests"))

import abut
from models.parts_rubbing import PARTS
from models.search import ball, beam, layer, line, pin, solid_beam
from page import DOCS, write_table

PAGE = DOCS / "verification" / "search.md"
COEFFICIENTS = (0.0, 0.15, 0.5)
HEADER = ["problem", "cells", "sizes", *("without" if not own else f"friction {own:g}" for own in COEFFICIENTS)]
Models = dict[tuple[str, str], tuple[tuple[int, ...], Callable[[int], abut.Model]]]


def models() -> Models:
    """By name and cells; sizes of the mesh, none for parts."""
    return {
        ("beam", "quad4"): ((50, 100, 200), lambda n: beam(n, "quad4")),
        ("beam", "quad8"): ((50, 100), lambda n: beam(n, "quad8")),
        ("beam in space", "hex8"): ((25, 50), lambda n: solid_beam(n, "hex8")),
        ("ball", "quad4"): ((48, 96, 192), ball),
        ("layer", "quad4"): ((50, 100, 200), lambda n: layer(n, "quad4")),
        ("layer", "quad8"): ((50, 100), lambda n: layer(n, "quad8")),
        ("cylinder", "quad8"): ((10, 20, 40), lambda n: line(n, "quad8")),
        ("cylinder", "tri6"): ((10, 20), lambda n: line(n, "tri6")),
        ("loose pin", "force 0.05"): ((12, 24), lambda n: pin(n, 0.05)),
        ("loose pin", "force 5"): ((12, 24), lambda n: pin(n, 5.0)),
        **{(name, "part"): ((0,), lambda _, build=build: build()) for name, build in PARTS.items()},
    }


def iterations(model: abut.Model, friction: float) -> int:
    """In the worst load step."""
    contacts = [replace(own, friction=friction) for own in model.contacts]
    solution = abut.solve(replace(model, contacts=contacts))
    assert solution.converged
    return max(len(step.iterations) for step in solution.steps)


def rows() -> list[list[str]]:
    result = []
    for (name, detail), (sizes, build) in models().items():
        counts = [" / ".join(str(iterations(build(n), own)) for n in sizes) for own in COEFFICIENTS]
        result.append([name, detail, " / ".join(map(str, sizes)) if len(sizes) > 1 else "-", *counts])
        print(*result[-1], sep=" | ", flush=True)
    return result


if __name__ == "__main__":
    write_table(PAGE, "friction", HEADER, rows())
