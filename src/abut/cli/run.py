"""abut run: solve a job, with a live table and the certificate at the end."""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from abut.cli.terminal import show
from abut.errors import ConvergenceError, InputError, OutOfTime, Stopped
from abut.parallel.launch import processes, unused

if TYPE_CHECKING:
    from abut.cli.interrupt import Interrupt
    from abut.cli.progress import Progress
    from abut.job import Job
    from abut.parallel.team import Team
    from abut.solution import Iteration, Phase, ProbeResult, Saved, Solution

DONE = 0
STATUS = """exit status:
  0    done
  1    internal error: a bug in abut
  2    bad input: the message says what, where, and how to correct it
  3    not converged: the last state is written, the message names facets and gives advice
  4    the model has no unique solution
  124  the time of solve.seconds is over: all steps done so far are written, and --restart goes on from there
  130  stopped by Ctrl-C (143: by SIGTERM) after the current iteration: all steps done so far are written, and
       --restart goes on from there

several processes (docs/mpi.md): mpiexec -n N abut run JOB [OPTION OF PETSC ...]
  needs petsc4py and mpi4py; process 0 prints, and its exit status counts. Options that abut does not know and PETSc
  does stand after the job: -ksp_type minres -ksp_monitor. On one process they need linear = "petsc" in the job.
"""


def add_run(commands: Any) -> None:
    """Add the command to the parser's ``commands``."""
    run = commands.add_parser(
        "run",
        help="solve a job",
        description="Solve a job file (TOML), or an Abaqus or CalculiX deck (.inp), and write the results of each load "
        "step as soon as it has converged.",
        epilog=STATUS,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    run.add_argument("job", type=Path, help="the job file or deck")
    add_ignore(run)
    add_set(run)
    run.add_argument("--output", type=Path, metavar="DIR", help="write results here instead of the job's own directory")
    run.add_argument(
        "--restart", action="store_true", help="continue after the last step that an earlier run has written"
    )
    run.add_argument("--frd", action="store_true", help="write fields.frd as well, for CalculiX GraphiX")
    run.add_argument("--json", action="store_true", help="print summary.json instead of the table")
    run.add_argument("--quiet", action="store_true", help="print errors only")
    run.add_argument("--debug", action="store_true", help="print the traceback of an internal error")
    run.set_defaults(command=_start, together=True)


def add_ignore(parser: argparse.ArgumentParser) -> None:
    """What a deck asks for and the user does without."""
    parser.add_argument(
        "--ignore",
        action="append",
        default=[],
        metavar="CARD",
        help="leave out a card (PLASTIC) or a parameter (NLGEOM) of a deck; may be repeated",
    )
    parser.add_argument(
        "--soft-contact", action="store_true", help="a deck's own PRESSURE-OVERCLOSURE, in place of exact contact"
    )


def add_set(parser: argparse.ArgumentParser) -> None:
    """Parameters in place of those of the job."""
    parser.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="a parameter of the job; may be repeated"
    )


def passes_on(job: Path, options: Sequence[str]) -> bool:
    """Whether what abut does not know goes to PETSc: names with one dash, each with a value or none, and PETSc in use."""
    kinds = "".join("n" if re.match("-[A-Za-z]", option) else "?" if option[:2] == "--" else "v" for option in options)
    return re.fullmatch("(nv?)+", kinds) is not None and _uses_petsc(job)


def _uses_petsc(job: Path) -> bool:
    """Several processes, or a job that asks for PETSc; of one that cannot be read, load_job says why."""
    if processes() > 1:
        return True
    from abut.io.toml import read_toml

    try:
        solve = read_toml(job)[1].get("solve")
    except InputError:
        return False
    return isinstance(solve, dict) and solve.get("linear") == "petsc"


def _start(arguments: argparse.Namespace) -> int:
    if not _uses_petsc(arguments.job):
        return _run(arguments, None)
    from abut.parallel.team import lead

    return lead(lambda team: _run(arguments, team), arguments.petsc)


