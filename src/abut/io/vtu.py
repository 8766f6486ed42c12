"""VTU files through VTK's own reader and writer."""

from __future__ import annotations

import base64
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.errors import InputError
from abut.io.atomic import write_file
from abut.io.raw import RawMesh
from abut.types import Array, Foreign

VERTEX = 1  # of VTK: the points of node sets
BLOCK = 2**20  # bytes that are compressed together
SHRINKS = 20_000  # times, at most: zlib about a thousandfold, LZMA seven thousandfold
VTK_KIND = {VERTEX: "point"} | {cell.vtk: cell.name for cell in CELLS.values()}
VTK_CODE = {kind: code for code, kind in VTK_KIND.items()}
NODES = {"point": 1} | {cell.name: cell.nodes for cell in CELLS.values()}


def write_vtu(
    path: Path,
    points: NDArray[np.float64],
    blocks: Sequence[tuple[str, Array]],
    point_data: Mapping[str, Array],
    cell_data: Mapping[str, Array] | None = None,
    names: Mapping[str, Sequence[str]] | None = None,
    raw: bool = False,
    small: bool = False,
) -> None:
    """Write points (n, 2 or 3), cells by type (kind, or "point" for vertices, and connectivity) and data; quadratic cells
    stay quadratic.

    point_data: (n,) or (n, k); cell_data: (cells,) or (cells, k) in the order of the blocks; names: lists of strings
    for the whole file (VTK's field data). raw: no base64, which takes longer than all the rest, for a third more bytes, but
    lets VTK notice damage, and numbers of points in 32 bits: for results, which viewers read, rather than meshes. small:
    with LZMA in place of zlib, which takes several times as long.
    Raises InputError where the file cannot be written.
    """
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    grid = cells_of(points, blocks, short=raw)
    add_data(grid, point_data, cell_data or {}, names or {})

    def write(temporary: Path) -> None:
        temporary.touch()  # raises OSError with a reason where VTK would only say no
        writer = vtkXMLUnstructuredGridWriter()
        writer.SetFileName(str(temporary))
        writer.SetInputData(grid)
        _compress(writer, results=raw, small=small)
        writer.SetEncodeAppendedData(not raw)
        if not writer.Write():
            raise OSError(f"VTK could not write {path.name}")

    write_file(path, write)


def cells_of(points: NDArray[np.float64], blocks: Sequence[tuple[str, Array]], short: bool = False) -> Foreign:
    """VTK's grid of points and cells as in ``write_vtu``; short: numbers of points in 32 bits where that is enough."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkUnstructuredGrid

    grid = vtkUnstructuredGrid()
    xyz = np.zeros((len(points), 3))
    xyz[:, : points.shape[1]] = points
    vtk_points = vtkPoints()
    vtk_points.SetData(numpy_to_vtk(xyz, deep=True))
    grid.SetPoints(vtk_points)
    counts = np.concatenate([np.full(len(nodes), nodes.shape[1]) for _, nodes in blocks])
    cells = vtkCellArray()
    cells.SetData(
        *_integers(
            [np.concatenate([[0], np.cumsum(counts)]), np.concatenate([n.ravel() for _, n in blocks])], short=short
        )
    )
    kinds = np.concatenate([np.full(len(nodes), VTK_CODE[kind], np.uint8) for kind, nodes in blocks])
    grid.SetCells(numpy_to_vtk(kinds, deep=True), cells)
    return grid


def add_data(
    grid: Foreign, point_data: Mapping[str, Array], cell_data: Mapping[str, Array], names: Mapping[str, Sequence[str]]
) -> None:
    """Data of a grid as in ``write_vtu``."""
    from vtkmodules.util.numpy_support import numpy_to_vtk

    for data, target in ((point_data, grid.GetPointData()), (cell_data, grid.GetCellData())):
        for name, values in data.items():
            array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
            array.SetName(name)
            target.AddArray(array)
    _add_texts(grid, names)


def _add_texts(grid: Foreign, names: Mapping[str, Sequence[str]]) -> None:
    """Lists of strings for the whole file."""
    from vtkmodules.vtkCommonCore import vtkStringArray

    for name, texts in names.items():
        strings = vtkStringArray()
        strings.SetName(name)
        for text in texts:
            strings.InsertNextValue(text)
        grid.GetFieldData().AddArray(strings)


def _compress(writer: Foreign, results: bool, small: bool) -> None:
    """Of results zlib leaves a seventh to a half less than LZ4, and LZMA a tenth to two fifths less than zlib; their higher
    levels take longer for some hundredths. Facets repeat the values of nodes that they share: one block finds these where
    VTK's own, of 32 kB, do not reach."""
    if results:
        writer.SetBlockSize(BLOCK)
        writer.SetCompressorTypeToLZMA() if small else writer.SetCompressorTypeToZLib()
        writer.SetCompressionLevel(1)
    else:
        writer.SetCompressorTypeToLZ4()


