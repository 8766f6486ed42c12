"""abut check: errors of a job and how to correct them, before it is solved."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from abut.cli.run import add_ignore, add_set
from abut.cli.terminal import shortened, show
from abut.errors import AbutError

if TYPE_CHECKING:
    from abut.diagnosis import Report
    from abut.job import Job


def add_check(commands: Any) -> None:
    """Add the command to the parser's ``commands``."""
    check = commands.add_parser(
        "check",
        help="check a job without solving it",
        description="Rigid-body modes, over-constraint, gaps, normals, mesh, units of a job: each finding with its remedy.",
        epilog="exit status: 0 no errors; 2 bad input; 4 no unique solution",
    )
    check.add_argument("job", type=Path, help="the job file or deck")
    add_ignore(check)
    add_set(check)
    check.add_argument("--json", action="store_true", help="print the findings as JSON")
    check.add_argument("--output", type=Path, metavar="DIR", help="write the free rigid-body modes to DIR/motions.vtu")
    check.add_argument(
        "--write-pairs", type=Path, metavar="OUT", help="write the job to OUT with all pairs that auto = true finds"
    )
    check.add_argument("--debug", action="store_true", help="print the traceback of an internal error")
    check.set_defaults(command=_check)


def _check(arguments: argparse.Namespace) -> int:
    from abut.analysis.taken import require_fit
    from abut.diagnosis import Finding, Report, check, from_error
    from abut.diagnosis.earlier import sizes_wanted
    from abut.diagnosis.finding import in_order
    from abut.diagnosis.results_folder import results_folder
    from abut.job import load_job
    from abut.job.load import DECK
    from abut.job.pairs import write_pairs
    from abut.job.parameters import read_settings
    from abut.output.start import load_start

    try:
        job = load_job(
            arguments.job, ignore=arguments.ignore, soft=arguments.soft_contact, settings=read_settings(arguments.set)
        )
    except AbutError as error:
        report = Report((from_error(error, "job"),))
        _print(report, arguments.json)
        return report.status
    report = check(job.model)
    if job.start is not None:
        try:
            begun = load_start(job.start.results, job.model, job.start.share)
            if report.count("error") == 0:
                require_fit(begun, job.model)
        except AbutError as error:
            report = Report(in_order([from_error(error, "start"), *report.findings]), report.motions)
    where = "deck" if job.path.suffix.lower() == DECK else "notes"
    found = tuple(Finding("info", where, note) for note in job.notes)
    of_results = (*results_folder(job.directory), *sizes_wanted(job.directory))
    report = Report(in_order([*report.findings, *of_results, *found]), report.motions)
    if arguments.output is not None:
        _write_motions(arguments.output, job, report)
    if arguments.write_pairs is not None:
        write_pairs(job, arguments.write_pairs)
    _print(report, arguments.json)
    return report.status


def _print(report: Report, as_json: bool) -> None:
    if as_json:
        findings = [
            {"severity": f.severity, "where": f.where, "what": f.what, "cure": f.cure, "details": list(f.details)}
            for f in report.findings
        ]
        motions = [{"motion": m.text, "resisted_by": m.resisted_by} for m in report.motions]
        show(json.dumps({"schema": 1, "status": report.status, "findings": findings, "motions": motions}, indent=2))
        return
    for finding in report.findings:
        show(shortened(f"{finding.severity:8s} {finding.line}"))
        for line in finding.details:
            show(f"           {line}")
    counts = [(report.count(severity), severity) for severity in ("error", "warning", "advice")]
    said = [f"{n} {severity}{'s' if n > 1 and severity != 'advice' else ''}" for n, severity in counts if n]
    show(", ".join(said) or "no problems found")


def _write_motions(directory: Path, job: Job, report: Report) -> None:
    """One file with a displacement field for each motion: warp by vector in ParaView."""
    import numpy as np

    from abut.io.atomic import make_directory
    from abut.io.vtu import write_vtu

    mesh = job.model.mesh
    make_directory(directory)
    fields = {
        f"{number + 1}: {motion.text} (constrained by {motion.resisted_by})": np.pad(
            motion.displacement, ((0, 0), (0, 3 - mesh.dim))
        )
        for number, motion in enumerate(report.motions)
    }
    write_vtu(directory / "motions.vtu", mesh.points, [(block.kind, block.nodes) for block in mesh.blocks], fields)
