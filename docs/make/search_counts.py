"""Table of docs/verification/search.md: python docs/make/search_counts.py (about four minutes)."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "bench"))

from search import PATHS, Count, Problem, count, problems

from page import DOCS, write_table

PAGE = DOCS / "verification" / "search.md"
HEADER = ["problem", "cells", "sizes", *PATHS]
TAKEN_OVER = "*"  # after a count: multigrid gave up on the mesh, and the direct solver took over


def cell(found: Count) -> str:
    """The worst load step."""
    return f"{max(found.solutions)}{TAKEN_OVER if found.direct else ''}"


def row(own: Problem) -> list[str]:
    models = [own.model(size) for size in own.sizes]
    counts = [" / ".join(cell(count(model, path)) for model in models) for path in PATHS]
    sizes = " / ".join(map(str, own.sizes)) if len(own.sizes) > 1 else "-"
    line = [own.name, own.detail, sizes, *counts]
    print(*line, sep=" | ", flush=True)
    return line


if __name__ == "__main__":
    write_table(PAGE, "search", HEADER, [row(own) for own in problems()])
