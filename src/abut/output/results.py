"""The output directory of a solution: summary, fields, contact surfaces, history, log; each file whole or not at all."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from abut import checks
from abut.diagnosis.advice import remedies, unsettled
from abut.diagnosis.cures import cure
from abut.io.atomic import write_text
from abut.io.versions import versions
from abut.io.vtu import write_vtu
from abut.output import forces, frd, modes, probes, responses, thin, vtkhdf
from abut.output.contact_rows import (
    OF_CONTACT,
    contact_labels,
    contact_summary,
    energy_columns,
    energy_row,
    energy_summary,
    friction_columns,
    more_columns,
    more_values,
    number,
)
from abut.output.earlier import INDEX, OPTIONAL, remove_others
from abut.output.fields import WriteFields, found_name, is_whole, write_fields
from abut.output.lock import Lock
from abut.output.options import EVERYTHING, Output, single
from abut.report import Origin, write_report
from abut.solution import ConnectorResult, PenetrationResult, PreloadResult, Solution, Step
from abut.solution.grids import contact_grid
from abut.solution.load_factor import load_factors
from abut.types import Json


def write(
    solution: Solution,
    directory: str | Path,
    origin: Origin | None = None,
    steps: Sequence[Step] | None = None,
    fields: WriteFields = write_fields,
    output: Output = EVERYTHING,
) -> Path:
    """Write everything about a solution to a directory, which is created if needed.

    report.html, summary.json, history.csv, forces.csv, run.jsonl; fields.pvd with a VTU file a step; contact_NAME.pvd
    likewise for each contact; probe_NAME.csv for each probe; modes.csv and modes.vtu where the model asks for modes,
    harmonic.csv, transient.csv and response.vtu for responses;
    fields.frd, fields.vtkhdf and contact_NAME.vtkhdf where ``output`` asks for them; shells.pvd, and beams.pvd with
    beams.csv, where there are any.

    Parameters
    ----------
    solution : Solution
        What is written.
    directory : str or Path
        Where to; results of an earlier run there give way.
    origin : abut.report.Origin, optional
        Name, text and reference values of the job, for the report.
    steps : sequence of Step, optional
        Those whose VTU files are still to be written; all of them where left out.
    fields : callable, optional
        What writes the fields of a step.
    output : Output
        Which steps and fields have files, and in which formats.

    Returns
    -------
    Path
        The directory.

    Raises
    ------
    InputError
        Where the directory cannot be written, or a run writes there.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> import abut
    >>> from abut.mesh import make
    >>> bar = abut.Model(
    ...     make.join({"bar": make.rectangle([0, 2], [0, 1], cells=[2, 1])}),
    ...     plane="stress",
    ...     solids=[abut.Solid("bar", abut.LinearElastic(100.0, 0.3))],
    ...     supports=[abut.Support("bar.left", x=0), abut.Support("bar.bottom", y=0)],
    ...     loads=[abut.Traction("bar.right", (1.0, 0.0))],
    ... )
    >>> with TemporaryDirectory() as folder:
    ...     sorted(path.name for path in abut.write(abut.solve(bar), folder).iterdir())
    ['fields.pvd', 'fields_0001.vtu', 'forces.csv', 'history.csv', 'report.html', 'run.jsonl', 'summary.json']
    """
    checks.instance(solution, Solution, "write", "a solution (abut.Solution)")
    folder = checks.path(directory, "write: directory")
    checks.function(fields, "write: fields")
    checks.instance(output, Output, "write: output", "what is written (abut.Output)")
    if origin is not None:
        checks.instance(origin, Origin, "write: origin", "an origin (abut.report.Origin)")
    if steps is not None:
        checks.records(steps, "write: steps", (Step,))
    lock = Lock(folder)
    try:
        return write_held(solution, folder, origin, steps, fields, output)
    finally:
        lock.release(empty=True)


def write_held(
    solution: Solution,
    folder: Path,
    origin: Origin | None,
    steps: Sequence[Step] | None,
    fields: WriteFields,
    output: Output,
) -> Path:
    """``write`` to a directory that the caller holds the lock of."""
    write_steps(folder, solution, solution.steps if steps is None else steps, fields, output)
    write_index(folder, solution, output)
    shown = [step for step in solution.steps if _wanted(solution, step, output, True)]
    if output.frd:
        frd.write(folder, solution, shown, output)
    vtkhdf.write(folder, solution, shown, output)
    modes.write_modes(folder, solution, output.bodies)
    responses.write_responses(folder, solution, output.bodies)
    own = [*modes.names(solution, output.bodies), *responses.names(solution, output.bodies)]
    mine = [*own, *([frd.FILE] if output.frd else []), *vtkhdf.files(solution, output)]
    index = [name for name in INDEX if name not in OPTIONAL]
    remove_others(folder, len(solution.steps), [*index, *mine, *_files(solution, shown, output)])
    write_report(solution, folder / "report.html", origin or Origin(folder.absolute().name))
    return folder


def write_steps(
    folder: Path, solution: Solution, steps: Sequence[Step], fields: WriteFields, output: Output, final: bool = True
) -> None:
    """The VTU files of those of some steps that ``output`` names; final: there are no steps to come."""
    for step in steps:
        if not _wanted(solution, step, output, final):
            continue
        if output.bodies:
            fields(folder, solution.model, step, output)
            thin.write_step(folder, solution.model, step, output)
        for contact, name in zip(step.contacts, _contact_files(step)) if output.contacts else ():
            grid = single(contact_grid(step, contact))
            path = folder / name
            write_vtu(path, grid.points, grid.blocks, grid.point_data, grid.cell_data, raw=True, small=output.small)


def _wanted(solution: Solution, step: Step, output: Output, final: bool) -> bool:
    return output.wants(step.number, final and step.number == solution.steps[-1].number)


def write_index(folder: Path, solution: Solution, output: Output, final: bool = True) -> None:
    """The files that tell of all steps; ``output`` and ``final`` as in ``write_steps``."""
    shown = [step for step in solution.steps if _wanted(solution, step, output, final)]
    if output.bodies:
        _write_collection(folder, "fields", shown, [found_name(folder, step.number) for step in shown])
        for kind in thin.kinds(solution.model):
            _write_collection(folder, kind, shown, [thin.file_of(kind, step) for step in shown])
    files = [_contact_files(step) for step in shown]
    for index, label in enumerate(contact_labels(solution.steps[-1]) if output.contacts else ()):
        _write_collection(folder, label, shown, [names[index] for names in files])
    write_text(folder / forces.FILE, forces.table(solution))
    if thin.TABLE in _files(solution, shown, output):
        write_text(folder / thin.TABLE, thin.table(solution))
    if thin.SHELL_TABLE in _files(solution, shown, output):
        write_text(folder / thin.SHELL_TABLE, thin.shell_table(solution, shown))
    for index, name in enumerate(probes.table_names([probe.name for probe in solution.model.probes])):
        write_text(folder / name, probes.table(solution.steps, index, solution.model.probes[index].steps))
    write_text(folder / "history.csv", _history(solution))
    write_text(folder / "run.jsonl", _log(solution))
    write_text(folder / "summary.json", json.dumps(summary(solution), indent=2, allow_nan=False) + "\n")


def summary(solution: Solution) -> Json:
    """What summary.json holds: plain numbers, lists and text; None where a number does not exist."""
    return {
        "schema": 1,
        "status": status(solution),
        "dofs": solution.dofs,
        "solver": solution.solver,
        "processes": solution.processes,
        "steps": [{**_step_summary(step), "time": step.time} for step in solution.steps],
        **modes.modes_summary(solution),
        **responses.responses_summary(solution),
        **_load_factors(solution),
        "certificate": {
            "passed": all(check.passed for check in solution.certificate),
            "checks": [
                {
                    "contact": check.contact,
                    "name": check.name,
                    "value": number(check.value),
                    "limit": check.limit,
                    "passed": check.passed,
                    "verdict": check.verdict,
                    "meaning": check.meaning,
                    "cure": cure(check, solution),
                }
                for check in solution.certificate
            ],
        },
        "remedies": [str(remedy) for remedy in remedies(solution)],
        "notes": list(solution.notes),
        "ignored": list(solution.ignored),
        "timings": {name: round(seconds, 6) for name, seconds in solution.timings.items()},
        "versions": versions(),
    }


def _load_factors(solution: Solution) -> Json:
    """At the end of the last step; nothing without preloads."""
    found = load_factors(solution) if solution.model.preloads else {}
    return {"load_factors": {name: vars(factor) for name, factor in found.items()}} if found else {}


def status(solution: Solution) -> str:
    """ "converged", "not converged", or "incomplete" where steps are still to come."""
    if not solution.converged:
        return "not converged"
    return "converged" if solution.complete else "incomplete"


def is_written(folder: Path, solution: Solution, step: Step, output: Output = EVERYTHING) -> bool:
    """Whether all files of a step are there that ``output`` names."""
    names = _contact_files(step) if output.contacts else []
    names += [thin.file_of(kind, step) for kind in thin.kinds(solution.model)] if output.bodies else []
    whole = is_whole(folder, step.number) or not output.bodies
    return whole and all((folder / name).is_file() for name in names)


def _files(solution: Solution, shown: Sequence[Step], output: Output) -> list[str]:
    """Names of all files of contacts, in the steps shown, and of probes."""
    tables = probes.table_names([probe.name for probe in solution.model.probes])
    if output.bodies:
        tables += thin.files(solution.model, shown)
    if not output.contacts:
        return tables
    collections = [f"{label}.pvd" for label in contact_labels(solution.steps[-1])]
    return [*tables, *collections, *(name for step in shown for name in _contact_files(step))]


def _contact_files(step: Step) -> list[str]:
    return [f"{label}_{step.number:04d}.vtu" for label in contact_labels(step)]


def _step_summary(step: Step) -> Json:
    last = step.iterations[-1]
    return {
        "step": step.number,
        "factor": step.factor,
        "converged": step.converged,
        "iterations": len(step.iterations),
        "residual": last.residual,
        "contact_residual": last.contact_residual,
        "reaction": step.reaction.tolist(),
        "reactions": {name: force.tolist() for name, force in step.reactions.items()},
        "moments": {name: moment.tolist() for name, moment in step.moments.items()},
        "load": step.load.tolist(),
        "balance_error": step.balance_error,
        "max_displacement": float(np.linalg.norm(step.displacement, axis=1).max()),
        "contacts": [
            {**contact_summary(c), "file": f"{label}.pvd"} for c, label in zip(step.contacts, contact_labels(step))
        ],
        **energy_summary(step),
        **_stress_error(step),
        **_flow(step),
        "rigid": {
            body: {name: value.tolist() for name, value in vars(result).items()} for body, result in step.rigid.items()
        },
        **_carried(step),
        "probes": probes.summary(step),
        "cycling": {name: facets.tolist() for name, facets in step.cycling.items()},
        "unsettled": [
            {
                "contact": place.contact,
                "facets": place.facets.tolist(),
                "nodes": place.nodes.tolist(),
                "coordinates": place.coordinates.tolist(),
            }
            for place in unsettled(step)
        ],
    }


def _carried(step: Step) -> Json:
    """What preloads, connectors, springs and fluids exert, where there are any."""
    every = {
        "preloads": {name: _numbers(result) for name, result in step.preloads.items()},
        "connectors": {name: _numbers(result) for name, result in step.connectors.items()},
        "springs": {name: force.tolist() for name, force in step.springs.items()},
        "penetrations": {name: _numbers(result) for name, result in step.penetrations.items()},
    }
    return {name: results for name, results in every.items() if results}


def _numbers(result: PreloadResult | PenetrationResult | ConnectorResult) -> Json:
    return {name: value.tolist() if isinstance(value, np.ndarray) else value for name, value in vars(result).items()}


def _flow(step: Step) -> Json:
    flow = step.flow
    if flow is None:
        return {}
    return {"flow": {"largest": flow.largest, "body": flow.body, "place": flow.place.tolist(), "work": flow.work}}


def _stress_error(step: Step) -> Json:
    error = step.stress_error
    if error is None:
        return {}
    near = [
        {"contact": e.contact, "body": e.body, "error": e.error, "size": e.size, "wanted": e.wanted} for e in error.near
    ]
    return {"stress_error": {"whole": error.whole, "energy": error.energy, "near_contact": near}}


def _history(solution: Solution) -> str:
    dim = solution.model.dim
    axes, turns = "xyz"[:dim], "xyz" if dim == 3 else "z"
    head = ["step", "factor", "converged", "contact", *(f"force_{a}" for a in axes), *OF_CONTACT]
    if solution.model.referenced:
        head += ["rigid", *(f"displacement_{a}" for a in axes)]
        head += [f"{name}_{a}" for name in ("rotation", "moment") for a in turns]
    head += [name for name in probes.history_columns(solution.steps) if name not in head]
    head += more_columns(dim)
    if any(c.friction is not None for step in solution.steps for c in step.contacts):
        head += friction_columns(dim)
    if any(step.energy is not None for step in solution.steps):
        head += energy_columns(solution.model.finite)
    text = io.StringIO()
    table = csv.DictWriter(text, head, lineterminator="\n")
    table.writeheader()
    for step in solution.steps:
        common = {"step": step.number, "factor": step.factor, "converged": int(step.converged)}
        rows_of_step, energy = _step_rows(step, dim), energy_row(step)
        for i, row in enumerate(rows_of_step or ([{}] if energy else [])):
            table.writerow({**common, **row, **(energy if i == 0 else {})})
    return text.getvalue()


def _step_rows(step: Step, dim: int) -> list[dict[str, Any]]:
    """Rows of history.csv of one step: contacts, rigid bodies, probes."""
    axes, turns = "xyz"[:dim], "xyz" if dim == 3 else "z"

    def named(name: str, values: NDArray[np.float64]) -> dict[str, float]:
        along = turns if name in ("rotation", "moment") else axes
        return {f"{name}_{axis}": value for axis, value in zip(along, values.tolist())}

    rows: list[dict[str, Any]] = []
    for c in step.contacts:
        values = {name: getattr(c, name) for name in OF_CONTACT} | more_values(c)
        rows.append({"contact": c.name, **named("force", c.force), **values})
    for name, body in step.rigid.items():
        rows.append({"rigid": name, **{k: v for key, each in vars(body).items() for k, v in named(key, each).items()}})
    return [*rows, *probes.history_rows(step)]


def _log(solution: Solution) -> str:
    lines: list[Json] = [{"note": note} for note in solution.notes]
    lines += [row.row for step in solution.steps for row in step.iterations]
    return "".join(json.dumps(line) + "\n" for line in lines)


def _write_collection(folder: Path, stem: str, steps: Sequence[Step], files: Sequence[str]) -> None:
    entries = "".join(
        f'    <DataSet timestep="{step.time:.12g}" part="0" file="{file}"/>\n' for step, file in zip(steps, files)
    )
    write_text(
        folder / f"{stem}.pvd",
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n  <Collection>\n'
        f"{entries}  </Collection>\n</VTKFile>\n",
    )
