"""What the certificate says of contacts with known pressures, beside their true errors.

``python bench/certificate/run.py`` takes 1 716 cases (six minutes of processor time), in shares that may run at once with
``--share K N --out FILE`` (then ``--sum FILES``). The summary asks of a certificate that runs with a true error above
20 % are not green, that those below 3 % neither fail (1 %) nor warn (5 %), and that the estimate "pressure error" is
the true error in the median: of all runs, and apart of the half by which the estimate was tuned, and of the other one.
"""

from __future__ import annotations

import argparse
import csv
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from cases import Case, cases, true_error

import abut

WRONG, FINE = 0.2, 0.03
OF_CELLS = "stress error"  # a line about stresses, not about the pressure
OF_LARGEST = "largest pressure"
TELLING = 0.01  # true error from which on an estimate is compared with it


@dataclass(frozen=True)
class Outcome:
    """error: true one; estimate: the line "pressure error", NaN where it is unknown; failed, warned: names of lines."""

    name: str
    order: int
    error: float
    estimate: float
    failed: tuple[str, ...]
    warned: tuple[str, ...]
    seconds: float

    @property
    def verdict(self) -> str:
        return "FAIL" if self.failed else "warn" if self.warned else "green"


def outcome(case: Case) -> Outcome:
    begin = time.process_time()
    try:
        solution = abut.solve(case.model())
    except abut.AbutError as reason:
        return Outcome(case.name, case.order, np.inf, np.nan, (f"refused: {str(reason)[:60]}",), (), 0.0)
    lines = solution.certificate
    failed = () if solution.converged else ("no convergence",)
    return Outcome(
        case.name, case.order, true_error(case, solution), next(c.value for c in lines if c.name == "pressure error"),
        (*failed, *(c.name for c in lines if not c.passed)),
        tuple(c.name for c in lines if c.name != OF_CELLS and (c.warns or (c.name == "pressure error" and c.unknown))),
        time.process_time() - begin,
    )  # fmt: skip


def share(of: Sequence[Outcome], verdict: str) -> str:
    count = sum(one.verdict == verdict for one in of)
    return f"{count} of {len(of)} ({100.0 * count / max(len(of), 1):.1f} %)"


def summary(found: Sequence[Outcome]) -> list[list[str]]:
    """What runs, errors and verdicts come to, in rows of two."""
    wrong, fine = [o for o in found if o.error > WRONG], [o for o in found if o.error < FINE]
    rows = [
        ["runs", str(len(found))],
        [f"true error above {WRONG:.0%}: green", share(wrong, "green")],
        ["with a warning only", share(wrong, "warn")],
        [f"true error below {FINE:.0%}: fails", share(fine, "FAIL")],
        ["warns", share(fine, "warn")],
        ["of these only that the largest pressure is none, where the exact one has no bound", str(unbounded(fine))],
    ]
    for degree, name in ((1, "first"), (2, "second")):
        ratios = [o.estimate / o.error for o in found if o.order == degree and o.error > TELLING and o.estimate >= 0.0]
        if ratios:
            low, middle, high = np.quantile(ratios, (0.1, 0.5, 0.9))
            text = f"{middle:.2f} in the median of {len(ratios)}, {low:.2f} to {high:.2f} of 80 %"
            rows.append([f"estimate over true error above {TELLING:.0%}, {name} order", text])
    return rows


def unbounded(found: Sequence[Outcome]) -> int:
    """How many warn of nothing but the largest pressure, which is right at a sharp edge."""
    sharp = {case.name for case in cases() if not case.bounded}
    return sum(o.verdict == "warn" and o.warned == (OF_LARGEST,) and o.name in sharp for o in found)


def halves(found: Sequence[Outcome]) -> dict[str, list[Outcome]]:
    """Runs of the half by which the estimate was tuned, of the other one, and all of them, by what they are called."""
    tuned = {case.name for case in chosen(2)}
    return {
        "tuned by": [one for one in found if one.name in tuned],
        "others": [one for one in found if one.name not in tuned],
        "all": list(found),
    }


def chosen(every: int = 1, part: str = "") -> list[Case]:
    """One of so many cases, taken at random but always the same ones; of these those whose names contain the text."""
    every_case = list(cases())
    some = np.sort(np.random.default_rng(27).permutation(len(every_case))[: len(every_case) // every])
    return [every_case[i] for i in some if part in every_case[i].name]


def read(path: str) -> list[Outcome]:
    """What ``--out`` has written."""
    with open(path, newline="") as file:
        return [
            Outcome(
                row["name"], int(row["order"]), float(row["error"]), float(row["estimate"]),
                *(tuple(filter(None, row[key].split("; "))) for key in ("failed", "warned")), float(row["seconds"]),
            )
            for row in csv.DictReader(file)
        ]  # fmt: skip


def write(path: str, found: Sequence[Outcome]) -> None:
    """A table of all runs."""
    with open(path, "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(("name", "order", "error", "estimate", "verdict", "failed", "warned", "seconds"))
        table.writerows(
            (o.name, o.order, o.error, o.estimate, o.verdict, "; ".join(o.failed), "; ".join(o.warned), o.seconds)
            for o in found
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--every", type=int, default=1, help="one of so many cases: 2 takes those by which it was tuned"
    )
    parser.add_argument("--part", default="", help="only cases whose names contain this")
    parser.add_argument(
        "--share", type=int, nargs=2, default=(0, 1), metavar=("K", "N"), help="the K-th of N shares, from 0"
    )
    parser.add_argument("--out", help="a CSV file of the runs")
    parser.add_argument("--sum", nargs="+", metavar="CSV", help="sum up such files, and solve nothing")
    asked = parser.parse_args()
    found = [one for path in asked.sum or () for one in read(path)]
    for case in [] if asked.sum else chosen(asked.every, asked.part)[asked.share[0] :: asked.share[1]]:
        one = outcome(case)
        found.append(one)
        lines = ", ".join((*one.failed, *(f"({name})" for name in one.warned)))
        print(f"{one.error:8.4f} {one.estimate:8.4f} {one.verdict:5s} {one.name}: {lines}", flush=True)
    print(f"{sum(o.seconds for o in found):.0f} s")
    for name, part in halves(found).items():
        print(name)
        for row in summary(part):
            print("   ", "  ".join(row))
    if asked.out:
        write(asked.out, found)


if __name__ == "__main__":
    main()
