"""Files of shells on their mid-surfaces and of beams as lines: a VTU file a step, and a table of
the forces of each."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from abut.io.vtu import write_vtu
from abut.model import Model
from abut.output.options import Output, single
from abut.solution import Solution, Step, mid_surface
from abut.solution.beam_lines import forces, grid, known
from abut.solution.grids import Grid

SHELLS, LAMINATES, BEAMS = "shells", "laminates", "beams"
TABLE, SHELL_TABLE = "beams.csv", "shells.csv"
HEAD = [
    "step", "time", "beam", "x", "y", "z", "normal_force", "torque", "force_x", "force_y", "force_z", "moment_x", "moment_y",
    "moment_z",
]  # fmt: skip
SHELL_HEAD = [
    "step", "time", "shell", "x", "y", "z", "first_x", "first_y", "first_z", "normal_x", "normal_y", "normal_z", "n11",
    "n22", "n12", "m11", "m22", "m12", "q1", "q2",
]  # fmt: skip


def kinds(model: Model) -> list[str]:
    """What there are files of."""
    there = {SHELLS: model.mesh.shells, LAMINATES: mid_surface.laminates(model.mesh), BEAMS: known(model)}
    return [kind for kind, bodies in there.items() if bodies]


def file_of(kind: str, step: Step) -> str:
    return f"{kind}_{step.number:04d}.vtu"


def files(model: Model, steps: Sequence[Step]) -> list[str]:
    """Names of those of all steps shown, with what tells of them together."""
    found = [name for kind in kinds(model) for name in (f"{kind}.pvd", *(file_of(kind, step) for step in steps))]
    found += [SHELL_TABLE] if model.mesh.shells else []
    return [*found, TABLE] if known(model) else found


def write_step(folder: Path, model: Model, step: Step, output: Output) -> None:
    for kind in kinds(model):
        of = single(grid_of(kind, model, step))
        write_vtu(
            folder / file_of(kind, step),
            of.points,
            of.blocks,
            of.point_data,
            of.cell_data,
            raw=True,
            small=output.small,
        )


def grid_of(kind: str, model: Model, step: Step) -> Grid:
    """Shells on their mid-surfaces, or beams as lines."""
    if kind == BEAMS:
        return grid(model, step)
    shells = model.mesh.shells if kind == SHELLS else mid_surface.laminates(model.mesh)
    return mid_surface.grid(model.mesh, step, model.small_strains, shells)


def table(solution: Solution) -> str:
    """Forces across the sections of beams, a row for each, of all steps."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(HEAD)
    for step in solution.steps:
        time = step.time
        for body, of in forces(solution.model, step).items():
            parts = zip(of.points, of.normal_force, of.torque, of.force, of.moment)
            for at, normal, torque, force, moment in parts:
                numbers = [time, *at, normal, torque, *force, *moment]
                first, *rest = (f"{value:.9g}" for value in numbers)
                rows.writerow([step.number, first, body, *rest])
    return text.getvalue()


def shell_table(solution: Solution, steps: Sequence[Step]) -> str:
    """Section forces of shells and of stacks of layers, a row for each point of the mid-surface, of ``steps``: where it lay
    before it moved, first direction and normal, forces and moments per length along these."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(SHELL_HEAD)
    mesh = solution.model.mesh
    for step in steps:
        time = f"{step.time:.9g}"
        for body in (*mesh.shells, *mid_surface.laminates(mesh)):
            of = mid_surface.of_step(mesh, step, body, solution.model.small_strains)
            every = np.column_stack([of.points, of.first, of.normal, of.membrane, of.moment, of.shear])
            rows.writerows([step.number, time, body, *(f"{value:.9g}" for value in row)] for row in every.tolist())
    return text.getvalue()
