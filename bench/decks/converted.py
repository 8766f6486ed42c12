"""Whether decks and what ``abut convert`` makes of them have the same answer.

python bench/decks/converted.py [FOLDER ...] [--count 40] [--points 600] takes so many decks with static steps that are read
and have no more points, evenly among them in order of their names, solves each and the job file that it becomes, and prints
the largest difference of displacement over the largest displacement, and of modes, or why there is none.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import numpy as np
from cards import plain
from count import decks

import abut
from abut.errors import AbutError
from abut.job import load_job
from abut.job.convert import write_job
from reference import EXAMPLES


def difference(deck: Path, folder: Path) -> float:
    """Of one deck. Raises AbutError for what cannot be written, read again or solved."""
    job = load_job(deck)
    written, _ = write_job(folder / "job.toml", job)
    one, other = (abut.solve(model) for model in (job.model, load_job(written).model))
    scale = max(float(np.abs(one.displacement).max(initial=0.0)), 1e-300)
    worst = float(np.abs(one.displacement - other.displacement).max(initial=0.0)) / scale
    for a, b in zip(one.modes, other.modes, strict=True):
        size = float(np.abs(a.eigenvalues).max(initial=1e-300))
        worst = max(worst, float(np.abs(a.eigenvalues - b.eigenvalues).max(initial=0.0)) / size)
    return worst


def readable(paths: list[Path], points: int) -> list[Path]:
    """Those that are read and small."""
    kept = []
    for path in paths:
        try:
            with plain(path) as text:
                if len(load_job(text).model.mesh.points) <= points:
                    kept.append(path)
        except AbutError:
            continue
    return kept


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", nargs="*", type=Path, default=[EXAMPLES])
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--points", type=int, default=600)
    arguments = parser.parse_args()
    seen: set[str] = set()
    every = readable([p for folder in arguments.folders for p in decks(folder, ["STATIC"], seen)], arguments.points)
    chosen = [every[i] for i in np.unique(np.linspace(0, len(every) - 1, arguments.count).astype(int))]
    for path in chosen:
        with plain(path) as text, tempfile.TemporaryDirectory() as folder:
            try:
                print(f"{path.name:28} {difference(text, Path(folder)):.1e}", flush=True)
            except AbutError as error:
                print(f"{path.name:28} {str(error).splitlines()[0][:150]}", flush=True)


if __name__ == "__main__":
    main()
