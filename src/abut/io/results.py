"""The output directory of a solution: summary, fields, contact surfaces, history, log; each file whole or not at all."""

from __future__ import annotations

import csv
import io
import json
import math
import platform
import re
from pathlib import Path
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

import abut
from abut.cells import BY_CODE, CELLS
from abut.io.atomic import make_directory, write_text
from abut.io.vtu import write_vtu
from abut.mesh.surface import Surface
from abut.state import ContactResult, Solution, Step

NOT_COVERED, OPEN, CLOSED = 0, 1, 2


def write(solution: Solution, directory: str | Path) -> Path:
    """Write everything about a solution to ``directory`` (made if need be) and return it.

    summary.json, history.csv, run.jsonl; fields.pvd with a VTU file a step; contact_NAME.pvd likewise for each contact.
    Raises InputError where the directory cannot be written.
    """
    folder = Path(directory)
    make_directory(folder)
    for step in solution.steps:
        _write_fields(folder, solution, step)
        for contact in step.contacts:
            _write_contact(folder, step, contact)
    _write_collection(folder, "fields", solution)
    for contact in solution.contacts:
        _write_collection(folder, f"contact_{file_name(contact.name)}", solution)
    write_text(folder / "history.csv", _history(solution))
    write_text(folder / "run.jsonl", _log(solution))
    write_text(folder / "summary.json", json.dumps(summary(solution), indent=2, allow_nan=False) + "\n")
    return folder


def file_name(name: str) -> str:
    """A contact's name as part of a file name."""
    return re.sub(r"[^A-Za-z0-9._-]+", "_", name)


def summary(solution: Solution) -> dict[str, Any]:
    """What summary.json holds: plain numbers, lists and text; None where a number does not exist."""
    return {
        "schema": 1,
        "status": "converged" if solution.converged else "not converged",
        "dofs": solution.dofs,
        "solver": solution.solver,
        "steps": [_step_summary(step) for step in solution.steps],
        "certificate": {
            "passed": all(check.passed for check in solution.certificate),
            "checks": [
                {
                    "contact": check.contact,
                    "name": check.name,
                    "value": _number(check.value),
                    "limit": check.limit,
                    "passed": check.passed,
                    "meaning": check.meaning,
                }
                for check in solution.certificate
            ],
        },
        "notes": list(solution.notes),
        "ignored": list(solution.ignored),
        "timings": {name: round(seconds, 6) for name, seconds in solution.timings.items()},
        "versions": {
            "abut": abut.__version__,
            "numpy": np.__version__,
            "scipy": scipy.__version__,
            "python": platform.python_version(),
        },
    }


def _step_summary(step: Step) -> dict[str, Any]:
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
        "load": step.load.tolist(),
        "balance_error": step.balance_error,
        "max_displacement": float(np.linalg.norm(step.displacement, axis=1).max()),
        "contacts": [
            {
                "name": c.name,
                "force": c.force.tolist(),
                "max_pressure": _number(c.max_pressure),
                "area": c.area,
                "max_penetration": c.max_penetration,
                "active": c.active,
                "multipliers": c.multipliers,
                "removed": c.removed,
                "segments": c.segments,
                "covered_share": c.covered_share,
            }
            for c in step.contacts
        ],
        "rigid": {
            body: {name: value.tolist() for name, value in vars(result).items()} for body, result in step.rigid.items()
        },
        "cycling": {name: facets.tolist() for name, facets in step.cycling.items()},
    }


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _history(solution: Solution) -> str:
    dim = solution.model.dim
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    force = [f"force_{a}" for a in "xyz"[:dim]]
    turn = [a for a in "xyz" if dim == 3 or a == "z"]
    moving = ["rigid", *(f"displacement_{a}" for a in "xyz"[:dim]), *(f"rotation_{a}" for a in turn)]
    moving = [*moving, *(f"moment_{a}" for a in turn)] if solution.model.rigid else []
    of_contact = ["max_pressure", "area", "max_penetration", "active"]
    table.writerow(["step", "factor", "converged", "contact", *force, *of_contact, *moving])
    for step in solution.steps:
        for c in step.contacts:
            row = [step.number, step.factor, int(step.converged), c.name, *c.force.tolist()]
            row += [c.max_pressure, c.area, c.max_penetration, c.active]
            table.writerow([*row, *[""] * len(moving)])
        for name, body in step.rigid.items():
            row = [step.number, step.factor, int(step.converged), "", *body.force.tolist(), *[""] * len(of_contact)]
            table.writerow([*row, name, *body.displacement.tolist(), *body.rotation.tolist(), *body.moment.tolist()])
    return text.getvalue()