def _integers(lists: Sequence[Array], short: bool) -> list[Foreign]:
    """VTK's arrays of 64 bits, or ``short`` of 32 where that is enough."""
    from vtkmodules.util.numpy_support import numpy_to_vtkIdTypeArray, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkTypeInt32Array

    if not short or max(int(numbers.max(initial=0)) for numbers in lists) >= 2**31:
        return [numpy_to_vtkIdTypeArray(numbers.astype(np.int64), deep=True) for numbers in lists]
    arrays = [vtkTypeInt32Array() for _ in lists]
    for array, numbers in zip(arrays, lists):
        array.SetNumberOfValues(len(numbers))
        vtk_to_numpy(array)[:] = numbers
    return arrays


def read_vtu(path: Path) -> RawMesh:
    """Read cells and names from a VTU file.

    An integer cell array ``region`` numbers the groups, and the string array ``region_names`` in the field data gives
    the name of region 0, 1, ...; a region without a name there is called ``region_<number>``. Regions of the highest
    cells are bodies, those of facet cells surfaces, those of vertices node sets. A cell in several groups stands in the
    file once for each. Without ``region`` there are no surfaces, and every connected set of cells is a body ``body_1``,
    ``body_2``, ...

    Raises InputError for files that VTK cannot read or that hold cells abut does not know.
    """
    from vtkmodules.util.numpy_support import vtk_to_numpy

    grid, kinds = load_grid(path)
    points = vtk_to_numpy(grid.GetPoints().GetData()).astype(float)
    offsets = vtk_to_numpy(grid.GetCells().GetOffsetsArray())
    nodes = vtk_to_numpy(grid.GetCells().GetConnectivityArray())
    unknown = sorted(set(kinds.tolist()) - set(VTK_KIND))
    if unknown:
        raise InputError(f"{path}: VTK cell types {unknown} are not supported; supported: {', '.join(CELLS)}")
    table = np.zeros(max(VTK_KIND) + 1, dtype=np.int64)
    table[list(VTK_KIND)] = [NODES[kind] for kind in VTK_KIND.values()]
    want = table[kinds]
    bad = np.flatnonzero((np.diff(offsets) != want) | (offsets[:-1] < 0) | (offsets[1:] > len(nodes)))
    if len(bad):
        raise InputError(f"{path}: cell {bad[0]} has a wrong number of points for its type; write it again")
    value, names = _regions(path, grid)
    groups: dict[str, dict[str, list[NDArray[np.int64]]]] = {}
    for code in np.unique(kinds):
        cells = np.flatnonzero(kinds == code)
        kind = VTK_KIND[int(code)]
        rows = nodes[offsets[cells][:, None] + np.arange(NODES[kind])].astype(np.int64)
        if value is None:
            groups.setdefault("", {}).setdefault(kind, []).append(rows)
            continue
        for r in np.unique(value[cells]).tolist():
            name = names[r] if 0 <= r < len(names) else f"region_{r}"
            groups.setdefault(name, {}).setdefault(kind, []).append(rows[value[cells] == r])
    joined = {name: {k: np.concatenate(v) for k, v in parts.items()} for name, parts in groups.items()}
    return RawMesh(points, joined)


