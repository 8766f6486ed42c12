"""Values at the points of a result file: VTU of any program, and CalculiX's .frd as text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.errors import InputError, nearest
from abut.io.frd import TYPES
from abut.io.vtu import VERTEX, VTK_KIND, load_grid
from abut.types import Foreign

NODES_OF = {code: (kind, order) for kind, (code, order) in reversed(list(TYPES.items()))}  # hex20 in place of hex27
GROUPS = {"body": "body_names", "region": "region_names"}  # arrays of cells, and lists of their names, of VTU files
LINES = (11, 12)  # beams of two and three nodes, which hold no points between
WIDTH = 12  # of a number in an .frd file
MATERIAL = "    1UMAT"  # begins a line with number and name of a material, which cells have by its number
STEP = "    1PSTEP"  # begins a line before results
ROW = 13  # where the numbers of a row begin: after its key and the number of the node
DERIVED = "ALL"  # the component of a vector that is its size, and stands in no row


@dataclass(frozen=True)
class PointValues:
    """points: (n, 3); cells: kind -> connectivity (m, nodes), in the order of ``abut.cells``; values: (n, k), NaN where a
    point has none; components: their names, empty where the file gives none; groups: kind -> (m,) number of the body of
    each cell, empty where the file tells none; bodies: names of bodies -> their numbers."""

    points: NDArray[np.float64]
    cells: Mapping[str, NDArray[np.int64]]
    values: NDArray[np.float64]
    components: tuple[str, ...] = ()
    groups: Mapping[str, NDArray[np.int64]] = field(default_factory=dict)
    bodies: Mapping[str, int] = field(default_factory=dict)


def read_values(path: Path, array: str, step: int | None = None) -> PointValues:
    """One array of a .vtu or .frd file, of which the last time counts, of a step of an .frd file where one is named.

    Raises InputError for files that cannot be read, other kinds of files, and arrays that are not there."""
    if not path.exists():
        raise InputError(f"no result file {path}")
    if path.suffix.lower() == ".vtu":
        return _vtu(path, array)
    if path.suffix.lower() == ".frd":
        return _frd(path, array, step)
    raise InputError(f"{path}: values are read from .vtu and .frd files; write one of these")


def _unknown(path: Path, array: str, known: list[str], of_step: str = "") -> InputError:
    there = f"; there are {', '.join(known)}" if known else "; it has none"
    return InputError(f"{path}: no values named {array!r} at its points{of_step}{nearest(array, known) or there}")


def _vtu(path: Path, array: str) -> PointValues:
    from vtkmodules.util.numpy_support import vtk_to_numpy

    grid, kinds = load_grid(path)
    data = grid.GetPointData()
    known = [data.GetArrayName(i) for i in range(data.GetNumberOfArrays())]
    if array not in known:
        raise _unknown(path, array, known)
    values = vtk_to_numpy(data.GetArray(array)).astype(float)
    offsets = vtk_to_numpy(grid.GetCells().GetOffsetsArray())
    nodes = vtk_to_numpy(grid.GetCells().GetConnectivityArray())
    numbers, bodies = _bodies(grid)
    cells, groups = {}, {}
    for code in np.unique(kinds).tolist():
        if code == VERTEX:
            continue
        if code not in VTK_KIND:
            raise InputError(f"{path}: VTK cell type {code} is not supported; supported: {', '.join(CELLS)}")
        rows = np.flatnonzero(kinds == code)
        kind = VTK_KIND[code]
        cells[kind] = nodes[offsets[rows][:, None] + np.arange(CELLS[kind].nodes)].astype(np.int64)
        if numbers is not None:
            groups[kind] = numbers[rows]
    points = vtk_to_numpy(grid.GetPoints().GetData()).astype(float)
    return PointValues(points, cells, values.reshape(len(points), -1), groups=groups, bodies=bodies)


def _bodies(grid: Foreign) -> tuple[NDArray[np.int64] | None, dict[str, int]]:
    """Of a VTU file: the number of each cell's body, None where no array of cells tells it, and the bodies' names."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    for name, names in GROUPS.items():
        array, texts = grid.GetCellData().GetArray(name), grid.GetFieldData().GetAbstractArray(names)
        if array is None or array.GetNumberOfComponents() != 1:
            continue
        count = 0 if texts is None else texts.GetNumberOfValues()
        return vtk_to_numpy(array).astype(np.int64), {texts.GetValue(i): i for i in range(count)}
    return None, {}