def _log(solution: Solution) -> str:
    lines = [{"note": note} for note in solution.notes]
    lines += [dict(vars(row)) for step in solution.steps for row in step.iterations]
    return "".join(json.dumps(line) + "\n" for line in lines)


def von_mises(stress: NDArray[np.float64]) -> NDArray[np.float64]:
    """Von Mises stress of (n, 6) stresses xx yy zz xy yz zx."""
    xx, yy, zz, xy, yz, zx = stress.T
    return np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * (xy**2 + yz**2 + zx**2))


def _vectors(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Two-dimensional vectors with a zero third component, as ParaView wants them."""
    return np.pad(values, ((0, 0), (0, 3 - values.shape[1])))


def _write_fields(folder: Path, solution: Solution, step: Step) -> None:
    mesh = solution.model.mesh
    body = np.zeros(mesh.n_cells, dtype=np.int32)
    for number, cells in enumerate(mesh.bodies.values()):
        body[cells] = number
    write_vtu(
        folder / f"fields_{step.number:04d}.vtu",
        mesh.points,
        [(block.kind, block.nodes) for block in mesh.blocks],
        {
            "displacement": _vectors(step.displacement),
            "stress": step.stress,
            "von_mises": von_mises(step.stress),
        },
        {"body": body},
    )


def _write_contact(folder: Path, step: Step, contact: ContactResult) -> None:
    parts = []
    sides = ((contact.contactor, contact.pressure, contact.gap, 0), (contact.target, contact.target_pressure, None, 1))
    for surface, pressure, gap, side in sides:
        closed = np.nan_to_num(pressure).max(axis=1) > 0.0
        if side == 0:
            status = np.where(contact.covered, np.where(closed, CLOSED, OPEN), NOT_COVERED)
        else:
            status = np.where(closed, CLOSED, OPEN)
        parts += _loose_facets(surface, step.displacement, pressure, gap, status.astype(np.int32), side)
    first = 0
    blocks, points, data, cells = [], [], [], []
    for kind, x, values, own in parts:
        n = CELLS[kind].nodes
        blocks.append((kind, first + np.arange(len(x)).reshape(-1, n)))
        first += len(x)
        points.append(x)
        data.append(values)
        cells.append(own)
    write_vtu(
        folder / f"contact_{file_name(contact.name)}_{step.number:04d}.vtu",
        np.concatenate(points),
        blocks,
        {k: np.concatenate([d[k] for d in data]) for k in data[0]},
        {k: np.concatenate([c[k] for c in cells]) for k in cells[0]},
    )


def _loose_facets(
    surface: Surface,
    displacement: NDArray[np.float64],
    pressure: NDArray[np.float64],
    gap: NDArray[np.float64] | None,
    status: NDArray[np.int32],
    side: int,
) -> list[tuple[str, NDArray[np.float64], dict[str, NDArray[Any]], dict[str, NDArray[Any]]]]:
    """Facets by type, each with points of its own, so that a pressure may jump between them."""
    result = []
    for code in np.unique(surface.kinds):
        kind = BY_CODE[code]
        own = np.flatnonzero(surface.kinds == code)
        nodes = surface.nodes[own, : kind.nodes].ravel()
        values = {
            "pressure": np.nan_to_num(pressure[own, : kind.nodes]).ravel(),
            "gap": np.full(len(nodes), np.nan) if gap is None else gap[own, : kind.nodes].ravel(),
            "displacement": _vectors(displacement[nodes]),
        }
        cells = {"status": status[own], "side": np.full(len(own), side, dtype=np.int32)}
        result.append((kind.name, surface.points[nodes], values, cells))
    return result


def _write_collection(folder: Path, stem: str, solution: Solution) -> None:
    files = "".join(
        f'    <DataSet timestep="{step.factor:.12g}" part="0" file="{stem}_{step.number:04d}.vtu"/>\n'
        for step in solution.steps
    )
    write_text(
        folder / f"{stem}.pvd",
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n  <Collection>\n'
        f"{files}  </Collection>\n</VTKFile>\n",
    )
