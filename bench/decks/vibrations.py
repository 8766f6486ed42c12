"""Modes and vibrations of decks in abut and CalculiX: frequencies or buckling loads, and displacements that are printed.

python bench/decks/vibrations.py NAME [...] [--folder FOLDER] [--modes N] [--full] prints a line for each of CalculiX's own
tests named (Debian: apt install calculix-ccx calculix-ccx-test), solved as it is in both: the largest relative difference of
the modes asked for, and of `*NODE PRINT` after `*STEADY STATE DYNAMICS` and `*MODAL DYNAMIC` the largest difference at all
times or frequencies over the largest displacement. --modes: that many modes in both; --full: C3D20 and S8 in place of C3D20R
and S8R in both, as CalculiX integrates the mass of these with the reduced rule.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from cards import Card, read, write
from numpy.typing import NDArray

import abut
from abut.errors import AbutError
from abut.job import load_job
from reference import EXAMPLES

Rows = dict[float, list[NDArray[np.float64]]]  # by time or frequency: tables, the second of which is the imaginary part
FULL = {"C3D20R": "C3D20", "S8R": "S8"}


def altered(cards: Sequence[Card], count: int | None, full: bool) -> list[Card]:
    """The deck with another number of modes, and with full integration."""
    result = []
    for card in cards:
        if card.name == "FREQUENCY" and count is not None:
            card = replace(card, data=(f"{count}",))
        if card.name == "ELEMENT" and full:
            kind = card.options["TYPE"].upper()
            card = replace(card, options={**card.options, "TYPE": FULL.get(kind, kind)})
        result.append(card)
    return result


def modes_printed(text: str) -> list[list[float]]:
    """Frequencies (cycles per time) or buckling factors of every table of a .dat file."""
    tables: list[list[float]] = []
    column = None
    for line in text.splitlines():
        if "E I G E N V A L U E   O U T P U T" in line or "B U C K L I N G   F A C T O R" in line:
            tables.append([])
            column = -2 if "E I G E N" in line else -1
        elif "P A R T I C" in line or "displacements" in line:
            column = None
        values = line.split()
        if column is not None and len(values) >= 2 and all(re.match(r"-?\d", value) for value in values):
            tables[-1].append(float(values[column]))
    return tables


def printed(text: str) -> dict[str, Rows]:
    """Displacements of a .dat file, by set (in capitals): (nodes, 3) tables."""
    found: dict[str, Rows] = {}
    rows: list[list[float]] | None = None
    tables: list[tuple[str, float, list[list[float]]]] = []
    for line in text.splitlines():
        head = re.match(r" displacements \(vx,vy,vz\) for set (\S+) and time\s+(\S+)", line)
        values = line.split()
        if head:
            rows = []
            tables.append((head[1].upper(), float(head[2]), rows))
        elif rows is not None and len(values) == 4:
            rows.append([float(value) for value in values[1:]])
        elif values:
            rows = None
    for name, at, table in tables:
        found.setdefault(name, {}).setdefault(at, []).append(np.array(table))
    return found


def apart(result: abut.solution.responses.ResponseResult, found: dict[str, Rows]) -> float:
    """The largest difference of printed displacements over the largest displacement."""
    worst = 0.0
    for probe in result.probes:
        rows = next((rows for name, rows in found.items() if name.lower() in probe.name.lower()), {})
        largest = max((float(np.abs(table).max()) for tables in rows.values() for table in tables), default=0.0)
        for at, tables in rows.items():
            mine = probe.displacement[int(np.abs(result.at - at).argmin())]
            for part, table in zip((mine.real, mine.imag), tables, strict=False):
                worst = max(worst, float(np.abs(part - table[:, : part.shape[1]]).max()) / largest)
    return worst


def compare(name: str, path: Path, count: int | None, full: bool) -> str:
    """A line about one deck."""
    with tempfile.TemporaryDirectory() as folder:
        deck = Path(folder) / "deck.inp"
        write(altered(read(path), count, full), deck)
        try:
            solution = abut.solve(load_job(deck).model)
        except AbutError as error:
            return f"{name}: {type(error).__name__}: {str(error).splitlines()[0].replace(str(deck), name)}"
        subprocess.run(["ccx", "deck"], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        text = deck.with_suffix(".dat").read_text(encoding="latin-1")
    words = []
    for mine, theirs in zip(solution.modes, modes_printed(text), strict=False):
        n = min(len(mine.values), len(theirs))
        other = np.array(theirs[:n])
        words.append(f"{n} {mine.words} {np.abs(mine.values[:n] / other - 1.0).max():.3%}")
    found = printed(text)
    for response in solution.responses:
        words.append(f"{response.kind}, {len(response.at)} points, {apart(response, found):.3%}")
    return f"{name}: {'; '.join(words)}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="+")
    parser.add_argument("--folder", type=Path, default=EXAMPLES)
    parser.add_argument("--modes", type=int)
    parser.add_argument("--full", action="store_true")
    arguments = parser.parse_args()
    for name in arguments.names:
        path = next(
            arguments.folder / f"{name}{end}"
            for end in (".inp", ".inp.gz")
            if (arguments.folder / f"{name}{end}").exists()
        )
        print(compare(name, path, arguments.modes, arguments.full), flush=True)


if __name__ == "__main__":
    main()