def _frd(path: Path, array: str, step: int | None) -> PointValues:
    """Of an .frd file, whose materials are its bodies.

    Sections begin with "2C" (nodes), "3C" (elements) and "-4" (a name); "-1" begins a row, "-2" goes on with it."""
    numbers: dict[int, int] = {}
    points: list[list[float]] = []
    cells: dict[str, list[list[int]]] = {}
    groups: dict[str, list[int]] = {}
    bodies: dict[str, int] = {}
    known: list[str] = []
    components: list[str] = []
    found: dict[int, list[float]] = {}
    code, group, node, section = 0, 0, 0, ""
    try:
        for key, line in _of_step(_lines(path), step):
            if line.startswith(MATERIAL):
                bodies[line[len(MATERIAL) + 5 :].strip()] = int(line[len(MATERIAL) : len(MATERIAL) + 5])
            elif key in ("2C", "3C", "-4"):
                section = key if key != "-4" else line[5:13].strip()
                if key == "-4":
                    known.append(section)
                if section == array:
                    components, found = [], {}
            elif key == "-3":
                section = ""
            elif key == "-5" and section == array and line[5:13].strip() != DERIVED:
                components.append(line[5:13].strip())
            elif key == "-1" and section == "2C":
                numbers[int(line[3:13])] = len(points)
                points.append(_row(line)[:3])
            elif key == "-1" and section == "3C":
                code, group = int(line[13:18]), int(line[23:28])
                if code not in LINES:
                    groups.setdefault(NODES_OF[code][0], []).append(group)
            elif key == "-2" and section == "3C" and code not in LINES:
                kind = NODES_OF[code][0]
                cells.setdefault(kind, []).append([int(line[i : i + 10]) for i in range(3, len(line), 10)])
            elif key in ("-1", "-2") and section == array:
                node = int(line[3:13]) if key == "-1" else node
                found.setdefault(node, []).extend(_row(line))
        tables = {kind: _connectivity(kind, rows, numbers) for kind, rows in cells.items()}
    except (ValueError, KeyError, IndexError):
        raise InputError(f"{path}: not a readable .frd file of text; write it again (FILE FORMAT=ASCII)") from None
    if array not in known:
        of_step = "" if step is None else f" in step {step}"
        raise _unknown(path, array, list(dict.fromkeys(known)), of_step)
    return PointValues(
        np.array(points),
        tables,
        _table(found, numbers, len(components)),
        tuple(components),
        {kind: np.array(rows) for kind, rows in groups.items()},
        bodies,
    )


def _lines(path: Path) -> Iterator[tuple[str, str]]:
    """Key and text of every line."""
    with path.open(encoding="ascii", errors="replace") as file:
        for line in file:
            text = line.rstrip("\n")
            yield text[:6].strip() if text[:6].strip() in ("2C", "3C") else text[:3].strip(), text


def _of_step(lines: Iterable[tuple[str, str]], step: int | None) -> Iterator[tuple[str, str]]:
    """The lines without results of other steps than one; all where that is None."""
    here, other = 0, False
    for key, line in lines:
        if line.startswith(STEP):
            here = int(line.split()[3])  # number of the results, increment, step
        if key in ("2C", "3C", "-4"):
            other = key == "-4" and step is not None and here != step
        if not other:
            yield key, line


def _row(line: str) -> list[float]:
    return [float(line[i : i + WIDTH]) for i in range(ROW, len(line.rstrip()), WIDTH)]


def _connectivity(kind: str, rows: list[list[int]], numbers: Mapping[int, int]) -> NDArray[np.int64]:
    """In the order of ``abut.cells``; rows of cells with more nodes than a line holds come in several."""
    order = NODES_OF[TYPES[kind][0]][1]
    flat = [numbers[node] for row in rows for node in row]
    table = np.array(flat, dtype=np.int64).reshape(-1, len(order))
    result = np.empty_like(table)
    result[:, list(order)] = table
    return result


def _table(found: Mapping[int, list[float]], numbers: Mapping[int, int], count: int) -> NDArray[np.float64]:
    values = np.full((len(numbers), count), np.nan)
    for node, row in found.items():
        if node in numbers and len(row) >= count:
            values[numbers[node]] = row[:count]
    return values
