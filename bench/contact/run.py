"""Contact in abut, in abut with the bodies tied (the linear problem on the same mesh), in CalculiX and in Kratos; and PyAMG
by hand on the stiffness alone.

python bench/contact/run.py [--cases flat-hex8,tilted-hex8] [--dofs 10000,50000] [--cores 1,2] [--repeat 3]
    [--codes abut,abut-tied,abut-dual,pyamg,calculix-mortar,calculix-penalty,kratos] [--linear auto] [--limit 120]

Cases are {flat,tilted,friction,hertz,plastic,rubber,neohooke}-{hex8,hex20,tet10}; all of them, of 10 000 to 1 000 000
dofs, take hours.
Every run is a new process with limits of time and memory; a code that is missing, fails or runs out of either is named in
the table. Results go to results-bench: results.json, table.md, runs.md and, with matplotlib, times.png. docs/performance.md
says what is measured.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import shutil
import statistics
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import plot
import process
import report
from codes import CODES, Code, code
from report import Row

GEOMETRIES, CELLS = ("flat", "tilted", "friction", "hertz", "plastic", "rubber", "neohooke"), ("hex8", "hex20", "tet10")
NAMES = [f"{geometry}-{cell}" for geometry in GEOMETRIES for cell in CELLS]
MARGIN = 1.5  # times differ between runs on a busy machine: a run is left out only if it would be this much too long
ENOUGH = 30.0  # seconds spent on one code and mesh after which no run is repeated
LARGEST = 500_000  # dofs from where on other codes are not run
SMALLER = " already at a smaller size"
NUMBERS = ("seconds", "wall", "cpu", "peak_mb")


@dataclass
class Bench:
    """All runs of one call; ``rows`` grows."""

    codes: list[Code]
    repeat: int
    limit: float
    memory: float
    rows: list[Row] = field(default_factory=list)

    def measure(self, case: str, wanted: int, cores: list[list[int]], folder: Path) -> Iterator[Row]:
        """Every code on one mesh."""
        rows = []
        every = process.available_cores()
        for own in self.codes:
            if own.prepare is not None and wanted > LARGEST:
                continue
            place = folder / own.name
            place.mkdir()
            trouble, size = "" if own.version else "not installed", {}
            if own.prepare is not None and not trouble:
                written = process.run(own.prepare(case, wanted, place), place, every, 600.0, self.memory)
                trouble = "" if written.status == "ok" else f"no input written, {written.status}"
                size = written.json() or {}
            for some in cores:
                row: Row = {"case": case, "dofs": wanted, "cores": len(some), "code": own.name}
                row["status"] = trouble or self._hopeless(row)
                if not row["status"]:
                    row.update(self._median(own, row, some, place))
                    row.update(size)
                rows.append(row)
                done = f"{row['seconds']:.3g} s" if row["status"] == "ok" else row["status"]
                print(f"  {own.name}, {report.cores(len(some))}: {done}", file=sys.stderr, flush=True)
        size = next((row["dofs"] for row in rows if row["dofs"] != wanted), wanted)
        for row in sorted(rows, key=lambda row: row["cores"]):
            yield {**row, "dofs": size}

    def _hopeless(self, row: Row) -> str:
        """Why a run is not worth starting: the last smaller one took so long that this one, even if its time grew only in
        proportion to size, would take clearly too long; nothing where it may fit."""
        for other in reversed(self.rows):
            if all(other[key] == row[key] for key in ("case", "cores", "code")) and other["dofs"] < row["dofs"]:
                if other["status"].startswith(("time limit", "memory limit", "not run")):
                    reason = other["status"].removeprefix("not run: ").removesuffix(SMALLER)
                    return f"not run: {reason}{SMALLER}"
                least = other.get("wall", 0.0) * row["dofs"] / other["dofs"]
                return f"not run: it would take more than {self.limit:.0f} s" if least > MARGIN * self.limit else ""
        return ""

    def _median(self, own: Code, row: Row, cores: list[int], folder: Path) -> Row:
        runs: list[Row] = []
        spent = 0.0
        while len(runs) < self.repeat and (not runs or spent + runs[-1]["wall"] < ENOUGH):
            run = process.run(
                own.command(row["case"], row["dofs"]), folder, cores, self.limit, self.memory, own.environment
            )
            spent += run.wall
            last: Row = {"wall": run.wall, "cpu": run.cpu, "peak_mb": run.peak_mb, "seconds": run.wall}
            limited = run.status.endswith("limit")
            told = {} if limited else own.read(run, folder)
            last.update(told)
            if limited:
                last["status"] = f"{run.status} of " + self._limit(run.status)
            elif run.status != "ok":
                last["status"] = run.status
            last["peak_mb"] = run.peak_mb
            runs.append(last)
            if last["status"] != "ok":
                return last
        result: Row = {**sorted(runs, key=lambda run: run["seconds"])[(len(runs) - 1) // 2]}
        for key in NUMBERS:
            result[key] = statistics.median(run[key] for run in runs)
        result["runs"] = len(runs)
        return result

    def _limit(self, status: str) -> str:
        return f"{self.limit:.0f} s" if status.startswith("time") else f"{self.memory / 1e9:.0f} GB"


def machine() -> str:
    """The machine in words, and how busy it is."""
    model = platform.machine()
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        model = next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        pass
    count = len(process.available_cores())
    load = f", load average {os.getloadavg()[0]:.1f} at the start" if hasattr(os, "getloadavg") else ""
    return f"{count} cores ({model}), {process.memory_of_machine() / 1e9:.0f} GB, {platform.system()}{load}"


def arguments() -> argparse.Namespace:
    """The command line, checked."""

    def names(text: str) -> list[str]:
        return text.split(",")

    def numbers(text: str) -> list[int]:
        return sorted(int(float(word.replace("_", ""))) for word in text.split(","))

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=names, default=NAMES)
    parser.add_argument("--dofs", type=numbers, default=[10_000, 50_000, 150_000, 400_000, 1_000_000])
    count = len(process.available_cores())
    parser.add_argument("--cores", type=numbers, default=[n for n in (1, 2) if n <= count])
    parser.add_argument("--codes", type=names, default=[name for name in CODES if name != "abut-dual"])
    parser.add_argument("--repeat", type=int, default=3, help=f"median of so many; fewer from {ENOUGH:.0f} s on")
    parser.add_argument("--linear", default="auto", help="abut's linear solver")
    parser.add_argument("--limit", type=float, default=120.0, help="seconds for one run")
    share = 0.8 * process.memory_of_machine() / 1e9
    parser.add_argument("--memory", type=float, default=share, help="GB for one run (80 %% of the machine's)")
    parser.add_argument("--ccx", default=os.environ.get("CCX", "ccx"), help="CalculiX (or variable CCX)")
    parser.add_argument(
        "--kratos-python",
        default=os.environ.get("KRATOS_PYTHON", sys.executable),
        help="a Python that has Kratos (or variable KRATOS_PYTHON)",
    )
    parser.add_argument("--output", type=Path, default=Path("results-bench"))
    parser.add_argument("--add", action="store_true", help="keep what earlier calls measured into the same output")
    parser.add_argument(
        "--page", type=Path, help="page for the overview, between its markers; PAGE-runs.md beside it gets every run"
    )
    result = parser.parse_args()
    unknown = sorted(set(result.codes) - set(CODES))
    if unknown:
        parser.error(f"no code {unknown[0]!r}; use {', '.join(CODES)}")
    wrong = [case for case in result.cases if case not in NAMES]
    if wrong:
        parser.error(
            f"no case {wrong[0]!r}; use {{flat,tilted,friction,hertz,plastic,rubber,neohooke}}-{{hex8,hex20,tet10}}"
        )
    if result.cores[-1] > count:
        parser.error(f"--cores {result.cores[-1]}: there are {count}")
    return result


def main() -> None:
    options = arguments()
    if "PYTHONPATH" in os.environ:  # children run in folders of their own
        entries = os.environ["PYTHONPATH"].split(os.pathsep)
        os.environ["PYTHONPATH"] = os.pathsep.join(str(Path(entry).absolute()) for entry in entries)
    codes = [code(name, options.linear, options.ccx, options.kratos_python) for name in options.codes]
    every = process.available_cores()
    cores = [every[:n] for n in options.cores]
    bench = Bench(codes, options.repeat, options.limit, options.memory * 1e9)
    place = machine()
    versions = {"Python": platform.python_version(), **{own.family: own.version or "missing" for own in codes}}
    options.output.mkdir(parents=True, exist_ok=True)
    before = options.output / "results.json"
    if options.add and before.is_file():
        earlier = json.loads(before.read_text(encoding="utf-8"))
        bench.rows += earlier["rows"]
        versions = {**earlier["versions"], **versions}
    for case in options.cases:
        for wanted in options.dofs:
            print(f"{case}, {wanted} dofs", file=sys.stderr, flush=True)
            with tempfile.TemporaryDirectory() as folder:
                bench.rows += bench.measure(case, wanted, cores, Path(folder))
            bench.rows = report.ordered(bench.rows, NAMES, list(CODES))
            record = {"machine": place, "versions": versions, "rows": bench.rows}
            (options.output / "results.json").write_text(json.dumps(record, indent=1), encoding="utf-8")
    text = report.page(bench.rows, place, versions)
    (options.output / "table.md").write_text(text + "\n", encoding="utf-8")
    every_run = report.all_runs(bench.rows, place, versions)
    (options.output / "runs.md").write_text(every_run, encoding="utf-8")
    print(report.plain(report.table(bench.rows)))
    print("\nexponents of time against dofs\n" + report.plain(report.exponent_table(bench.rows)))
    print("\nseconds of abut's contact runs by stage\n" + report.plain(report.stage_table(bench.rows)))
    picture = options.output / "times.png"
    plotted = plot.plot(bench.rows, picture)
    print(f"\nwritten to {options.output}" + ("" if plotted else "; no plot, matplotlib is not installed"))
    if options.page is not None:
        if plotted:
            shutil.copy(picture, options.page.parent / "pictures" / "times.png")
            text = f"![Time against dofs](pictures/times.png)\n\n{text}"
        report.put_into(options.page, text)
        options.page.with_name(f"{options.page.stem}-runs.md").write_text(every_run, encoding="utf-8")


if __name__ == "__main__":
    main()
