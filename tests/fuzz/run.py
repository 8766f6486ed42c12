"""python tests/fuzz/run.py --count 10000: damaged jobs, meshes and decks; prints what went wrong and how all ended."""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from fuzz.harness import make, run_all


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--first", type=int, default=0, help="number of the first input")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", choices=["job", ".msh", ".vtu", ".inp"], help="inputs of this kind only")
    parser.add_argument("--only", type=int, metavar="NUMBER", help="one input; its files are kept")
    arguments = parser.parse_args()
    numbers = (
        [arguments.only] if arguments.only is not None else range(arguments.first, arguments.first + arguments.count)
    )
    if arguments.kind:
        numbers = [n for n in numbers if make(arguments.seed, n).kind == arguments.kind]
    ends: Counter[tuple[str, int | None]] = Counter()
    bad = 0
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        for result in run_all(list(numbers), arguments.seed, Path(folder)):
            ends[result.kind, result.status] += 1
            if result.problem:
                bad += 1
                print(f"--- {result.number} ({result.kind}): {result.problem}", flush=True)
    if arguments.only is not None:
        kept = Path(tempfile.mkdtemp(prefix="abut-fuzz-"))
        for name, data in make(arguments.seed, arguments.only).files.items():
            (kept / name).write_bytes(data)
        print(f"files: {kept}")
    for (kind, status), count in sorted(ends.items(), key=str):
        print(f"{kind:10s} exit status {status}: {count}")
    print(f"{sum(ends.values())} inputs, {bad} bad, {time.monotonic() - began:.0f} s")
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main())
