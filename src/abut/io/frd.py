"""Result files of CalculiX (.frd), as text: the format that CalculiX GraphiX and converters to VTK read.

Columns and order of nodes are those of CalculiX GraphiX's manual, "Result Format", and of files that CalculiX 2.20 writes:
numbers have 6 digits, node and element numbers begin at 1, quadratic cells list the edges between bottom and top before
those of the top.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.io.atomic import write_file
from abut.types import Array

_HEX20 = (*range(12), *range(16, 20), *range(12, 16))
_WEDGE15 = (*range(9), *range(12, 15), *range(9, 12))
TYPES: Mapping[str, tuple[int, tuple[int, ...]]] = {  # number of the element type, nodes in its order
    "hex8": (1, tuple(range(8))),
    "wedge6": (2, tuple(range(6))),
    "tet4": (3, tuple(range(4))),
    "hex20": (4, _HEX20),
    "hex27": (4, _HEX20),
    "wedge15": (5, _WEDGE15),
    "tet10": (6, tuple(range(10))),
    "tri3": (7, tuple(range(3))),
    "tri6": (8, tuple(range(6))),
    "quad4": (9, tuple(range(4))),
    "quad8": (10, tuple(range(8))),
    "quad9": (10, tuple(range(8))),
}
CHOPPED = 10_000  # rows that are formatted together
SMALLEST, LARGEST = 1e-99, 9.99999e99  # sizes whose exponents have two digits, as the columns want
VECTOR, TENSOR = 3, 6


@dataclass(frozen=True)
class Dataset:
    """Values (n, components) at nodes: indices (n,) into the points, rising; components: their names. Three of them are a
    vector, six a symmetric tensor xx yy zz xy yz zx, as far as ``plain`` is not said; a vector has its size besides."""

    name: str
    components: tuple[str, ...]
    nodes: NDArray[np.int64]
    values: NDArray[np.float64]
    plain: bool = False


@dataclass(frozen=True)
class Increment:
    """What is known at a time: its number, and what holds there."""

    number: int
    time: float
    datasets: tuple[Dataset, ...]


def write_frd(
    path: Path,
    points: NDArray[np.float64],
    blocks: Sequence[tuple[str, Array]],
    groups: NDArray[np.integer],
    names: Sequence[str],
    increments: Iterable[Increment],
    program: str = "abut",
) -> None:
    """Write a file of points (n, 2 or 3), blocks of cells (kind, connectivity) and results at points.

    groups: (n_cells,) from 0, for each cell the index of its name in ``names``. Points that no cell of the file has, such as
    centres of faces, which it does not know, are left out with their values.
    Raises InputError where the file cannot be written."""

    def write(temporary: Path) -> None:
        with open(temporary, "w", encoding="ascii", errors="replace", newline="\n") as file:
            file.write(f"    1C\n    1UPGM               {program}\n")
            file.writelines(f"    1UMAT{number:5d}{name}\n" for number, name in enumerate(names, start=1))
            used = written_points(len(points), blocks)
            _points(file, points, used)
            _cells(file, blocks, groups)
            _results(file, increments, used)
            file.write(" 9999\n")

    write_file(path, write)


def written_points(count: int, blocks: Sequence[tuple[str, Array]]) -> NDArray[np.bool_]:
    """(count,) which points the file has."""
    used = np.zeros(count, dtype=bool)
    for kind, nodes in blocks:
        used[np.asarray(nodes)[:, list(TYPES[kind][1])]] = True
    return used


def _points(file: TextIO, points: NDArray[np.float64], used: NDArray[np.bool_]) -> None:
    file.write(f"    2C{np.count_nonzero(used):30d}{1:38d}\n")
    _rows(file, np.flatnonzero(used), np.pad(points, ((0, 0), (0, 3 - points.shape[1])))[used])
    file.write(" -3\n")


def _cells(file: TextIO, blocks: Sequence[tuple[str, Array]], groups: NDArray[np.integer]) -> None:
    file.write(f"    3C{sum(len(nodes) for _, nodes in blocks):30d}{1:38d}\n")
    number = 0
    for kind, nodes in blocks:
        code, order = TYPES[kind]
        assert len(order) <= CELLS[kind].nodes
        for row in (np.asarray(nodes)[:, list(order)] + 1).tolist():
            file.write(f" -1{number + 1:10d}{code:5d}{0:5d}{groups[number] + 1:5d}\n")
            file.writelines(
                f" -2{''.join(f'{node:10d}' for node in row[at : at + 10])}\n" for at in range(0, len(row), 10)
            )
            number += 1
    file.write(" -3\n")


def _results(file: TextIO, increments: Iterable[Increment], used: NDArray[np.bool_]) -> None:
    count = 0
    for increment in increments:
        for data in increment.datasets:
            count += 1
            there = used[data.nodes]
            file.write(f"    1PSTEP{count:26d}{increment.number:12d}{1:12d}\n")
            file.write(
                f"  100CL{100 + increment.number:5d}{increment.time:12.5E}{np.count_nonzero(there):12d}"
                f"{'':20}{0:2d}{increment.number:5d}{'':10}{1:2d}\n"
            )
            file.writelines(_head(data))
            _rows(file, data.nodes[there], data.values[there])
            file.write(" -3\n")


def _head(data: Dataset) -> list[str]:
    """Lines that name a dataset and its components, with their places in a vector or tensor."""
    count = len(data.components)
    size = count == VECTOR and not data.plain
    lines = [f" -4  {data.name:8.8}{count + size:5d}{1:5d}\n"]
    for name, (kind, row, column) in zip(data.components, _places(count, data.plain)):
        lines.append(f" -5  {name:8.8}{1:5d}{kind:5d}{row:5d}{column:5d}\n")
    if size:
        lines.append(f" -5  {'ALL':8}{1:5d}{2:5d}{0:5d}{0:5d}{1:5d}ALL\n")
    return lines


def _places(count: int, plain: bool) -> list[tuple[int, int, int]]:
    if count == VECTOR and not plain:
        return [(2, row, 0) for row in (1, 2, 3)]
    if count == TENSOR and not plain:
        return [(4, 1, 1), (4, 2, 2), (4, 3, 3), (4, 1, 2), (4, 2, 3), (4, 3, 1)]
    return [(1, row if count > 1 else 0, 0) for row in range(1, count + 1)]


def _rows(file: TextIO, nodes: NDArray[np.integer], values: NDArray[np.float64]) -> None:
    """Lines of a node number and values; more than six go on in further lines."""
    size = np.abs(values)
    sound = np.where(size < SMALLEST, 0.0, np.where(size > LARGEST, np.copysign(LARGEST, values), values))
    width = values.shape[1]
    line = (
        " -1%10d" + "".join(("\n -2          " if at and at % 6 == 0 else "") + "%12.5E" for at in range(width)) + "\n"
    )
    table = np.column_stack([nodes + 1.0, sound])
    for at in range(0, len(table), CHOPPED):
        rows = table[at : at + CHOPPED]
        file.write((line * len(rows)) % tuple(rows.ravel().tolist()))
