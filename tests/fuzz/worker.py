"""The process that takes damaged inputs: numbers on stdin, a line of JSON for each on stdout."""

from __future__ import annotations

import contextlib
import io
import json
import os
import shutil
import sys
import traceback
import warnings
from pathlib import Path

from fuzz.harness import ALLOWED, MEMORY, Result, make


def main() -> None:
    seed, folder = int(sys.argv[1]), Path(sys.argv[2])
    with contextlib.suppress(ImportError, ValueError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    out = os.dup(1)
    os.dup2(2, 1)  # what libraries print themselves must not mix with the results
    for word in sys.stdin.read().split():
        result = run_one(seed, int(word), folder / f"case-{os.getpid()}")
        os.write(out, (json.dumps(vars(result)) + "\n").encode())


def run_one(seed: int, number: int, folder: Path) -> Result:
    """Write the files of one input, run it, judge, and remove everything."""
    from abut.cli import main as abut

    case = make(seed, number)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name, data in case.files.items():
        (folder / name).write_bytes(data)
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said), warnings.catch_warnings():
            warnings.simplefilter("always")
            results = folder / "out"
            status = abut(["run", str(folder / case.run), "--quiet", "--debug", "--output", str(results)])
        problem = judge(status, said.getvalue(), results)
    except BaseException:  # anything that passes main is what this is here to find
        status, problem = 1, traceback.format_exc()
    shutil.rmtree(folder, ignore_errors=True)
    return Result(number, case.kind, status, problem)


def judge(status: int, said: str, results: Path) -> str:
    """What is wrong with how a run ended; "" if nothing."""
    if status not in ALLOWED or "Traceback" in said or "Warning" in said:
        return f"status {status}: {said[-3000:]}"
    if (status == 0) != (not said.strip()):
        return f"status {status}, but said: {said[:500]!r}"
    names = [path.name for path in results.rglob("*")] if results.exists() else []
    if [name for name in names if ".tmp" in name or name.endswith(".part")]:
        return f"left behind: {names}"
    if status == 2 and names:
        return f"bad input, but written: {names}"
    if status in (0, 3):
        summary = json.loads((results / "summary.json").read_text())
        if summary["status"] != ("converged" if status == 0 else "not converged"):
            return f"status {status}, but summary.json says {summary['status']}"
    return ""


if __name__ == "__main__":
    main()
