"""Writes the tables of docs/verification/benchmarks.md: python docs/make/benchmarks.py (a few minutes); or the rows of some
benchmarks: python docs/make/benchmarks.py NAME ..."""

from __future__ import annotations

import argparse

from abut.benchmarks import BENCHMARKS, Outcome, run
from page import DOCS, error, read_table, write_table

PAGE = DOCS / "verification" / "benchmarks.md"


def row(outcome: Outcome) -> list[str]:
    """One quantity in the columns of the page."""
    reference, title = outcome.reference, BENCHMARKS[outcome.benchmark].title
    rate = "" if outcome.rate is None or reference.rate is None else f"{outcome.rate:.2f} ({reference.rate:g})"
    value = f"{outcome.values[-1]:.6g}" if reference.value else ""
    wanted = f"{reference.value:.6g}" if reference.value else "0"
    return [
        f"`{outcome.benchmark}`", title, outcome.quantity, value, wanted, error(outcome.error),
        f"{reference.tolerance:.2g}", rate,
    ]  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help="benchmarks to run; left out: all, else other rows stay"
    )
    chosen = parser.parse_args().names or list(BENCHMARKS)
    outcomes = [outcome for name in chosen for outcome in run(BENCHMARKS[name])]
    header = ["name", "problem", "quantity", "value", "reference", "error", "limit", "rate (theory)"]
    of_name: dict[str, list[list[str]]] = {}
    for line in read_table(PAGE, "benchmarks"):
        of_name.setdefault(line["name"].strip("`"), []).append(list(line.values()))
    of_name |= {name: [row(outcome) for outcome in outcomes if outcome.benchmark == name] for name in chosen}
    write_table(PAGE, "benchmarks", header, [line for name in BENCHMARKS for line in of_name.get(name, [])])
    sources: dict[str, list[str]] = {}
    for name, benchmark in BENCHMARKS.items():
        for reference in benchmark.references.values():
            sources.setdefault(reference.source, []).append(name)
    rows = [[source, ", ".join(f"`{name}`" for name in dict.fromkeys(names))] for source, names in sources.items()]
    write_table(PAGE, "sources", ["source", "used by"], rows)
    failed = [outcome for outcome in outcomes if not outcome.passed]
    print(f"{len(outcomes) - len(failed)} of {len(outcomes)} quantities pass")


if __name__ == "__main__":
    main()