def _run(arguments: argparse.Namespace, team: Team | None) -> int:
    from abut.cli.interrupt import Interrupt
    from abut.cli.progress import Progress
    from abut.output.results import summary

    with (
        Progress(silent=arguments.quiet or arguments.json, plain=processes() > 1) as progress,
        Interrupt(_say, leave=progress.close) as interrupt,
    ):
        try:
            solution, directory = solve_job(arguments, progress, interrupt, team)
        except Stopped as reason:
            progress.close()
            _say(str(reason))
            return reason.exit_status if isinstance(reason, OutOfTime) else interrupt.exit_status
    if arguments.json:
        show(json.dumps(summary(solution), indent=2))
    elif not arguments.quiet:
        _print_result(solution, directory)
    if not solution.converged:
        raise ConvergenceError(_failure(solution, directory))
    if not solution.complete:
        _say(
            _left(
                f"stopped after {solution.model.solve.seconds:g} s, as solve.seconds says",
                len(solution.steps),
                solution.model.solve.said(solution.steps[-1].factor),
                directory,
            )
        )
        return OutOfTime.exit_status
    return DONE


def solve_job(
    arguments: argparse.Namespace, progress: Progress, interrupt: Interrupt, team: Team | None
) -> tuple[Solution, Path]:
    """Solve and write, every step as soon as it has converged. Raises Stopped, with what is left in words."""
    from abut.analysis import solve
    from abut.job import load_job
    from abut.job.parameters import read_settings
    from abut.output import restart
    from abut.output.fields import write_fields
    from abut.output.parallel import Pieces
    from abut.output.stream import Stream
    from abut.report import read_origin
    from abut.solution import Phase

    progress(Phase(f"reading {arguments.job}"))
    settings = read_settings(arguments.set)
    job = load_job(arguments.job, ignore=arguments.ignore, soft=arguments.soft_contact, settings=settings)
    _check_linear(job)
    for text in (*(f"ignored: {what}" for what in job.ignored), *job.notes):
        progress(text)
    directory, size = arguments.output or job.directory, 1 if team is None else team.size
    model = restart.description(job.model)
    fields = write_fields if team is None or size == 1 else Pieces(team)
    output = job.output.with_frd() if arguments.frd else job.output
    begun = _begun(job, directory)
    with Stream(directory, model, arguments.restart, fields, progress, output, begun) as stream:
        before = stream.resumed or begun
        if before:
            progress(restart.last(before))

        def told(solution: Solution) -> Solution:
            return replace(solution, notes=(*job.notes, *solution.notes), ignored=job.ignored, processes=size)

        latest: list[Solution] = []

        def keep(solution: Solution, saved: Saved) -> None:
            latest[:] = [told(solution)]
            stream.step(latest[0], saved)

        def observe(item: Iteration | Phase | str) -> None:
            stream.observe(item)
            progress(item)
            interrupt.check()

        try:
            solution = told(solve(job.model, observe, keep, before, team=team))
        except OutOfTime as reason:
            raise OutOfTime(_left(str(reason), stream.steps, job.model.solve.said(stream.time), directory)) from None
        except (Stopped, ConvergenceError) as reason:  # of a step that has no state to show
            for so_far in latest:
                stream.finish(so_far, read_origin(job.path, job.text))
            if isinstance(reason, ConvergenceError):
                raise
            raise Stopped(_left("stopped", stream.steps, job.model.solve.said(stream.time), directory)) from None
        if text := _unused(arguments.petsc):
            _say(text)
            solution = replace(solution, notes=(*solution.notes, text))
        solution = _with_overlaps(solution, job, progress)
        progress(Phase("writing results"))
        stream.finish(solution, read_origin(job.path, job.text))
    return solution, directory


def _begun(job: Job, directory: Path) -> list[Saved]:
    """The steps of another job that a job begins with; directory: where its own results go."""
    from abut.output.start import load_start

    if job.start is None:
        return []
    if job.start.results.resolve() == directory.resolve():
        raise InputError(
            f"{job.path}: start.results: that is where this job writes; give output.directory another name"
        )
    return load_start(job.start.results, job.model, job.start.share)


def _with_overlaps(solution: Solution, job: Job, progress: Callable[[str], None]) -> Solution:
    """The notes of a deck whose own contact exact contact has replaced."""
    from abut.decks.overclosure import overlaps

    found = overlaps(solution, job.own_laws)
    for text in found:
        progress(text)
    return replace(solution, notes=(*solution.notes, *found))


