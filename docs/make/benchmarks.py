"""Writes the tables of docs/verification/benchmarks.md: python docs/make/benchmarks.py (a few minutes)."""

from __future__ import annotations

from abut.benchmarks import BENCHMARKS, Outcome, run
from page import DOCS, error, write_table

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
    outcomes = [outcome for benchmark in BENCHMARKS.values() for outcome in run(benchmark)]
    header = ["name", "problem", "quantity", "value", "reference", "error", "limit", "rate (theory)"]
    write_table(PAGE, "benchmarks", header, [row(outcome) for outcome in outcomes])
    sources = {}
    for outcome in outcomes:
        sources.setdefault(outcome.reference.source, []).append(outcome.benchmark)
    rows = [[source, ", ".join(f"`{name}`" for name in dict.fromkeys(names))] for source, names in sources.items()]
    write_table(PAGE, "sources", ["source", "used by"], rows)
    failed = [outcome for outcome in outcomes if not outcome.passed]
    print(f"{len(outcomes) - len(failed)} of {len(outcomes)} quantities pass")


if __name__ == "__main__":
    main()