def load_grid(path: Path) -> tuple[Foreign, NDArray[np.int64]]:
    """VTK's grid of a file, with cells, and VTK's code of each. Raises InputError for files that VTK cannot read."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot read mesh file {path}: {error.strerror}") from None
    if b"UnstructuredGrid" not in data[:4096]:
        raise InputError(
            f"{path}: not a readable VTU file (no UnstructuredGrid in its head); save it as VTK XML unstructured grid"
        )
    _check_counts(path, data)
    grid = _load(path)
    if grid is None or grid.GetNumberOfCells() == 0:
        raise InputError(f"{path}: not a readable VTU file with cells (truncated or of another kind?); write it again")
    return grid, vtk_to_numpy(_cell_types(grid)).astype(np.int64)


def _check_counts(path: Path, data: bytes) -> None:
    """Refuse counts that the size of the file rules out: VTK reserves memory for them, without limit, before it looks."""
    start = data.find(b"<AppendedData")
    head = data[: start if start >= 0 else len(data)]
    limit = SHRINKS * len(data)
    for key, value in re.findall(rb'(NumberOf\w+|offset)\s*=\s*"([^"]*)"', head):
        if not value.strip().isdigit() or int(value) > limit:
            raise InputError(
                f"{path}: not a readable VTU file: {key.decode()} = {value.decode('utf-8', 'replace').strip()!r} cannot be "
                "right; write it again"
            )
    order = ">" if b"BigEndian" in head else "<"
    word = np.dtype(order + ("u8" if b"UInt64" in head.partition(b"header_type")[2][:20] else "u4"))
    count = 3 if b"compressor" in head else 1  # blocks, size of a block, size of the last; or the size alone
    size = count * word.itemsize
    length = 4 * -(-size // 3)  # in base64
    for inline in re.finditer(rb"<(?:Data)?Array\b[^>]*\bbinary\b[^>]*>\s*([^<\s]*)", head):
        _check_sizes(path, _decoded(inline[1][:length])[:size], word, count, limit)
    begin = data.find(b"_", start)
    if start < 0 or begin < 0:
        return
    encoded = b"base64" in data[start:begin]
    for offset in re.findall(rb'offset\s*=\s*"\s*(\d+)', head):
        at = begin + 1 + int(offset)
        header = _decoded(data[at : at + length]) if encoded else data[at : at + size]
        _check_sizes(path, header[:size], word, count, limit)


def _decoded(text: bytes) -> bytes:
    try:
        return base64.b64decode(text)
    except ValueError:
        return b""


def _check_sizes(path: Path, header: bytes, word: Foreign, count: int, limit: int) -> None:
    """Refuse the sizes ``header`` that stand before the data of an array where they cannot be right."""
    words = np.frombuffer(header[: len(header) // word.itemsize * word.itemsize], word)
    if len(words) and words[0] == 0:
        return  # an empty array
    if len(words) != count or (words > limit).any() or int(np.prod(words[:2].astype(float))) > limit:
        raise InputError(f"{path}: not a readable VTU file: the sizes of an array are damaged; write it again")


def _load(path: Path) -> Foreign:
    """The grid in the file, or None where VTK finds fault with it; VTK's own messages are kept quiet."""
    from vtkmodules.vtkCommonCore import vtkObject
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    reader = vtkXMLUnstructuredGridReader()
    failures: list[str] = []
    reader.AddObserver("ErrorEvent", lambda *_: failures.append("error"))
    shown = vtkObject.GetGlobalWarningDisplay()
    vtkObject.GlobalWarningDisplayOff()  # the parser inside the reader reports past the observer
    try:
        reader.SetFileName(str(path))
        reader.Update()
    finally:
        vtkObject.SetGlobalWarningDisplay(shown)
    grid = reader.GetOutput()
    return None if failures or grid is None or grid.GetPoints() is None else grid


def _cell_types(grid: Foreign) -> Foreign:
    """VTK's code of every cell, as its array: the method has changed its name."""
    from vtkmodules.vtkCommonCore import vtkVersion

    version = vtkVersion()
    new = (version.GetVTKMajorVersion(), version.GetVTKMinorVersion()) >= (9, 6)
    return grid.GetCellTypes() if new else grid.GetCellTypesArray()


def _regions(path: Path, grid: Foreign) -> tuple[NDArray[np.int64] | None, list[str]]:
    """Region number of every cell, or None, and the names of regions 0, 1, ..."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    texts = grid.GetFieldData().GetAbstractArray("region_names")
    if texts is not None and not texts.IsA("vtkStringArray"):
        raise InputError(f"{path}: the field data 'region_names' must be strings; write it as a string array")
    found = [texts.GetValue(i) for i in range(texts.GetNumberOfValues())] if texts is not None else []
    names = [name.decode("utf-8", "replace") if isinstance(name, bytes) else name for name in found]
    region = grid.GetCellData().GetAbstractArray("region")
    if region is None:
        return None, names
    values = vtk_to_numpy(region) if region.IsA("vtkDataArray") else np.empty(0)
    if values.shape != (grid.GetNumberOfCells(),) or not np.issubdtype(values.dtype, np.integer):
        raise InputError(f"{path}: the cell data 'region' must be one integer for each cell; write it as integers")
    return values.astype(np.int64), names
