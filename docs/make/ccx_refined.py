"""Decks on which abut and CalculiX differ, on finer meshes: who is right on the coarse one.

python docs/make/ccx_refined.py [NAME ...] [--levels N] prints a line for each mesh and kind of contact; with --page it
writes the table of docs/verification/decks.md. Needs CalculiX and its tests, as ccx_decks.py does.
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from page import DOCS, write_table

sys.path.insert(0, str(DOCS.parent / "bench" / "decks"))
from cards import Card, read, write
from compare import cells
from frd import Displacements
from refine import adjusted, refine

import abut
from abut.decks.translation import translate
from abut.errors import AbutError
from abut.io.deck import read_deck
from reference import EXAMPLES, NoReference, decks, reference

PAGE = DOCS / "verification" / "decks.md"
NAMES = ("beamcontact", "contact4", "punch1")
IGNORED = ("NLGEOM", "MODEL CHANGE")
ABUT = {
    "dual-P1": {"pressure": "dual-P1"},
    "P1": {"pressure": "P1"},
    "P2": {"pressure": "P2"},
    "constraint function": {"law": "constraint-function"},
}
CCX = {"CalculiX, penalty": "", "CalculiX, mortar": "MORTAR"}
MOST = {"CalculiX, penalty": 5000, "CalculiX, mortar": 5000}  # elements
HEADER = ["deck", "elements", *ABUT, *CCX]


def solve(path: Path, contact: dict[str, str]) -> Displacements:
    """abut's displacements at the end of a deck."""
    deck = read_deck(path, list(IGNORED))
    model = translate(deck).model
    model = replace(model, contacts=[replace(c, **contact) for c in model.contacts])  # type: ignore[arg-type]
    solution = abut.solve(model)
    if not solution.converged:
        raise AbutError("not converged")
    numbers = np.intersect1d(deck.nodes, np.concatenate([block.nodes.ravel() for block in deck.blocks]))
    return dict(zip(numbers.tolist(), solution.steps[-1].displacement))


def compared(cards: list[Card]) -> list[int]:
    """Nodes of the deck, without those of elements on which a force acts at a point."""
    loaded = {int(line.split(",")[0]) for card in cards if card.name == "CLOAD" for line in card.data}
    near: set[int] = set()
    every: set[int] = set()
    for card in cards:
        if card.name == "ELEMENT":
            width = 21 if "20" in card.options["TYPE"] else 9
            numbers = [int(x) for line in card.data for x in line.split(",") if x.strip()]
            for i in range(0, len(numbers), width):
                own = set(numbers[i + 1 : i + width])
                every |= own
                near |= own if own & loaded else set()
    return sorted(every - near)


def level(cards: list[Card], limit: float) -> dict[str, Displacements | str]:
    """Displacements of one mesh by every way, or why there are none."""
    result: dict[str, Displacements | str] = {}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "deck.inp"
        write(cards, path)
        for name, contact in ABUT.items():
            start = time.perf_counter()
            try:
                result[name] = solve(path, contact)
            except AbutError as reason:
                result[name] = str(reason)
            print(f"    {name}: {time.perf_counter() - start:.0f} s", flush=True)
        for name, kind in CCX.items():
            if sum(map(int, re.findall(r"(\d+) C3D", cells(cards)))) > MOST[name]:
                result[name] = "not run"
                continue
            start = time.perf_counter()
            try:
                result[name] = reference(path, IGNORED, limit, kind).steps[-1]
            except NoReference as reason:
                result[name] = str(reason)
            print(f"    {name}: {time.perf_counter() - start:.0f} s", flush=True)
    return result


def rows(name: str, path: Path, levels: int, limit: float) -> list[list[str]]:
    """One deck, coarse to fine: largest differences from the finest dual-P1, over its largest displacement."""
    cards = adjusted(read(path))
    at = compared(cards)
    found, sizes = [], []
    for k in range(levels + 1):
        cards = refine(cards) if k else cards
        sizes.append(cells(cards))
        print(f"  {name}: {sizes[-1]}", flush=True)
        found.append(level(cards, limit))
    best = found[-1]["dual-P1"]
    if isinstance(best, str):
        raise SystemExit(f"{name}: no finest solution: {best}")
    scale = max(float(np.linalg.norm(best[n])) for n in at)
    table = []
    for size, own in zip(sizes, found):
        line = [f"`{name}`", size]
        for way in HEADER[2:]:
            u = own[way]
            if isinstance(u, str):
                print(f"    {size}, {way}: {u}", flush=True)
                line.append("-")
            else:
                line.append(f"{100 * max(float(np.linalg.norm(u[n] - best[n])) for n in at) / scale:.2g} %")
        table.append(line)
        print(*line, sep=" | ", flush=True)
    return table


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", default=NAMES)
    parser.add_argument("--folder", type=Path, default=EXAMPLES, help="the decks, .inp or .inp.gz")
    parser.add_argument("--levels", type=int, default=2, help="how often cells are halved")
    parser.add_argument("--limit", type=float, default=600.0, help="seconds for one run of CalculiX")
    parser.add_argument("--page", action="store_true", help="write the table of the page")
    arguments = parser.parse_args()
    found = decks(arguments.folder)
    table = [line for name in arguments.names for line in rows(name, found[name], arguments.levels, arguments.limit)]
    if arguments.page:
        write_table(PAGE, "refined", HEADER, table)


if __name__ == "__main__":
    main()
