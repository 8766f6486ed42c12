"""Fields of a step written by all processes: each its own part of the mesh, then process 0 the file that names the parts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from abut.errors import InputError
from abut.io.atomic import write_text
from abut.io.vtu import write_vtu
from abut.mesh.mesh import Mesh
from abut.model import Model
from abut.output.fields import list_name, piece_name, remove_pieces, whole_name
from abut.output.options import EVERYTHING, Output
from abut.parallel.partition import Piece
from abut.solution import Step
from abut.solution.grids import Grid, cell_error, field_grid

if TYPE_CHECKING:
    from abut.parallel.team import Store, Team

VTK_TYPES = {"float32": "Float32", "float64": "Float64", "int32": "Int32"}


class Pieces:
    """Writes the fields of a step (``abut.output.fields.WriteFields``) as a piece of each process, its part of the cells."""

    def __init__(self, team: Team) -> None:
        self._team = team

    def __call__(self, folder: Path, model: Model, step: Step, output: Output = EVERYTHING) -> None:
        """Raises InputError where a file cannot be written."""
        dealt: Sequence[Piece] = self._team.store["pieces"]
        listed = folder / list_name(step.number)
        listed.unlink(missing_ok=True)  # of an earlier run: it is never there beside pieces that are not its own
        error = cell_error(step)
        arguments = [
            (
                folder.absolute() / piece_name(step.number, process), step.displacement[p.points], step.stress[p.points],
                None if error is None else error[p.cells], {k: v[p.points] for k, v in step.remembered.items()}, output,
            )
            for process, p in enumerate(dealt)
        ]  # fmt: skip
        written = [result for result in self._team.each(write_piece, per_rank=arguments) if result is not None]
        for result in written:
            if isinstance(result, InputError):
                raise result
        names = [piece_name(step.number, process) for process, p in enumerate(dealt) if len(p.cells)]
        write_text(listed, listing(names, written[0]))
        (folder / whole_name(step.number)).unlink(missing_ok=True)
        remove_pieces(folder, step.number, but=names)


def write_piece(
    store: Store,
    path: Path,
    displacement: NDArray[np.float64],
    stress: NDArray[np.float64],
    error: NDArray[np.float64] | None,
    remembered: Mapping[str, NDArray[np.float64]],
    output: Output,
) -> dict[str, list[tuple[str, str, int]]] | InputError | None:
    """Write this process's part of the mesh with displacement (n_points, dim) and stress (n_points, 6) at its points and the
    estimated error of stresses (n_cells,), as far as ``output`` names them.

    Returns the arrays by place (name, type, components); None where it has no cells; the error where it cannot be
    written: one process must not raise while the others wait for it."""
    mesh: Mesh = store["part"].mesh
    if mesh.n_cells == 0:
        return None
    grid = output.of_bodies(field_grid(mesh, displacement, stress, error, remembered))
    try:
        write_vtu(path, grid.points, grid.blocks, grid.point_data, grid.cell_data, raw=True, small=output.small)
    except InputError as error:
        return error
    return arrays(grid)


def arrays(grid: Grid) -> dict[str, list[tuple[str, str, int]]]:
    """Name, VTK's type and number of components of what a grid has at points and at cells."""
    return {
        place: [(name, VTK_TYPES[values.dtype.name], values[0].size) for name, values in data.items()]
        for place, data in (("PPointData", grid.point_data), ("PCellData", grid.cell_data))
    }


def listing(pieces: Sequence[str], arrays: dict[str, list[tuple[str, str, int]]]) -> str:
    """The text of a PVTU file of ``pieces`` (file names beside it) with ``arrays``."""

    def tag(name: str, kind: str, components: int) -> str:
        return f'      <PDataArray type="{kind}" Name={quoteattr(name)} NumberOfComponents="{components}"/>\n'

    data = "".join(
        f"    <{place}>\n{''.join(tag(*array) for array in present)}    </{place}>\n"
        for place, present in arrays.items()
    )
    sources = "".join(f"    <Piece Source={quoteattr(name)}/>\n" for name in pieces)
    return (
        '<?xml version="1.0"?>\n<VTKFile type="PUnstructuredGrid" version="1.0" byte_order="LittleEndian">\n'
        f'  <PUnstructuredGrid GhostLevel="0">\n{data}    <PPoints>\n{tag("Points", "Float64", 3)}    </PPoints>\n'
        f"{sources}  </PUnstructuredGrid>\n</VTKFile>\n"
    )
