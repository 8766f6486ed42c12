"""VTU files through VTK's own reader and writer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.errors import InputError
from abut.io.atomic import write_file
from abut.io.raw import RawMesh

VTK_KIND = {cell.vtk: cell.name for cell in CELLS.values()}


def write_vtu(
    path: Path,
    points: NDArray[np.float64],
    blocks: Sequence[tuple[str, NDArray[Any]]],
    point_data: Mapping[str, NDArray[Any]],
    cell_data: Mapping[str, NDArray[Any]] | None = None,
) -> None:
    """Write points (n, 2 or 3), cells by type (kind, connectivity) and data; quadratic cells stay quadratic.

    point_data: (n,) or (n, k); cell_data: (cells,) or (cells, k) in the order of the blocks.
    Raises InputError where the file cannot be written.
    """
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkUnstructuredGrid
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    grid = vtkUnstructuredGrid()
    xyz = np.zeros((len(points), 3))
    xyz[:, : points.shape[1]] = points
    vtk_points = vtkPoints()
    vtk_points.SetData(numpy_to_vtk(xyz, deep=True))
    grid.SetPoints(vtk_points)
    counts = np.concatenate([np.full(len(nodes), nodes.shape[1]) for _, nodes in blocks])
    cells = vtkCellArray()
    cells.SetData(
        numpy_to_vtkIdTypeArray(np.concatenate([[0], np.cumsum(counts)]).astype(np.int64), deep=True),
        numpy_to_vtkIdTypeArray(np.concatenate([n.ravel() for _, n in blocks]).astype(np.int64), deep=True),
    )
    kinds = np.concatenate([np.full(len(nodes), CELLS[kind].vtk, np.uint8) for kind, nodes in blocks])
    grid.SetCells(numpy_to_vtk(kinds, deep=True), cells)
    for data, target in ((point_data, grid.GetPointData()), (cell_data or {}, grid.GetCellData())):
        for name, values in data.items():
            array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
            array.SetName(name)
            target.AddArray(array)

    def write(temporary: Path) -> None:
        temporary.touch()  # raises OSError with a reason where VTK would only say no
        writer = vtkXMLUnstructuredGridWriter()
        writer.SetFileName(str(temporary))
        writer.SetInputData(grid)
        if not writer.Write():
            raise OSError(f"VTK could not write {path.name}")

    write_file(path, write)


def read_vtu(path: Path) -> RawMesh:
    """Read cells and names. An integer cell array ``region`` with the field array ``region_names`` (one name for each
    value, in order) names bodies and surfaces; without it every connected group of cells is a body ``body_1``, ...

    Raises InputError for files that VTK cannot read or that hold cells abut does not know.
    """
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkObject
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    reader = vtkXMLUnstructuredGridReader()
    failures: list[str] = []
    vtkObject.GlobalWarningDisplayOff()
    reader.AddObserver("ErrorEvent", lambda *_: failures.append("error"))
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    if failures or grid is None or grid.GetNumberOfCells() == 0:
        raise InputError(f"{path}: not a readable VTU file with cells (truncated or of another kind?); write it again")
    points = vtk_to_numpy(grid.GetPoints().GetData()).astype(float)
    kinds = np.array([grid.GetCellType(i) for i in range(grid.GetNumberOfCells())])
    offsets = vtk_to_numpy(grid.GetCells().GetOffsetsArray())
    nodes = vtk_to_numpy(grid.GetCells().GetConnectivityArray())
    unknown = sorted(set(kinds.tolist()) - set(VTK_KIND))
    if unknown:
        raise InputError(f"{path}: VTK cell types {unknown} are not supported; supported: {', '.join(CELLS)}")
    region = grid.GetCellData().GetArray("region")
    names = grid.GetFieldData().GetAbstractArray("region_names")
    groups: dict[str, dict[str, list[NDArray[np.int64]]]] = {}
    value = vtk_to_numpy(region).astype(int) if region is not None else None
    for code in np.unique(kinds):
        own = np.flatnonzero(kinds == code)
        kind = VTK_KIND[int(code)]
        rows = nodes[offsets[own][:, None] + np.arange(CELLS[kind].nodes)].astype(np.int64)
        if value is None:
            groups.setdefault("", {}).setdefault(kind, []).append(rows)
            continue
        for r in np.unique(value[own]):
            known = names is not None and 0 <= r < names.GetNumberOfValues()
            name = str(names.GetValue(int(r))) if known else f"region_{r}"
            groups.setdefault(name, {}).setdefault(kind, []).append(rows[value[own] == r])
    joined = {name: {k: np.concatenate(v) for k, v in parts.items()} for name, parts in groups.items()}
    return RawMesh(points, joined)
