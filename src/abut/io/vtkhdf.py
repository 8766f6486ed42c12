"""VTKHDF files through VTK's own writer: all steps of a grid in one file, points and cells of which stand there once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from abut.io.atomic import write_file
from abut.io.vtu import add_data, cells_of
from abut.types import Array, Foreign

Data = tuple[Mapping[str, Array], Mapping[str, Array]]  # over points, over cells
CHUNK = 25_000  # rows that are compressed together: VTK's own
COMPRESSION = 1  # of HDF5's zlib: higher levels take longer for some hundredths


def write_vtkhdf(
    path: Path,
    points: NDArray[np.float64],
    blocks: Sequence[tuple[str, Array]],
    times: Sequence[float],
    data_at: Callable[[int], Data],
    names: Mapping[str, Sequence[str]] | None = None,
) -> None:
    """Write a grid with data at several times to one file, an UnstructuredGrid with steps (VTKHDF, VTK file formats).

    points, blocks, names: as in ``write_vtu``; times: rising; data_at: of the number of a time the data over points and
    over cells, with the same names at all times. Only the data of one time are in memory at once.
    Raises InputError where the file cannot be written.
    """
    from vtkmodules.vtkIOHDF import vtkHDFWriter

    grid = cells_of(points, blocks)

    def at(number: int) -> Foreign:
        now = grid.NewInstance()
        now.CopyStructure(grid)  # shares points and cells: VTK sees that they stay
        add_data(now, *data_at(number), names or {})
        return now

    def write(temporary: Path) -> None:
        temporary.touch()  # raises OSError with a reason where VTK would only say no
        source = _source(times, at)
        writer = vtkHDFWriter()
        try:
            writer.SetInputConnection(source.GetOutputPort())
            writer.SetFileName(str(temporary))
            writer.SetOverwrite(True)
            writer.SetWriteAllTimeSteps(True)
            writer.SetCompressionLevel(COMPRESSION)
            writer.SetChunkSize(min(CHUNK, len(points)))  # short lists take a whole one, too
            if not writer.Write():
                raise OSError(f"VTK could not write {path.name}")
        finally:
            source.at = None  # VTK never lets go of a source in Python: at least of the results with it
            source.GetOutputDataObject(0).Initialize()
            del writer  # closes the file

    write_file(path, write)


def _source(times: Sequence[float], grid_at: Callable[[int], Foreign]) -> Foreign:
    """What VTK's writer asks for the grid at one time after the other."""
    from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
    from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline

    class Source(VTKPythonAlgorithmBase):  # type: ignore[misc]
        def __init__(self, at: Callable[[int], Foreign]) -> None:
            super().__init__(nInputPorts=0, nOutputPorts=1, outputType="vtkUnstructuredGrid")
            self.at = at

        def RequestInformation(self, _request: Foreign, _inputs: Foreign, outputs: Foreign) -> int:
            info = outputs.GetInformationObject(0)
            info.Set(Pipeline.TIME_STEPS(), list(times), len(times))
            info.Set(Pipeline.TIME_RANGE(), [times[0], times[-1]], 2)
            return 1

        def RequestData(self, _request: Foreign, _inputs: Foreign, outputs: Foreign) -> int:
            info = outputs.GetInformationObject(0)
            time = info.Get(Pipeline.UPDATE_TIME_STEP()) if info.Has(Pipeline.UPDATE_TIME_STEP()) else times[0]
            number = int(np.argmin(np.abs(np.asarray(times) - time)))
            grid = vtkUnstructuredGrid.GetData(outputs)
            grid.ShallowCopy(self.at(number))
            grid.GetInformation().Set(grid.DATA_TIME_STEP(), times[number])
            return 1

    return Source(grid_at)
