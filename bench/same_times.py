"""Do two versions of abut take the same time? The contact cases of bench/contact in both, by turns, on one thread.

python bench/same_times.py BEFORE [AFTER] [--cases flat-hex8,tilted-hex8,hertz-hex8] [--dofs 50000,150000] [--repeat 5]

BEFORE and AFTER are as for bench/same_results.py. Printed are, for each case, the least processor time of each version over
its repetitions, in seconds, from a model in memory to results in memory, and their ratio. Other work on the machine spoils
it: the ratios of a version with itself (BEFORE and AFTER the same) say by how much.

Exit status: 0 no ratio above 1.05; 1 one above; 2 a version that cannot be built, or a run that fails.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

from same.versions import ROOT, Version, VersionError, checked_out, install, ran

CHILD = ROOT / "bench/contact/abut_child.py"  # serves both versions
MARGIN = 1.05
SLOWER, NOT_BUILT = 1, 2


def main(arguments: Sequence[str] | None = None) -> int:
    given = parser().parse_args(arguments)
    largest = 0.0
    try:
        with ExitStack() as stack:
            folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="abut-times-")))
            versions = [
                stack.enter_context(checked_out(what, name, folder))
                for what, name in ((given.before, "before"), (given.after, "after"))
            ]
            for version in versions:
                install(version)
            for case in given.cases.split(","):
                for dofs in map(int, given.dofs.split(",")):
                    before, after = least(versions, case, dofs, given.repeat)
                    largest = max(largest, after / before)
                    print(f"{case:14} {dofs:8}  {before:7.3f} s  {after:7.3f} s  {after / before:.2f}", flush=True)
    except VersionError as error:
        print(f"same_times: {error}")
        return NOT_BUILT
    return SLOWER if largest > MARGIN else 0


def parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", metavar="BEFORE", help="commit or compiled folder")
    parser.add_argument("after", metavar="AFTER", nargs="?", help="the same; left out: the working tree")
    parser.add_argument("--cases", default="flat-hex8,tilted-hex8,hertz-hex8", help="of bench/contact")
    parser.add_argument("--dofs", default="50000,150000", help="about how many")
    parser.add_argument("--repeat", type=int, default=5, help="runs of each version (default 5)")
    return parser


def least(versions: Sequence[Version], case: str, dofs: int, repeat: int) -> list[float]:
    """Processor time of each version, the least of ``repeat`` runs; the versions take turns."""
    found: list[list[float]] = [[] for _ in versions]
    for _ in range(repeat):
        for version, seconds in zip(versions, found):
            command = [str(version.python), str(CHILD), case, str(dofs)]
            text = ran(command, f"{version.tree}: {case} fails", version.environment)
            seconds.append(json.loads(text.splitlines()[-1])["processor"])
    return [min(seconds) for seconds in found]


if __name__ == "__main__":
    raise SystemExit(main())
