"""Files of vibrations under loads: a table of each over frequency or time, and displacements over the mesh."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from abut.io.atomic import write_text
from abut.io.vtu import write_vtu
from abut.output.modes import spatial
from abut.solution import ResponseResult, Solution
from abut.solution.responses import AXIS, HARMONIC, labels
from abut.types import Json

FIELDS = "response.vtu"
MOST = 20  # tables of a kind that are known by name
TABLES = tuple(f"{kind}{'' if i == 1 else f'_{i}'}.csv" for kind in AXIS for i in range(1, MOST + 1))


def tables(solution: Solution) -> list[str]:
    """Names of the tables, one for each response."""
    return [f"{label}.csv" for label in labels(solution.responses)]


def names(solution: Solution, bodies: bool) -> list[str]:
    """Of the files that a solution has; bodies: with those of bodies."""
    kept = bodies and any(len(result.fields_at) for result in solution.responses)
    return [*tables(solution), *([FIELDS] if kept else [])]


def write_responses(folder: Path, solution: Solution, bodies: bool) -> None:
    """Tables and, with ``bodies``, displacements that are kept. Raises InputError where files cannot be written."""
    mine = names(solution, bodies)
    for name, result in zip(mine, solution.responses):
        write_text(folder / name, table(result, solution.model.dim))
    if FIELDS in mine:
        mesh = solution.model.mesh
        blocks = [(b.kind, b.nodes) for b in mesh.blocks]
        write_vtu(folder / FIELDS, mesh.points, blocks, _fields(solution.responses), {}, raw=True)


def responses_summary(solution: Solution) -> Json:
    """For summary.json; empty without responses."""
    return {"responses": [_one(r, file) for r, file in zip(solution.responses, tables(solution))]} if (
        solution.responses) else {}  # fmt: skip


def _one(result: ResponseResult, file: str) -> Json:
    place = int(np.argmax(result.largest))
    return {
        "kind": result.kind, "file": file, "points": len(result.at), "damping": result.damping.tolist(),
        "largest": float(result.largest[place]), f"largest_at_{AXIS[result.kind]}": float(result.at[place]),
        "left_out": None if np.isnan(result.left_out) else result.left_out,
    }  # fmt: skip


def table(result: ResponseResult, dim: int) -> str:
    """Rows: over all nodes the largest displacement, then each point of each probe. Harmonic: amplitudes, and phases in
    degrees by which displacements are ahead of the loads."""
    harmonic, axes = result.kind == HARMONIC, "xyz"[:dim]
    values = [f"{a}_{what}" for a in axes for what in ("amplitude", "phase")] if harmonic else list(axes)
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow([AXIS[result.kind], "largest", *(["probe", "point", "node", *values] if result.probes else [])])
    for i, at in enumerate(result.at.tolist()):
        head = [at, float(result.largest[i])]
        if not result.probes:
            rows.writerow(head)
        for probe in result.probes:
            for number, vector in enumerate(probe.displacement[i]):
                node = "" if probe.nodes is None else int(probe.nodes[number])
                pairs = np.column_stack([np.abs(vector), np.degrees(np.angle(vector))]) if harmonic else vector
                rows.writerow([*head, probe.name, number + 1, node, *np.ravel(pairs).tolist()])
    return text.getvalue()


def _fields(results: Sequence[ResponseResult]) -> dict[str, NDArray[np.float64]]:
    arrays: dict[str, Any] = {}
    for label, result in zip(labels(results), results):
        for at, field in zip(result.fields_at, result.fields):
            name = f"{label}_{at:.6g}"
            arrays[name] = spatial(field.real)
            if result.kind == HARMONIC:  # the motion a quarter of a period before
                arrays[f"{name}_imaginary"] = spatial(field.imag)
    return arrays
