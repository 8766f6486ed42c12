"""What the certificate says of contacts with known pressures, beside their true errors.

``python bench/certificate/run.py`` takes some of the cases (a few minutes), ``--full`` all of them, ``--part TEXT`` those
whose names contain the text, ``--out FILE`` writes the table as CSV. The summary asks of a certificate that runs with a
true error above 20 % are not green, that those below 3 % neither fail (1 %) nor warn (5 %), and that the
estimate "pressure error" is the true error in the median.
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
    begin = time.perf_counter()
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
        time.perf_counter() - begin,
    )  # fmt: skip


def share(of: Sequence[Outcome], verdict: str) -> str:
    count = sum(one.verdict == verdict for one in of)
    return f"{count} of {len(of)} ({100.0 * count / max(len(of), 1):.1f} %)"


def summary(found: Sequence[Outcome]) -> None:
    wrong, fine = [o for o in found if o.error > WRONG], [o for o in found if o.error < FINE]
    print(f"{len(found)} runs, {sum(o.seconds for o in found):.0f} s")
    print(f"true error above {WRONG:.0%}: green {share(wrong, 'green')}, warned {share(wrong, 'warn')}")
    print(f"true error below {FINE:.0%}: failed {share(fine, 'FAIL')}, warned {share(fine, 'warn')}")
    for degree in (1, 2):
        ratios = [o.estimate / o.error for o in found if o.order == degree and o.error > TELLING and o.estimate >= 0.0]
        if ratios:
            low, middle, high = np.quantile(ratios, (0.1, 0.5, 0.9))
            print(f"order {degree}: estimate over truth {middle:.2f} in the median of {len(ratios)}, "
                  f"{low:.2f} to {high:.2f} of 80 %")  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--full", action="store_true")
    parser.add_argument("--part", default="")
    parser.add_argument("--every", type=int, default=11, help="which share of the cases without --full")
    parser.add_argument("--out")
    asked = parser.parse_args()
    chosen = [case for case in cases() if asked.part in case.name]
    found = []
    for case in chosen if asked.full or asked.part else chosen[:: asked.every]:
        one = outcome(case)
        found.append(one)
        lines = ", ".join((*one.failed, *(f"({name})" for name in one.warned)))
        print(f"{one.error:8.4f} {one.estimate:8.4f} {one.verdict:5s} {one.name}: {lines}", flush=True)
    summary(found)
    if asked.out:
        with open(asked.out, "w", newline="") as file:
            table = csv.writer(file)
            table.writerow(("name", "order", "error", "estimate", "verdict", "failed", "warned"))
            table.writerows(
                (o.name, o.order, o.error, o.estimate, o.verdict, "; ".join(o.failed), "; ".join(o.warned))
                for o in found
            )


if __name__ == "__main__":
    main()
