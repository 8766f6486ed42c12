"""Which decks of a folder abut reads, and why it refuses the others: on a short list, each with its cure.

python bench/decks/count.py [--folder FOLDER] [--names] counts CalculiX's own tests (Debian: apt install calculix-ccx-test);
nothing is solved. A deck that is refused for several reasons counts once, for the first of the list that it meets.
"""

from __future__ import annotations

import argparse
import re
from pathlib import Path

from cards import plain

from abut.decks.translation import load_deck
from abut.errors import AbutError
from reference import EXAMPLES

# Words of a message, why, and what to do
REASONS = (
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
        "frequencies and buckling but of one step, or the last, with the nodal diameter 0",
        "the step in a deck of its own",
    ),
    (
        r"SHELL|BEAM GENERAL|BEAM SECTION|SECTION=|beam and a shell|MEMBRANE|shells and beams|"
        r"reference of a rigid body.*comes|PRE-TENSION SECTION: ELEMENT",
        "shells and beams: layers, other sections, what they share",
        "solids there, or the section by its rectangle",
    ),
    (r"HYPERFOAM|DEFORMATION PLASTICITY|incompressible", "other materials", "`*PLASTIC`, `*HYPERELASTIC` with D1 > 0"),
    (r"\*MPC", "nonlinear `*MPC`", "`*EQUATION`, `*COUPLING`, or small displacements"),
    (r"two of them together", "plane stress and axisymmetry in one deck", "one of the two"),
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
    (r"GAP", "gap elements", "`*CONTACT PAIR`"),
    (r"no \*ELEMENT cards|every body is rigid", "nothing that deforms", "add a body that does"),
    (r"no procedure", "no step that solves", "add `*STATIC`"),
    (r"different thickness", "plane elements of several thicknesses", "a deck for each, or solids"),
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


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, default=EXAMPLES)
    parser.add_argument("--names", action="store_true", help="the names of the decks, too")
    arguments = parser.parse_args()
    found: dict[str, list[str]] = {}
    for path in sorted([*arguments.folder.glob("*.inp"), *arguments.folder.glob("*.inp.gz")]):
        found.setdefault(read(path), []).append(path.name.split(".inp")[0])
    print(f"{sum(map(len, found.values()))} decks, {len(found.pop('', []))} read")
    cures = {why: cure for _, why, cure in REASONS}
    for why, names in sorted(found.items(), key=lambda item: -len(item[1])):
        print(f"| {len(names)} | {why} | {cures.get(why, '')} |", *(names if arguments.names else []))


if __name__ == "__main__":
    main()
