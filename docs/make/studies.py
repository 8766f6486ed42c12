"""The tables of docs/verification/pressure.md that two studies make: sides, and what the certificate says.

python docs/make/studies.py [PART ...]: parts of bench/sides/study.py, and "certificate"; all by default (an hour on a
core). Rows of parts that are not asked for stay.
"""

from __future__ import annotations

import argparse
import sys

from page import DOCS, read_table, write_table

BENCH = DOCS.parent / "bench"
PAGE = DOCS / "verification" / "pressure.md"


def sides(parts: list[str]) -> None:
    """The rows of some parts."""
    sys.path.insert(0, str(BENCH / "sides"))
    import study

    for part in [name for name in study.PARTS if not parts or name in parts]:
        solid = part in study.LONG
        new = study.summary(part, list(study.rows_of(study.PARTS[part], not solid)))
        old = {row["part"]: [] for row in read_table(PAGE, "sides")}
        for row in read_table(PAGE, "sides"):
            old[row["part"]].append(list(row.values()))
        old[part] = new
        write_table(PAGE, "sides", study.SUMMARY, [row for name in study.PARTS for row in old.get(name, [])])
    for part in [name for name in study.MOVING if not parts or name in parts]:
        write_table(PAGE, f"sides-{part}", *study.MOVING[part]())


def certificate(files: list[str]) -> None:
    """The summaries of bench/certificate/run.py side by side, of its files if given."""
    sys.path.insert(0, str(BENCH / "certificate"))
    import run

    found = [one for path in files for one in run.read(path)] or [run.outcome(case) for case in run.chosen()]
    parts = run.halves(found)
    columns = [dict(run.summary(part)) for part in parts.values()]
    rows = [[name, *(column.get(name, "-") for column in columns)] for name in columns[-1]]
    write_table(PAGE, "certificate", ["", *parts], rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*")
    parser.add_argument(
        "--files", nargs="+", default=[], help="CSV files of bench/certificate/run.py, read in place of runs"
    )
    asked = parser.parse_args()
    parts = asked.parts
    if not parts or set(parts) - {"certificate"}:
        sides(parts)
    if not parts or "certificate" in parts:
        certificate(asked.files)


if __name__ == "__main__":
    main()