def _read(result: ProbeResult) -> str:
    """A probe in a line: of one point its values, of several what is farthest from zero."""
    from abut.probing.table import peaks

    values = ", ".join(f"{name} {'none' if value is None else f'{value:.6g}'}" for name, value in peaks(result).items())
    return values if len(result.points) == 1 else f"{len(result.points)} points, farthest from zero: {values}"


def _unused(options: Sequence[str]) -> str:
    """What became of options that PETSc did not ask for; empty where there are none."""
    names = unused(options) if options else []
    return (
        f"PETSc did not use {', '.join(names)}: misspelt, or without meaning for the solver that was chosen"
        if names
        else ""
    )


def _check_linear(job: Job) -> None:
    linear = job.model.solve.linear
    if processes() > 1 and linear not in ("auto", "petsc"):
        raise InputError(
            f'{job.path}: solve.linear: "{linear}" runs on one process, but {processes()} were started; take it out, or '
            'choose "petsc"'
        )


def _say(text: str) -> None:
    show(f"abut: {text}", file=sys.stderr, flush=True)


def _left(how: str, steps: int, time: str, directory: Path) -> str:
    """What a run that was stopped, ``how`` in words, leaves behind: so many steps, up to a time."""
    if not steps:
        return f"{how} before the first step converged: nothing is written"
    some = "step 1 is" if steps == 1 else f"steps 1 to {steps} are"
    return f"{how}: {some} in {directory}, up to time {time}; go on with abut run --restart"


def _failure(solution: Solution, directory: Path) -> str:
    """Where a run did not converge, and what to try."""
    from abut.diagnosis.advice import remedies, unsettled

    step = solution.steps[-1]
    places = [str(place) for place in unsettled(step)]
    where = "; ".join(places) or step.reason
    where = where or f"the residual of equilibrium is {step.iterations[-1].residual:.1e} of the forces"
    tries = "".join(f"\n  {i}. {remedy}" for i, remedy in enumerate(remedies(solution), start=1))
    before = [other.factor for other in solution.steps if other.converged]
    after = f", after time {solution.model.solve.said(before[-1])}," if before else ""
    text = f"step {step.number}{after} did not converge: {where}. The last state is in {directory}."
    return f"{text} Try{tries}" if tries else text


def _print_result(solution: Solution, directory: Path) -> None:
    from abut.contact.sides import words
    from abut.diagnosis.advice import remedies
    from abut.diagnosis.cures import cure
    from abut.report.contact_words import force, lines
    from abut.report.modes import mode_lines
    from abut.report.responses import response_lines
    from abut.solution.load_factor import factor_line, load_factors

    if not (solution.converged and solution.complete):
        last = solution.steps[-1]
        how = "" if last.converged else ", which did not converge"
        show(f"at the end of step {last.number}, time {solution.model.solve.said(last.factor)}{how}:")
    for contact in solution.contacts:
        show(
            f"contact '{contact.name}': force on {words(contact.named[0])} {force(contact)}, largest pressure "
            f"{contact.max_pressure:.6g}, area {contact.area:.6g}, largest penetration {contact.max_penetration:.2g}"
        )
        for line in lines(contact):
            show(f"  {line}")
    for name, factor in load_factors(solution).items():
        show(factor_line(name, factor))
    for result in solution.probes:
        show(f"probe '{result.name}': {_read(result)}")
    for modes in solution.modes:
        for line in mode_lines(modes):
            show(line)
    for line in response_lines(solution):
        show(line)
    show("certificate   value      limit")
    for check in solution.certificate:
        name = f"{check.contact}: {check.name}" if check.contact else check.name
        value = f"{'unknown':>9}" if check.unknown else f"{check.value:9.2e}"
        show(f"  {check.verdict}  {value}  {check.limit:9.2e}  {name}")
        if text := check.unknown or cure(check, solution):
            show(f"        {'unknown' if check.unknown else 'cure'}: {text}")
    for remedy in remedies(solution):
        show(f"  try {remedy}")
    show(
        f"{sum(solution.timings.values()):.1f} s; results in {directory}: open report.html in a browser, *.pvd in ParaView"
    )
