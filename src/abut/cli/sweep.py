"""abut sweep: one job with different parameters, and what comes of each side by side."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

from abut.cli.terminal import show
from abut.errors import AbutError, ConvergenceError, InputError, Stopped

if TYPE_CHECKING:
    from abut.report.sweep_page import Run

DONE = 0
MOST = 1000  # runs


def add_sweep(commands: Any) -> None:
    """Add the command to the parser's ``commands``."""
    sweep = commands.add_parser(
        "sweep",
        help="solve a job with different parameters",
        description="Solve a job once for each combination of values of its [parameters], and compare: sweep.csv has the\n"
        "key results of every run, sweep.html plots and links to the reports. A run that fails is a line that says\n"
        "why; the others go on.",
        epilog="example:\n  abut sweep pin.toml --set clearance=0.01,0.02,0.05 --set friction=0,0.1",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    sweep.add_argument("job", type=Path, help="the job file")
    sweep.add_argument(
        "--set", action="append", default=[], metavar="NAME=A,B,...", help="values of a parameter; may be repeated"
    )
    sweep.add_argument("--output", type=Path, metavar="DIR", help="write here (default: JOB-sweep beside the job)")
    sweep.add_argument("--quiet", action="store_true", help="print errors only")
    sweep.add_argument("--debug", action="store_true", help="print the traceback of an internal error")
    sweep.set_defaults(command=_sweep)


def _sweep(arguments: argparse.Namespace) -> int:
    from abut.io.atomic import make_directory, write_text
    from abut.job.parameters import read_settings
    from abut.report.sweep_page import sweep_csv, sweep_page

    settings = combinations(read_settings(arguments.set))
    folder = arguments.output or arguments.job.with_name(f"{arguments.job.stem}-sweep")
    make_directory(folder)
    runs: list[Run] = []
    status = DONE
    for number, setting in enumerate(settings, start=1):
        run, ended = _run(arguments, folder, f"{number:03d}", setting)
        status = status or ended
        runs.append(run)
        write_text(folder / "sweep.csv", sweep_csv(runs))  # whatever becomes of the others
        write_text(folder / "sweep.html", sweep_page(f"{arguments.job.stem}: {', '.join(setting)}", runs))
        if not arguments.quiet:
            values = ", ".join(f"{name} = {value}" for name, value in setting.items())
            show(f"{number} of {len(settings)}: {values}: {run.status}{f', {run.verdict}' if run.verdict else ''}")
    if not arguments.quiet:
        show(f"written: {folder / 'sweep.csv'}; open {folder / 'sweep.html'} in a browser")
    return status


def combinations(settings: dict[str, str]) -> list[dict[str, str]]:
    """Every combination of the values, parted by commas outside brackets. Raises InputError for none or too many."""
    if not settings:
        raise InputError("sweep: nothing changes; give --set NAME=A,B,...")
    values = {name: _parted(text) for name, text in settings.items()}
    for name, parts in values.items():
        if not all(parts):
            raise InputError(f"--set {name}: a value is missing between commas")
    result = [dict(zip(values, chosen)) for chosen in product(*values.values())]
    if len(result) > MOST:
        raise InputError(f"sweep: {len(result)} runs, more than {MOST}; give fewer values")
    return result


def _parted(text: str) -> list[str]:
    parts, depth = [""], 0
    for sign in text:
        depth += (sign == "(") - (sign == ")")
        if sign == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += sign
    return [part.strip() for part in parts]


def _run(arguments: argparse.Namespace, folder: Path, name: str, setting: dict[str, str]) -> tuple[Run, int]:
    """One run, and its exit status. Raises InputError where the job cannot be read, as each run would say the same."""
    from abut.cli.interrupt import Interrupt
    from abut.cli.progress import Progress
    from abut.cli.run import solve_job
    from abut.io.toml import read_toml
    from abut.job.parameters import parameters
    from abut.output.key_results import key_results, verdict
    from abut.output.results import status
    from abut.report.sweep_page import Run

    names = parameters(read_toml(arguments.job)[1], setting)
    chosen = {key: names[key] for key in setting}
    options = argparse.Namespace(
        job=arguments.job, ignore=[], soft_contact=False, set=[f"{key}={value}" for key, value in setting.items()],
        output=folder / name, restart=False, frd=False, petsc=(),
    )  # fmt: skip
    with Progress(silent=True, plain=True) as progress, Interrupt(show, leave=progress.close) as interrupt:
        try:
            solution, _ = solve_job(options, progress, interrupt, None)
        except Stopped:
            raise
        except AbutError as error:
            return Run(chosen, name, _first_line(str(error))), error.exit_status
    ended = DONE if solution.converged else ConvergenceError.exit_status
    return Run(chosen, name, status(solution), verdict(solution), key_results(solution)), ended


def _first_line(text: str) -> str:
    lines: Sequence[str] = [line.strip() for line in text.splitlines() if line.strip()]
    return " ".join(lines[:2])
