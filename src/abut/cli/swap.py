"""abut verify JOB --swap: the second opinion on a job's contact pressures."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING

from abut.cli.terminal import show

if TYPE_CHECKING:
    from abut.job import Job
    from abut.types import Json
    from abut.verify.swap import Comparison, Swap

DONE, FAILED = 0, 1
HEAD = ("contact", "", "as it is", "sides swapped", "difference")


def verify_swap(arguments: argparse.Namespace, job: Job) -> int:
    """Solve the job and its mirror image, print both and write the report. Returns the exit status."""
    from abut.verify.swap import swap

    tell = (lambda _: None) if arguments.json else (lambda text: show(f"{text} ...", flush=True))
    found = swap(job.model, tell)
    path = _report(found, job, arguments.output or job.directory / "swap")
    if arguments.json:
        show(json.dumps(_plain(found), indent=2))
        return DONE if found.passed else FAILED
    table = rows(found)
    widths = [max(map(len, column)) for column in zip(*table)]
    for row in table:
        show("  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip())
    for name, why in found.left.items():
        show(f"contact '{name}' stays as it is: {why}")
    show(_verdict(found))
    show(f"report: {path}")
    return DONE if found.passed else FAILED


def rows(found: Swap) -> list[tuple[str, ...]]:
    """A table of what was compared, its head first."""
    return [HEAD, *(row for each in found.comparisons for row in _rows(each))]


def _rows(each: Comparison) -> list[tuple[str, ...]]:
    from abut.report.contact_words import number, vector
    from abut.verify.swap import FORCE, LIMIT

    size = max(abs(f).max() for f in each.force)
    forces = [vector(force, size) for force in each.force]
    change = abs(each.pressure[1] - each.pressure[0]) / max(*each.pressure, 1e-300)
    verdict = "pass" if each.passed else "FAIL"
    return [
        (each.contact, "contactor", *each.contactors, ""),
        ("", f"force on {each.first}", *forces, f"{each.of_force:.1%} (limit {FORCE:.0%})"),
        ("", "largest pressure", *map(number, each.pressure), f"{change:.1%}"),
        ("", "area", *map(number, each.area), ""),
        ("", "pressure inside", "", "", f"{each.local:.1%} at most, {each.mean:.1%} in the mean (limit {LIMIT:.0%})"),
        ("", "", "", "", verdict),
    ]


def _verdict(found: Swap) -> str:
    from abut.verify.swap import LIMIT

    if found.passed:
        return f"both agree: inside the contact pressures differ by less than {LIMIT:.0%} of the largest"
    names = ", ".join(f"'{each.contact}'" for each in found.comparisons if not each.passed)
    return (
        f"the two differ at {names}: at least one of them is wrong there. Refine both surfaces where they touch, and let "
        "abut choose the contactor (surfaces = [...])"
    )


def _report(found: Swap, job: Job, folder: Path) -> Path:
    from abut.io.atomic import make_directory
    from abut.report import Beside, read_origin, write_report

    make_directory(folder)
    beside = Beside("Sides swapped", _verdict(found), HEAD, tuple(rows(found)[1:]), found.charts)
    return write_report(found.solutions[0], folder / "report.html", read_origin(job.path, job.text), beside)


def _plain(found: Swap) -> Json:
    return {
        "schema": 1,
        "passed": found.passed,
        "contacts": [
            {
                "name": each.contact,
                "contactors": list(each.contactors),
                "force": [force.tolist() for force in each.force],
                "max_pressure": list(each.pressure),
                "area": list(each.area),
                "force_difference": each.of_force,
                "pressure_difference": None if each.local != each.local else each.local,
                "mean_difference": None if each.mean != each.mean else each.mean,
                "passed": each.passed,
            }
            for each in found.comparisons
        ],
        "left": found.left,
    }
