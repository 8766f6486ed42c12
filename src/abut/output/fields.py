"""The files of a step's fields: one VTU file, or a piece of each process and the PVTU file that names them."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection
from pathlib import Path

from abut.io.vtu import write_vtu
from abut.model import Model
from abut.output.options import EVERYTHING, Output
from abut.solution import Step
from abut.solution.grids import cell_error, field_grid

WriteFields = Callable[[Path, Model, Step, Output], None]  # writes the fields of a step to a directory


def write_fields(folder: Path, model: Model, step: Step, output: Output = EVERYTHING) -> None:
    """The fields of a step that ``output`` names as one VTU file. Raises InputError where the file cannot be written."""
    grid = output.of_bodies(field_grid(model.mesh, step.displacement, step.stress, cell_error(step), step.remembered))
    path = folder / whole_name(step.number)
    names = {"body_names": list(model.mesh.bodies)}
    write_vtu(path, grid.points, grid.blocks, grid.point_data, grid.cell_data, names, raw=True, small=output.small)
    (folder / list_name(step.number)).unlink(missing_ok=True)  # of an earlier run on several processes
    remove_pieces(folder, step.number)


def whole_name(number: int) -> str:
    return f"fields_{number:04d}.vtu"


def list_name(number: int) -> str:
    return f"fields_{number:04d}.pvtu"


def piece_name(number: int, process: int) -> str:
    return f"fields_{number:04d}_{process:04d}.vtu"


def remove_pieces(folder: Path, number: int, but: Collection[str] = ()) -> None:
    """Remove the pieces of a step, ``but`` some names."""
    for path in folder.glob(f"fields_{number:04d}_*.vtu"):
        process = path.stem.rpartition("_")[2]
        if process.isdecimal() and path.name not in but:
            path.unlink(missing_ok=True)


def found_name(folder: Path, number: int) -> str:
    """The file to open for a step: of pieces where there are any."""
    return list_name(number) if (folder / list_name(number)).is_file() else whole_name(number)


def is_whole(folder: Path, number: int) -> bool:
    """Whether the file of a step is there, and all pieces that it names."""
    path = folder / found_name(folder, number)
    if not path.is_file():
        return False
    pieces = re.findall(r'Source="([^"]+)"', path.read_text(encoding="utf-8")) if path.suffix == ".pvtu" else []
    return all((folder / piece).is_file() for piece in pieces)
