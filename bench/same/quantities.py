"""The numbers in the files of a run, each array or number by a path that says what it is.

summary.json/steps/0/contacts/blocks/force        contact_blocks_0001.vtu/points/pressure        history.csv/force_*
"""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkFieldData
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

IGNORED = ("timings", "seconds", "versions")  # keys of JSON that differ from run to run
Found = tuple[str, np.ndarray | str]


@dataclass(frozen=True)
class Quantities:
    """What the files of a folder hold: names of the files, numbers and words by path."""

    files: frozenset[str]
    numbers: dict[str, np.ndarray]
    words: dict[str, str]


def read(folder: Path) -> Quantities:
    """Everything in the JSON, CSV and VTU files right in ``folder``. Raises ValueError for a file that cannot be read."""
    readers = {".json": read_json, ".csv": read_csv, ".vtu": read_vtu}
    files = [path for path in sorted(folder.iterdir()) if path.suffix in readers]
    numbers: dict[str, np.ndarray] = {}
    words: dict[str, str] = {}
    for path in files:
        for name, value in readers[path.suffix](path):
            own: dict[str, Any] = words if isinstance(value, str) else numbers
            full = f"{path.name}/{name}"
            if full in own:
                raise ValueError(f"{path}: two quantities have the name {name}")
            own[full] = value
    return Quantities(frozenset(path.name for path in files), numbers, words)


def read_json(path: Path) -> Iterator[Found]:
    """A list of numbers is one array (a null is nan); objects in a list go by their names, or else by their places."""
    yield from _plain("", json.loads(path.read_text(encoding="utf-8")))


def _plain(path: str, value: Any) -> Iterator[Found]:
    if isinstance(value, str):
        yield path, value
    elif isinstance(value, dict):
        prefix = f"{path}/" if path else ""
        alone = {key: item for key, item in value.items() if key not in IGNORED}
        numbers = {key: _array(item) for key, item in alone.items() if item is None or isinstance(item, int | float)}
        yield from ((prefix + key, array) for key, array in together(numbers))
        for key in alone.keys() - numbers.keys():
            yield from _plain(prefix + key, alone[key])
    elif isinstance(value, list) and not _is_array(value):
        keys = [_key(item, i) for i, item in enumerate(value)]
        if len(set(keys)) < len(keys):
            keys = [str(i) for i in range(len(value))]
        for key, item in zip(keys, value):
            yield from _plain(f"{path}/{key}" if path else key, item)
    else:
        yield path, _array(value)


def _is_array(value: list[Any]) -> bool:
    """Numbers, or rows of as many numbers each."""
    if all(isinstance(item, list) for item in value):
        return len({len(item) for item in value}) <= 1 and all(_is_array(item) for item in value)
    return all(item is None or isinstance(item, int | float) for item in value)


def _array(value: Any) -> np.ndarray:
    array = np.array(value)
    return array.astype(float) if array.dtype == object else array  # None: nan


def together(arrays: dict[str, np.ndarray]) -> Iterator[tuple[str, np.ndarray]]:
    """Components (force_x, force_y; stress_xx, stress_yy, stress_xy) as one array, "force_*": one may be zero but for
    rounding, which is small next to the others."""
    stems = {name: re.sub("_[xyz]{1,2}$", "_*", name) for name in arrays}
    for stem in dict.fromkeys(stems.values()):
        own = [arrays[name] for name in arrays if stems[name] == stem]
        yield stem, np.stack(own, axis=-1) if stem.endswith("_*") else own[0]


def _key(item: Any, place: int) -> str:
    if not isinstance(item, dict) or "name" not in item:
        return str(place)
    return ": ".join(item[key] for key in ("contact", "name") if item.get(key))


def read_csv(path: Path) -> Iterator[Found]:
    """A column is one array; an empty cell is nan."""
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file, restval=""))
    columns = {name: [row[name] for row in rows] for name in (rows[0] if rows else ())}
    numbers = {name: _floats(cells) for name, cells in columns.items()}
    yield from together({name: array for name, array in numbers.items() if array is not None})
    yield from ((name, "\n".join(cells)) for name, cells in columns.items() if numbers[name] is None)


def _floats(cells: Iterable[str]) -> np.ndarray | None:
    """None where a cell is no number."""
    try:
        return np.array([float(cell) if cell else np.nan for cell in cells])
    except ValueError:
        return None


def read_vtu(path: Path) -> Iterator[Found]:
    """Points, cells, and every array of points, cells and the file."""
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    if reader.GetErrorCode() or grid.GetPoints() is None:  # of some damage VTK only warns
        raise ValueError(f"{path}: VTK cannot read it")
    cells = grid.GetCells()
    yield "coordinates", vtk_to_numpy(grid.GetPoints().GetData())
    yield "connectivity", vtk_to_numpy(cells.GetConnectivityArray())
    yield "offsets", vtk_to_numpy(cells.GetOffsetsArray())
    yield "types", np.array([grid.GetCellType(i) for i in range(grid.GetNumberOfCells())])
    for place, data in (("points", grid.GetPointData()), ("cells", grid.GetCellData()), ("file", grid.GetFieldData())):
        yield from _arrays(place, data)


def _arrays(place: str, data: vtkFieldData) -> Iterator[Found]:
    for index in range(data.GetNumberOfArrays()):
        array = data.GetAbstractArray(index)
        name = f"{place}/{array.GetName()}"
        if array.IsNumeric():
            yield name, vtk_to_numpy(array)
        else:
            yield name, "\n".join(array.GetValue(i) for i in range(array.GetNumberOfValues()))
