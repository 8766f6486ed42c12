"""abut run: solve a job, with a live table and the certificate at the end."""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from abut.errors import ConvergenceError

if TYPE_CHECKING:
    from abut.state import Iteration, Solution

DONE = 0


def add_run(commands: Any) -> None:
    """Add the command to the parser's ``commands``."""
    run = commands.add_parser(
        "run",
        help="solve a job",
        description="Solve a job file (TOML), or an Abaqus or CalculiX deck (.inp), and write its results.",
        epilog="exit status: 0 done; 2 bad input; 3 not converged (last state written); 4 the model has no unique solution",
    )
    run.add_argument("job", type=Path, help="the job file or deck")
    add_ignore(run)
    run.add_argument("--output", type=Path, metavar="DIR", help="write results here instead of the job's own directory")
    run.add_argument("--json", action="store_true", help="print summary.json instead of the table")
    run.add_argument("--quiet", action="store_true", help="print errors only")
    run.add_argument("--debug", action="store_true", help="show the traceback of a bug")
    run.set_defaults(command=_run)


def add_ignore(parser: argparse.ArgumentParser) -> None:
    """What a deck asks for and the user does without."""
    parser.add_argument(
        "--ignore",
        action="append",
        default=[],
        metavar="CARD",
        help="leave a card (FRICTION) or parameter (NLGEOM) of a deck out that abut does not do; may be repeated",
    )


def _run(arguments: argparse.Namespace) -> int:
    from abut.analysis import solve
    from abut.io.results import summary, write
    from abut.job import load_job

    job = load_job(arguments.job, ignore=arguments.ignore)
    silent = arguments.quiet or arguments.json
    if not silent:
        for text in (*(f"ignored: {what}" for what in job.ignored), *job.notes):
            print(text, flush=True)
    directory = arguments.output or job.directory
    solution = solve(job.model, None if silent else _Table())
    solution = replace(solution, notes=(*job.notes, *solution.notes), ignored=job.ignored)
    write(solution, directory)
    if arguments.json:
        print(json.dumps(summary(solution), indent=2))
    elif not arguments.quiet:
        _print_result(solution, directory)
    if not solution.converged:
        where = "; ".join(
            f"contact '{name}': facets {facets[:8].tolist()} do not settle"
            for name, facets in solution.steps[-1].cycling.items()
        )
        raise ConvergenceError(
            f"step {solution.steps[-1].number} did not converge ({where or 'residual too large'}); the last state is in "
            f"{directory}. Try more load steps, more iterations (solve.max_iterations) or a finer contactor"
        )
    return DONE


class _Table:
    """One line an iteration, notes as they come."""

    def __init__(self) -> None:
        self._step = 0

    def __call__(self, item: Iteration | str) -> None:
        if isinstance(item, str):
            print(item, flush=True)
            return
        if item.step != self._step:
            self._step = item.step
            print("step  iter   active  changed   residual    contact  penetration   seconds")
        print(
            f"{item.step:4d}  {item.iteration:4d}  {item.active:7d}  {item.changed:7d}  {item.residual:9.2e}  "
            f"{item.contact_residual:9.2e}    {item.penetration:9.2e}  {item.seconds:8.2f}",
            flush=True,
        )


def _print_result(solution: Solution, directory: Path) -> None:
    for contact in solution.contacts:
        force = ", ".join(f"{value:.6g}" for value in contact.force)
        print(
            f"contact '{contact.name}': force on the contactor ({force}), largest pressure {contact.max_pressure:.6g}, "
            f"area {contact.area:.6g}, largest penetration {contact.max_penetration:.2g}"
        )
    print("certificate   value      limit")
    for check in solution.certificate:
        name = f"{check.contact}: {check.name}" if check.contact else check.name
        print(f"  {'pass' if check.passed else 'FAIL'}  {check.value:9.2e}  {check.limit:9.2e}  {name}")
    print(
        f"{sum(solution.timings.values()):.1f} s; results in {directory}: open fields.pvd and contact_*.pvd in ParaView"
    )
