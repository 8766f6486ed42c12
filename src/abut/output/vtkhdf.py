"""Results of all steps in one VTKHDF file for the bodies and one for each contact, as in the VTU files of single steps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from abut.io.vtkhdf import Data, write_vtkhdf
from abut.model import Model
from abut.output import thin
from abut.output.contact_rows import contact_labels
from abut.output.options import Output, single
from abut.solution import Solution, Step
from abut.solution.grids import Grid, cell_error, contact_grid, field_grid

FIELDS = "fields"
ENDING = ".vtkhdf"


def write(folder: Path, solution: Solution, steps: Sequence[Step], output: Output) -> None:
    """Write what ``output`` names of some steps, at their times. Raises InputError where a file cannot be written."""
    if not steps:
        return
    times = [step.factor * solution.model.solve.end for step in steps]
    for label, grid in _grids(solution, output).items():

        def data(number: int, grid: Callable[[Step], Grid] = grid) -> Data:
            now = grid(steps[number])
            return now.point_data, now.cell_data

        bodies = {"body_names": list(solution.model.mesh.bodies)} if label == FIELDS else {}
        first = grid(steps[0])  # bodies and surfaces keep their points and cells: displacements are data
        write_vtkhdf(folder / f"{label}{ENDING}", first.points, first.blocks, times, data, bodies)


def files(solution: Solution, output: Output) -> list[str]:
    """Their names."""
    return [f"{label}{ENDING}" for label in _grids(solution, output)]


def _grids(solution: Solution, output: Output) -> dict[str, Callable[[Step], Grid]]:
    """What is in each file, by the name of the file."""
    model = solution.model
    found: dict[str, Callable[[Step], Grid]] = {}
    if not output.vtkhdf:
        return found
    if output.body_fields:
        found[FIELDS] = partial(_bodies, model, output)
        found |= {kind: partial(_thin, kind, model) for kind in thin.kinds(model)}
    if output.contact_fields:
        found |= {label: partial(_contact, i) for i, label in enumerate(contact_labels(solution.steps[-1]))}
    return found


def _bodies(model: Model, output: Output, step: Step) -> Grid:
    return output.of_bodies(field_grid(model.mesh, step.displacement, step.stress, cell_error(step), step.remembered))


def _thin(kind: str, model: Model, step: Step) -> Grid:
    return single(thin.grid_of(kind, model, step))


def _contact(index: int, step: Step) -> Grid:
    return single(contact_grid(step, step.contacts[index]))
