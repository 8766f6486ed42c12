"""code_aster's own contact cases, solved by abut and compared with the values that their files test.

python bench/suites/aster.py FOLDER [NAME ...] [--seconds 60] [--table OUT.md]

FOLDER holds command files (.comm) with their meshes (.mmed, .med: pip install h5py; .mail), and .export files where a mesh
has another name, as in code_aster's folder astest. Each case is read without running it; what is not read says why.
Displacements at points (DX, DY, DZ) and contact pressures (LAGS_C) that the file tests are compared: with code_aster's own
values (VALE_CALC) and with the file's references from elsewhere (VALE_REFE). Differences are over the largest value of their
kind in the case.
"""

from __future__ import annotations

import argparse
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from aster_model import PRESSURE, Case, Test, read_case
from foreign_mesh import NotReadable

import abut
from abut.errors import AbutError

SAME_TIME = 1e-6
TINY = 1e-9  # of the largest displacement: values that stand for zero


@dataclass(frozen=True)
class Outcome:
    """A calculation of a case. status: "solved", "stopped" (abut ended before its end) or "not read"; errors: largest
    differences over the largest value, of displacements from code_aster's own values and from references from elsewhere,
    then of pressures, NaN where none is tested; detail: why."""

    name: str
    status: str
    kinematics: str = ""
    contact: str = ""
    iterations: int = 0
    tests: int = 0
    errors: tuple[float, ...] = ()
    detail: str = ""


def measured(case: Case, solution: abut.Solution, test: Test) -> float:
    """What abut has for a test."""
    step = min(solution.steps, key=lambda step: abs(step.factor - test.time))
    if abs(step.factor - test.time) > SAME_TIME:
        return float("nan")
    if test.component != PRESSURE:
        return float(step.displacement[test.point, test.component])
    for contact in step.contacts:
        at = contact.contactor.nodes == test.point
        if at.any():
            return -float(np.nanmean(contact.pressure[at]))
    return float("nan")


def outcome(name: str, case: Case, seconds: float) -> Outcome:
    """Of one calculation."""
    model = replace(case.model, solve=replace(case.model.solve, seconds=seconds))
    contact = ", ".join(sorted({"friction" if c.frictional else c.kind for c in model.contacts}))
    try:
        solution = abut.solve(model)
    except AbutError as reason:
        return Outcome(name, "stopped", model.kinematics, contact, detail=" ".join(str(reason).split())[:150])
    largest = float(np.abs(solution.displacement).max(initial=0.0))
    errors = tuple(
        _error(case, solution, pressure, whose, largest) for pressure in (False, True) for whose in ("own", "reference")
    )
    whole = solution.converged and solution.complete
    return Outcome(
        name, "solved" if whole else "stopped", model.kinematics, contact, sum(len(s.iterations) for s in solution.steps),
        len(case.tests), errors,
        "" if whole else (solution.steps[-1].reason or f"at time {solution.steps[-1].factor:.3g}"),
    )  # fmt: skip


def _error(case: Case, solution: abut.Solution, pressure: bool, whose: str, largest: float) -> float:
    """Of one kind of values; those that are all to be zero are beside the largest displacement."""
    tests = [t for t in case.tests if (t.component == PRESSURE) is pressure and not np.isnan(getattr(t, whose))]
    if not tests:
        return float("nan")
    size = max(abs(getattr(t, whose)) for t in tests)
    if pressure and size == 0.0:
        return float("nan")
    size = size if size > TINY * largest or pressure else largest
    return max(abs(measured(case, solution, t) - getattr(t, whose)) for t in tests) / max(size, 1e-300)


def outcomes(path: Path, seconds: float) -> list[Outcome]:
    """Of all calculations of a command file."""
    try:
        cases = read_case(path)
    except NotReadable as reason:
        return [Outcome(path.stem, "not read", detail=str(reason))]
    except AbutError as reason:
        return [Outcome(path.stem, "not read", detail=" ".join(str(reason).split())[:150])]
    names = [path.stem if len(cases) == 1 else f"{path.stem}/{i + 1}" for i in range(len(cases))]
    return [outcome(name, case, seconds) for name, case in zip(names, cases)]


def row(found: Outcome) -> list[str]:
    """In the columns of a table."""
    errors = found.errors or (float("nan"),) * 4
    numbers = [f"{100 * e:.2g} %" if np.isfinite(e) else "" for e in errors]
    return [
        f"`{found.name}`", found.status, found.kinematics, found.contact, str(found.iterations or ""),
        str(found.tests or ""), *numbers, found.detail,
    ]  # fmt: skip


HEAD = [
    "case", "result", "kinematics", "contact", "iterations", "values", "displacements", "from references", "pressures",
    "from references", "why",
]  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--seconds", type=float, default=60.0, help="for one calculation")
    parser.add_argument("--table", type=Path, help="write what was solved or stopped as a table")
    arguments = parser.parse_args()
    paths = sorted(arguments.folder.glob("*.comm"))
    paths = [p for p in paths if "DEFI_CONTACT" in p.read_text(encoding="latin-1")]
    paths = [p for p in paths if p.stem in arguments.names] if arguments.names else paths
    every: list[Outcome] = []
    for path in paths:
        for found in outcomes(path, arguments.seconds):
            every.append(found)
            print(" | ".join(row(found)), flush=True)
    print(dict(Counter(found.status for found in every)))
    if arguments.table:
        rows = [HEAD, ["---"] * len(HEAD), *(row(f) for f in every if f.status != "not read")]
        arguments.table.write_text("".join(f"| {' | '.join(cells)} |\n" for cells in rows))


if __name__ == "__main__":
    main()
