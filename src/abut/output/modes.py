"""Files of frequencies and buckling loads: a table, and the modes as arrays over the mesh."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from abut.io.atomic import write_text
from abut.io.vtu import write_vtu
from abut.solution import ModesResult, Solution
from abut.solution.modes import COMPLEX
from abut.types import Json

TABLE, SHAPES = "modes.csv", "modes.vtu"
DIAMETER = "nodal_diameter"
SINGULAR = {"frequencies": "frequency", "complex frequencies": "complex_frequency", "buckling": "buckling"}


def names(solution: Solution, bodies: bool) -> list[str]:
    """Of the files that a solution has; bodies: with those of bodies."""
    if not solution.modes:
        return []
    return [TABLE, SHAPES] if bodies else [TABLE]


def write_modes(folder: Path, solution: Solution, bodies: bool) -> None:
    """The table and, with ``bodies``, the modes as displacements whose largest component is 1. Raises InputError where the
    files cannot be written."""
    if not solution.modes:
        return
    write_text(folder / TABLE, _table(solution))
    if bodies:
        mesh = solution.model.mesh
        write_vtu(
            folder / SHAPES, mesh.points, [(b.kind, b.nodes) for b in mesh.blocks], _shapes(solution), {}, raw=True
        )


def directions(dim: int, axisymmetric: bool) -> list[str]:
    """Of the unit motions in ``ModesResult``, in short."""
    if axisymmetric:
        return ["y"]
    return ["x", "y", "rz"] if dim == 2 else ["x", "y", "z", "rx", "ry", "rz"]


def modes_summary(solution: Solution) -> Json:
    """For summary.json; empty without modes."""
    return {"modes": [_one(result) for result in solution.modes]} if solution.modes else {}


def _one(result: ModesResult) -> Json:
    found = {
        "kind": result.kind, "values": result.values.tolist(), "residual": result.residual,
        "orthogonality": result.orthogonality, "missing": result.missing,
    }  # fmt: skip
    if len(result.mass):
        found |= {
            "participation": result.participation.tolist(), "effective_mass": result.effective.tolist(),
            "mass": result.mass.tolist(),
        }  # fmt: skip
    if result.diameter:
        found["diameter"] = result.diameter
    if result.kind == COMPLEX:
        found |= {
            "orthogonality": None,
            "growth": result.growth.tolist(),
            "unstable": result.unstable.tolist(),
            "slips": result.slips,
        }
        found |= {"whirl": result.whirl.tolist()} if len(result.whirl) else {}
    return found


def _table(solution: Solution) -> str:
    along = directions(solution.model.dim, solution.model.mesh.axisymmetric)
    head = ["kind", "mode", "value", "eigenvalue"]
    if any(len(result.mass) for result in solution.modes):
        head += [f"{name}_{a}" for name in ("participation", "effective_mass") for a in along]
    if any(result.diameter for result in solution.modes):
        head.insert(1, DIAMETER)
    if any(result.kind == COMPLEX for result in solution.modes):
        head += ["growth_rate", "unstable"]
    if any(len(result.whirl) for result in solution.modes):
        head += ["whirl"]
    text = io.StringIO()
    table = csv.DictWriter(text, head, lineterminator="\n")
    table.writeheader()
    for result in solution.modes:
        for i, value in enumerate(result.values):
            row: dict[str, Any] = {
                "kind": result.kind,
                "mode": i + 1,
                "value": value,
                "eigenvalue": result.eigenvalues[i],
            }
            row |= {DIAMETER: result.diameter} if DIAMETER in head else {}
            for name, values in (("participation", result.participation), ("effective_mass", result.effective)):
                row |= {f"{name}_{a}": number for a, number in zip(along, values[i].tolist())}
            if result.kind == COMPLEX:
                row |= {"growth_rate": result.growth[i], "unstable": "yes" if result.unstable[i] else "no"}
            row |= {"whirl": result.whirl[i]} if len(result.whirl) else {}
            table.writerow(row)
    return text.getvalue()


def _shapes(solution: Solution) -> dict[str, NDArray[np.float64]]:
    arrays = {}
    for number, result in enumerate(solution.modes):
        again = sum(
            (earlier.kind, earlier.diameter) == (result.kind, result.diameter) for earlier in solution.modes[:number]
        )
        around = f"_diameter_{result.diameter}" if result.diameter else ""
        for i, shape in enumerate(result.shapes):
            name = f"{SINGULAR[result.kind]}{around}{f'_{again + 1}' if again else ''}_{i + 1:04d}"
            largest = max(float(np.abs(shape).max(initial=0.0)), 1e-300)
            arrays[name] = spatial(shape / largest)
            if len(result.imaginary):  # the motion a quarter of a period before
                arrays[f"{name}_imaginary"] = spatial(result.imaginary[i] / largest)
    return arrays


def spatial(shape: NDArray[np.float64]) -> NDArray[np.float64]:
    """Vectors (n, dim) in space, (n, 3)."""
    return np.pad(shape, ((0, 0), (0, 3 - shape.shape[1])))
