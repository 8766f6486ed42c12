"""Results as CalculiX writes them, fields.frd, for CalculiX GraphiX and other readers of that format."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from abut.io.frd import TENSOR, VECTOR, Dataset, Increment, write_frd
from abut.materials.plastic import EQUIVALENT, WORK
from abut.materials.prestressed import INITIAL
from abut.output.options import CONTACT, MATERIAL, Output
from abut.solution import Solution, Step
from abut.solution.grids import CONTACTOR, TARGET, contact_grid, vectors

FILE = "fields.frd"
STRESS = ("SXX", "SYY", "SZZ", "SXY", "SYZ", "SZX")
NAMES = {EQUIVALENT: "PE", WORK: "PWORK", "plastic_strain": "PSTRAIN", INITIAL: "ISTRESS"}  # of what materials remember
STRAINS = {"plastic_strain": ("EPXX", "EPYY", "EPZZ", "EPXY", "EPYZ", "EPZX")}  # whose shear is doubled
LONGEST = 8  # characters of a name


def write(folder: Path, solution: Solution, steps: Sequence[Step], output: Output) -> None:
    """Write what ``output`` names of some steps, each as an increment. Raises InputError where it cannot be
    written."""
    mesh = solution.model.mesh
    body = np.zeros(mesh.n_cells, dtype=np.int64)
    for number, cells in enumerate(mesh.bodies.values()):
        body[cells] = number
    blocks = [(block.kind, block.nodes) for block in mesh.blocks]
    increments = (Increment(step.number, step.time, tuple(datasets(step, output))) for step in steps)
    write_frd(folder / FILE, mesh.points, blocks, body, list(mesh.bodies), increments)


def datasets(step: Step, output: Output) -> Iterator[Dataset]:
    """What is known at points at the end of a step: displacement DISP, STRESS, what materials remember (plastic strain with
    shear as in a tensor, not doubled), and of contacts the opening and pressure at nodes of contactors (CONTACT), the
    pressure on both sides (CPRESS), with friction traction and slip in all (CSHEAR, CSLIP)."""
    every = np.arange(len(step.displacement))
    if "displacement" in output.fields:
        yield Dataset("DISP", ("D1", "D2", "D3"), every, vectors(step.displacement))
    if "stress" in output.fields:
        yield Dataset("STRESS", STRESS, every, step.stress)
    if MATERIAL in output.fields:
        for name, values in step.remembered.items():
            yield _remembered(name, values.reshape(len(every), -1))
    if CONTACT in output.fields and step.contacts:
        yield from _contacts(step)


def _remembered(name: str, values: NDArray[np.float64]) -> Dataset:
    short = NAMES.get(name, name.upper()[:LONGEST])
    width = values.shape[1]
    if name in STRAINS:
        values = values * np.repeat([1.0, 0.5], 3)
    numbered = tuple(f"{short[: LONGEST - len(str(width))]}{i}" for i in range(1, width + 1)) if width > 1 else (short,)
    plain = width in (VECTOR, TENSOR) and name not in STRAINS
    return Dataset(short, STRAINS.get(name, numbered), np.arange(len(values)), values, plain)


def _contacts(step: Step) -> Iterator[Dataset]:
    """Of all contacts together; a node of several shows the one that presses most, or is open least."""
    every = range(len(step.contacts))
    nodes, values = _most([_at_nodes(step, i, ("pressure", "gap"), (CONTACTOR,)) for i in every])
    yield Dataset("CONTACT", ("COPEN", "CPRESS"), nodes, values[:, ::-1])
    nodes, values = _most([_at_nodes(step, i, ("pressure", "pressure")) for i in every])
    yield Dataset("CPRESS", ("CPRESS",), nodes, values[:, :1])
    rubbing = [i for i in every if step.contacts[i].friction is not None]
    for name, of in (("CSHEAR", "traction"), ("CSLIP", "total_slip")) if rubbing else ():
        nodes, values = _most([_at_nodes(step, i, ("pressure", "gap", of), (CONTACTOR,)) for i in rubbing])
        yield Dataset(name, tuple(f"{name}{axis}" for axis in "XYZ"), nodes, values[:, 2:])


def _most(tables: Sequence[NDArray[np.float64]]) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Of rows of a node, its pressure, its gap and more: nodes that have a gap, and of each the row of the largest pressure
    and, where that is the same, of the smallest gap."""
    rows = np.concatenate(tables)
    rows = rows[np.isfinite(rows[:, 2])]
    rows = rows[np.lexsort((rows[:, 2], -rows[:, 1], rows[:, 0]))]
    nodes, first = np.unique(rows[:, 0].astype(np.int64), return_index=True)
    return nodes, rows[first, 1:]


def _at_nodes(
    step: Step, index: int, names: tuple[str, ...], sides: tuple[int, ...] = (CONTACTOR, TARGET)
) -> NDArray[np.float64]:
    """Rows of a node's number and its values, where facets differ the mean of theirs; NaN where there are none."""
    grid = contact_grid(step, step.contacts[index], sides)
    nodes, place = np.unique(grid.point_data["node"], return_inverse=True)
    columns = [nodes.astype(np.float64)]
    for name in names:
        for values in grid.point_data[name].reshape(len(place), -1).T:
            known = np.isfinite(values)
            count, total = (np.bincount(place[known], w, len(nodes)) for w in (None, values[known]))
            columns.append(np.where(count > 0, total / np.maximum(count, 1), np.nan))
    return np.column_stack(columns)
