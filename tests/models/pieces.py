"""Result files of one process or many, read with VTK."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Grid = Any


def read(path: Path) -> Grid:
    from vtkmodules.vtkIOXML import vtkXMLPUnstructuredGridReader, vtkXMLUnstructuredGridReader

    reader = (vtkXMLPUnstructuredGridReader if path.suffix == ".pvtu" else vtkXMLUnstructuredGridReader)()
    problems: list[str] = []
    reader.AddObserver("ErrorEvent", lambda *_: problems.append("error"))
    reader.SetFileName(str(path))
    reader.Update()
    assert not problems
    return reader.GetOutput()


def volume(grid: Grid) -> float:
    """Sum of the cells' sizes, by VTK."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter

    sizes = vtkCellSizeFilter()
    sizes.SetInputData(grid)
    sizes.Update()
    data = sizes.GetOutput().GetCellData()
    return float(sum(vtk_to_numpy(data.GetArray(name)).sum() for name in ("Area", "Volume")))


def probe(grid: Grid, places: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """Point data interpolated at places, and cell data there, by VTK's cells. (Its probe filter misses some in wedges.)"""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonDataModel import vtkGenericCell, vtkStaticCellLocator

    locator = vtkStaticCellLocator()
    locator.SetDataSet(grid)
    locator.BuildLocator()
    cell, weights = vtkGenericCell(), [0.0] * grid.GetMaxCellSize()
    point_data, cell_data = (
        {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}
        for data in (grid.GetPointData(), grid.GetCellData())
    )
    found: dict[str, list[Any]] = {name: [] for name in (*point_data, *cell_data)}
    for place in places:
        number = locator.FindCell(list(place), 0.0, cell, [0.0] * 3, weights)
        assert number >= 0, place
        nodes = [cell.GetPointId(i) for i in range(cell.GetNumberOfPoints())]
        for name, values in point_data.items():
            found[name].append(np.array(weights[: len(nodes)]) @ values[nodes])
        for name, values in cell_data.items():
            found[name].append(values[number])
    return {name: np.array(values) for name, values in found.items()}


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.glob("fields_*"))
