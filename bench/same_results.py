"""Do two versions of abut give the same numbers? Every example, benchmark and some small models are run with both,
on one thread.

python bench/same_results.py BEFORE [AFTER] [--only PATTERN] [--tolerance 1e-12] [-j 2]

BEFORE and AFTER are commits, which are checked out, compiled and installed aside; AFTER left out is the working tree,
treated likewise. A folder with a working tree that `make build` has compiled is run as it is, by the Python that runs this.

The examples are those of BEFORE; the small models are of every cell, with contact, friction, ties and every pressure space
(same/models.py). Compared are all numbers of summary.json and of CSV files, all arrays of VTU files, and the values of
`abut verify`; not times and versions. A difference is relative to the largest of its array; of forces that balance, gaps
that close and centres, to what they come from (SCALES in bench/same/differences.py). New files and quantities, and other
words, are only reported.

Exit status: 0 the same; 1 a difference above the tolerance, a file or quantity that AFTER lacks, or a run that fails; 2 a
version that cannot be built.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import ExitStack
from fnmatch import fnmatch
from pathlib import Path

from same.differences import Comparison, compare
from same.quantities import read
from same.runs import Run, execute, runs_of
from same.versions import Version, VersionError, checked_out, install

SAME, DIFFERENT, NOT_BUILT = 0, 1, 2
NAMED = 5  # quantities named of a run that differs
Result = Comparison | str  # a str: why there is none


def main(arguments: Sequence[str] | None = None) -> int:
    given = parser().parse_args(arguments)
    try:
        with ExitStack() as stack:
            folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="abut-same-")))
            before, after = (
                stack.enter_context(checked_out(what, name, folder))
                for what, name in ((given.before, "before"), (given.after, "after"))
            )
            say("building")
            with ThreadPoolExecutor(given.j) as pool:
                list(pool.map(install, (before, after)))
            own, others = runs_of(before), runs_of(after)
            runs = chosen(own, given.only)
            tell_new(chosen(others, given.only), runs)
            with ThreadPoolExecutor(given.j) as pool:
                results = compared(runs, others, (before, after), folder, pool)
    except VersionError as error:
        say(str(error))
        return NOT_BUILT
    if not results:
        say(f"nothing to run: no example or benchmark fits {given.only}")
        return NOT_BUILT
    print(*report({run.name: results[run] for run in runs}, given.tolerance), sep="\n")
    return SAME if all(passes(result, given.tolerance) for result in results.values()) else DIFFERENT


def parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", metavar="BEFORE", help="commit or compiled folder")
    parser.add_argument("after", metavar="AFTER", nargs="?", help="the same; left out: the working tree")
    parser.add_argument(
        "--only",
        metavar="PATTERN",
        action="append",
        help='runs by name, such as "example *" or "models *" (repeatable)',
    )
    parser.add_argument("--tolerance", type=float, default=1e-12, help="largest relative difference (default 1e-12)")
    parser.add_argument("-j", type=int, default=2, metavar="N", help="processes at a time (default 2)")
    return parser


def chosen(runs: Sequence[Run], patterns: Sequence[str] | None) -> list[Run]:
    return [run for run in runs if patterns is None or any(fnmatch(run.name, pattern) for pattern in patterns)]


def tell_new(others: Sequence[Run], runs: Sequence[Run]) -> None:
    for run in others:
        if run not in runs:
            say(f"only in AFTER, not run: {run.name}")


def compared(
    runs: Sequence[Run],
    others: Sequence[Run],
    versions: tuple[Version, Version],
    folder: Path,
    pool: ThreadPoolExecutor,
) -> dict[Run, Result]:
    """Every run with its comparison, in no order; each is told of as it ends."""
    jobs = {
        pool.submit(both, run, versions, folder / str(i)): run for i, run in enumerate(r for r in runs if r in others)
    }
    results: dict[Run, Result] = {run: "missing in AFTER" for run in runs if run not in others}
    try:
        for number, job in enumerate(as_completed(jobs), start=1):
            run = jobs[job]
            results[run] = job.result()
            say(f"{number} of {len(jobs)}  {run.name}: {outcome(results[run])}")
    except BaseException:
        pool.shutdown(cancel_futures=True)
        raise
    return results


def both(run: Run, versions: tuple[Version, Version], folder: Path) -> Result:
    """Run with each version, compare, and remove the files."""
    found = []
    try:
        for version, name in zip(versions, ("BEFORE", "AFTER")):
            try:
                execute(run, version, folder / name, versions[0].tree)
                found.append(read(folder / name))
            except (VersionError, ValueError, OSError) as error:
                return f"{name} failed: {error}"
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    return compare(*found)


def passes(result: Result, tolerance: float) -> bool:
    return not isinstance(result, str) and result.passes(tolerance)


def outcome(result: Result) -> str:
    """In a few words."""
    if isinstance(result, str):
        return result
    if result.missing:
        return f"missing in AFTER: {len(result.missing)}"
    worst = result.worst
    if worst is None:
        return "nothing to compare"
    return "bit for bit" if result.identical else f"{worst.relative:.1e}  {worst.name}"


def report(results: dict[str, Result], tolerance: float) -> list[str]:
    """The table, what differs by name, and a line in the end that says whether all is the same."""
    width = max(map(len, results))
    lines = ["", f"        {'run':{width}s} {'values':>9s}  largest difference"]
    for name, result in results.items():
        count = "" if isinstance(result, str) else str(result.count)
        lines.append(
            f"{'same' if passes(result, tolerance) else 'DIFFERS':7s} {name:{width}s} {count:>9s}  {outcome(result)}"
        )
    for name, result in results.items():
        if not isinstance(result, str) and (told := details(result, tolerance)):
            lines += ["", name, *(f"  {line}" for line in told)]
    same = sum(passes(result, tolerance) for result in results.values())
    exact = sum(not isinstance(r, str) and r.identical and passes(r, tolerance) for r in results.values())
    lines += ["", f"{same} of {len(results)} runs the same within {tolerance:g}, {exact} of them bit for bit"]
    return lines


def details(result: Comparison, tolerance: float) -> list[str]:
    """Quantities above the tolerance, and what one side lacks or says in other words, a few of each."""
    above = [f"{d.relative:.1e}  {d.name}" for d in result.above(tolerance)]
    kinds = (("above the tolerance", above), ("missing in AFTER", result.missing), ("new in AFTER", result.new))
    lines = []
    for title, names in (*kinds, ("other words", result.words)):
        lines += [f"{title}: {name}" for name in names[:NAMED]]
        if len(names) > NAMED:
            lines.append(f"{title}: {len(names) - NAMED} more")
    return lines


def say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
