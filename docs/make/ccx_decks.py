"""abut beside CalculiX on the contact decks of CalculiX's own tests.

python docs/make/ccx_decks.py [NAME ...] prints a line for each deck; with --page it writes their rows in the table of
docs/verification/decks.md (all decks: about 12 minutes on one idle core). Needs CalculiX and its tests: apt install
calculix-ccx calculix-ccx-test.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from page import DOCS, read_table, write_table

sys.path.insert(0, str(DOCS.parent / "bench" / "decks"))
from compare import Outcome, compare, line

from reference import EXAMPLES, decks

PAGE = DOCS / "verification" / "decks.md"
HEADER = [
    "deck", "elements", "result", "largest displacement", "largest difference", "deck's slave as contactor",
    "contact in CalculiX", "without", "remark",
]  # fmt: skip
STATUSES = ("agrees", "differs", "refused", "no reference", "failed")


def row(outcome: Outcome) -> list[str]:
    """An outcome in the columns of the page."""
    solved = outcome.status in ("agrees", "differs")
    return [
        f"`{outcome.name}`", outcome.cells, outcome.status, f"{outcome.largest:.4g}" if outcome.largest else "",
        f"{100 * outcome.difference:.2g} %" if solved else "",
        f"{100 * outcome.slave:.2g} %" if outcome.slave == outcome.slave else "",
        (outcome.kind.lower() or "as in the deck") if solved else "",
        ", ".join(outcome.ignored), "; ".join(text for text in (REMARKS.get(outcome.name, ""), outcome.detail) if text),
    ]  # fmt: skip


# Why the two differ, where they do.
REMARKS = {
    "bolt": "meshes at the contact: the plates touch along half an edge, the slave nodes of the head end in the middle of "
    "one; with these edges whole 2.1 %, and the plates' elements cut into four once and twice 1.15 and 1.03 %",
    "beamcontact": "a coarse beam turns about the edges of two narrow stops: the pressure stands on a part of a facet; "
    "refined below",
    "changesurfbeh": "glued in the first step, in the second one in contact",
    "contact11": "one element under pressure, held sideways: its upper side comes 100 x 0.2 / 210000 = 9.52e-5 closer to "
    "its lower one, in abut everywhere, in CalculiX with the deck's penalty by 8.7 to 9.5e-5",
    "contact2": "in the second of three steps; the pressure space: P2, with dual-P1 0.41 %",
    "cubespring": "the side that carries the pressure: with that of CalculiX both agree",
    "fricloop": "one facet on another, pressed in the first step: friction at its four corners, where abut has it, holds it "
    "from widening more than friction all over it; see below",
    "friction1": "as cubespring",
    "friction2": "in the first step, as fricloop: one facet slips outwards all round. CalculiX's friction is a force "
    "at each corner (so it is with dual-P1: 6.22568e-5 both); abut's traction varies over the facet, and "
    "a third of that is left at the corners (8.26830e-5); 0.001 % in the three steps after, in which it "
    "slides",
    "punch1": "a round punch, three facets wide: pressure up to the edge of facets whose neighbours are open; refined below",
    "punch2": "as punch1",
    "thread": "a nut on a flange, pressed over facets that the edge of the contact divides; abut's own pressure spaces "
    "differ by 1.4 % (P2 from dual-P1) and 2.1 % (P1). The tied faces look the same way, and are tied node by node as "
    "in CalculiX",
    "scheibe2n2f": "node to surface; nothing varies along z, but CalculiX's displacements differ by 3 % between z = 0 and "
    "z = 0.25, abut's do not, nor do CalculiX's with surface to surface (scheibe2f2f)",
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--folder", type=Path, default=EXAMPLES, help="the decks, .inp or .inp.gz")
    parser.add_argument("--limit", type=float, default=600.0, help="seconds for one run of CalculiX")
    parser.add_argument("--page", action="store_true", help="write the table of the page")
    arguments = parser.parse_args()
    found = decks(arguments.folder)
    if not found:
        raise SystemExit(f"no contact decks in {arguments.folder}: apt install calculix-ccx-test, or give --folder")
    outcomes = []
    for name in arguments.names or found:
        outcomes.append(compare(name, found[name], arguments.limit))
        print(line(outcomes[-1]), flush=True)
    count = sum(outcome.status == "agrees" for outcome in outcomes)
    print(f"{count} of {len(outcomes)} decks agree")
    if arguments.page:
        renew({outcome.name: row(outcome) for outcome in outcomes})


def renew(rows: dict[str, list[str]]) -> None:
    """Put rows in place of those of the same decks, and count anew."""
    kept = {line["deck"].strip("`"): list(line.values()) for line in read_table(PAGE, "decks")}
    lines = [line for _, line in sorted((kept | rows).items())]
    write_table(PAGE, "decks", HEADER, lines)
    counts = [[status, str(sum(line[2] == status for line in lines))] for status in STATUSES]
    write_table(PAGE, "counts", ["result", "decks"], counts)


if __name__ == "__main__":
    main()
