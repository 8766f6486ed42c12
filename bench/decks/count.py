"""Which decks of folders abut reads, and why it refuses the others: on a short list, each with its cure.

python bench/decks/count.py [FOLDER ...] [--having CARD ...] [--names] looks into folders below, too; without any it counts
CalculiX's own tests (Debian: apt install calculix-ccx-test). --having STATIC "CONTACT PAIR": decks with one of these cards
alone. Nothing is solved. The same text counts once, in the first folder that has it; a deck that is refused for several
reasons counts once, for the first of the list that it meets.
"""

from __future__ import annotations

import argparse
import gzip
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from cards import plain

from abut.decks.translation import load_deck
from abut.errors import AbutError
from reference import EXAMPLES

# Words of a message, why, and what to do
REASONS = (
    (r"included file .* does not exist", "parts that are not there", "write the files that `*INCLUDE` names"),
    (
        r"P\dNP|FLUID|\bCFD|network and fluid|MASSFLOW|SPECIFIC GAS|direction: expected a whole number > 0, got '0'",
        "flow of fluids and in networks",
        "give its pressures by `*DLOAD`, its temperatures by `*TEMPERATURE`",
    ),
    (r"ELECTROMAGNETICS", "electromagnetics", "give its forces by `*CLOAD`"),
    (r"HEAT TRANSFER|TEMPERATURE-DISPLACEMENT", "heat transfer", "give the temperatures by `*TEMPERATURE`"),
    (r"SENSITIVITY|DESIGN", "optimisation", "change the design from run to run (`abut sweep`)"),
    (r"USER MATERIAL|USER:|\bUSER\b.*subroutine", "user subroutines", "give a material that abut has, or numbers"),
    (r"VISCO|CREEP", "creep", "`*STATIC` for what happens before time counts"),
    (
        r"DYNAMIC|DASHPOT|TYPE=VELOCITY|a data line before the first card",
        "dynamics: in time, modal, steady state",
        "`*FREQUENCY` alone for the modes, `*STATIC` with the largest forces",
    ),
    (
        r"FREQUENCY|BUCKLE|MULTISTAGE",
        "frequencies with loads in their step or limits, with forces of a flow, multistage",
        "the step in a deck of its own",
    ),
    (
        r"SHELL|BEAM GENERAL|BEAM SECTION|SECTION=|beam and a shell|MEMBRANE|shells and beams|"
        r"reference of a rigid body.*comes|PRE-TENSION SECTION: ELEMENT",
        "shells and beams: other sections, what they share",
        "solids there, or the section by its rectangle",
    ),
    (r"HYPERFOAM|DEFORMATION PLASTICITY|incompressible", "other materials", "`*PLASTIC`, `*HYPERELASTIC` with D1 > 0"),
    (r"CYCLIC", "sides of a sector that are meshed unlike", "mesh both sides alike"),
    (r"REFINE", "refinement of the mesh", "refine it in the preprocessor"),
    (r"\*MPC", "nonlinear `*MPC`", "`*EQUATION`, `*COUPLING`, or small displacements"),
    (r"TRANSFORM", "axes of cylindrical coordinates on their axis", "leave the nodes on the axis out"),
    (
        r"INITIAL CONDITIONS|RESTART|SUBMODEL",
        "states of elsewhere: initial stress and strain, restart, submodel",
        "put the steps before these, or give displacements",
    ),
    (
        r"MODEL CHANGE|CHANGE SOLID|CHANGE SURFACE",
        "elements, materials and contact laws that change",
        "a deck for each state",
    ),
    (r"SUBSTRUCTURE|GREEN", "substructures", "the whole model"),
    (r"stand inside a step", "cards of a step outside of one", "`*STEP` before them"),
    (r"no \*ELEMENT cards|every body is rigid", "nothing that deforms", "add a body that does"),
    (r"no procedure", "no step that solves", "add `*STATIC`"),
)


def read(path: Path) -> str:
    """Why a deck is refused, "" for one that is read."""
    try:
        with plain(path) as text:
            load_deck(text)
    except AbutError as error:
        message = str(error)
        return next(
            (why for words, why, _ in REASONS if re.search(words, message)), f"other: {message.splitlines()[0]}"
        )
    return ""


def decks(folder: Path, having: Sequence[str], seen: set[str]) -> Iterator[Path]:
    """Decks below a folder that have one of the cards, or any where none is named, and whose text is not in ``seen`` yet,
    which grows by it. Comments, blanks and capitals make no other text."""
    cards = re.compile(
        rf"^\*({'|'.join(re.sub(' ', ' *', name) for name in having)}) *(,|$)", re.IGNORECASE | re.MULTILINE
    )
    for path in sorted(path for path in folder.rglob("*") if re.search(r"\.inp(\.gz)?$", path.name, re.IGNORECASE)):
        text = (gzip.decompress(path.read_bytes()) if path.suffix == ".gz" else path.read_bytes()).decode("latin-1")
        plainly = re.sub(r"\s+", "", re.sub(r"^\*\*.*$", "", text, flags=re.MULTILINE)).lower()
        if (having and not cards.search(text.replace("\r", ""))) or plainly in seen:
            continue
        seen.add(plainly)
        yield path


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", nargs="*", type=Path, default=[EXAMPLES])
    parser.add_argument("--having", nargs="+", default=[], help="cards of which a deck has at least one")
    parser.add_argument("--names", action="store_true", help="the names of the decks, too")
    arguments = parser.parse_args()
    every: dict[str, list[str]] = {}
    seen: set[str] = set()
    for folder in arguments.folders:
        found: dict[str, list[str]] = {}
        for path in decks(folder, arguments.having, seen):
            found.setdefault(read(path), []).append(re.split(r"\.inp", path.name, flags=re.IGNORECASE)[0])
        print(f"{folder}: {sum(map(len, found.values()))} decks, {len(found.get('', []))} read", flush=True)
        for why, names in found.items():
            every.setdefault(why, []).extend(names)
    print(
        f"{sum(map(len, every.values()))} decks, {len(every.pop('', []))} read, {sum(map(len, every.values()))} refused"
    )
    cures = {why: cure for _, why, cure in REASONS}
    for why, names in sorted(every.items(), key=lambda item: -len(item[1])):
        print(f"| {len(names)} | {why} | {cures.get(why, '')} |", *(names if arguments.names else []))


if __name__ == "__main__":
    main()
