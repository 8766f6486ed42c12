"""Gmsh .msh files, versions 2.2 and 4.1, ASCII and binary.

An own reader: the widely used mesh library has not been maintained since early 2024 and keeps only the first of several
physical groups of a cell, and Gmsh's own library is under the GPL (docs/architecture.md).
"""

from __future__ import annotations

import codecs
from collections import defaultdict
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from abut.errors import InputError
from abut.io.raw import RawMesh
from abut.types import Array

# Gmsh element type -> (abut type, nodes, order of nodes or None where both agree)
_TYPES: dict[int, tuple[str, int, tuple[int, ...] | None]] = {
    15: ("point", 1, None),
    1: ("line2", 2, None),
    8: ("line3", 3, None),
    2: ("tri3", 3, None),
    9: ("tri6", 6, None),
    3: ("quad4", 4, None),
    16: ("quad8", 8, None),
    10: ("quad9", 9, None),
    4: ("tet4", 4, None),
    11: ("tet10", 10, (0, 1, 2, 3, 4, 5, 6, 7, 9, 8)),
    5: ("hex8", 8, None),
    17: ("hex20", 20, (0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15)),
    12: (
        "hex27",
        27,
        (0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15, 22, 23, 21, 24, 20, 25, 26),
    ),
    6: ("wedge6", 6, None),
    18: ("wedge15", 15, (0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11)),
}


class _Source:
    """A cursor over the file's bytes that never reads past the end and says where it stands."""

    def __init__(self, path: Path, data: bytes) -> None:
        self.path, self.data, self.at, self.section = path, data, 0, "$MeshFormat"
        self.binary, self.order = False, "<"

    def fail(self, what: str) -> NoReturn:
        raise InputError(f"{self.path}: {what} in section {self.section} (byte {self.at}); write the mesh again")

    def line(self) -> str:
        end = self.data.find(b"\n", self.at)
        if end < 0:
            self.fail("the file ends too early")
        text, self.at = self.data[self.at : end], end + 1
        return text.decode("utf-8", "replace").strip()

    def array(self, kind: str, count: int) -> Array:
        """``count`` numbers: "i" int32, "q" size_t, "d" double; in ASCII the next tokens."""
        if count < 0 or count > len(self.data):
            self.fail(f"a count of {count} cannot be right")
        if self.binary:
            dtype = np.dtype(self.order + {"i": "i4", "q": "u8", "d": "f8"}[kind])
            end = self.at + dtype.itemsize * count
            if end > len(self.data):
                self.fail("the file ends too early")
            values, self.at = np.frombuffer(self.data[self.at : end], dtype), end
            return values.astype(float if kind == "d" else np.int64)
        parts: list[bytes] = []
        while len(parts) < count:
            end = self.data.find(b"\n", self.at)
            if end < 0 or self.data[self.at : self.at + 1] == b"$":
                self.fail("the section ends too early")
            parts += self.data[self.at : end].split()
            self.at = end + 1
        if len(parts) != count:
            self.fail(f"expected {count} numbers, got {len(parts)}")
        try:
            return np.array(parts, dtype=float if kind == "d" else np.int64)
        except (ValueError, OverflowError):
            self.fail("a token is not a number")


def read_gmsh(path: Path) -> RawMesh:
    """Read a .msh file: physical groups by name, node order as in ``abut.cells``.

    Raises InputError for files that are truncated, of another kind or version, or hold unsupported elements.
    """
    try:
        source = _Source(path, path.read_bytes().removeprefix(codecs.BOM_UTF8))
    except OSError as error:
        raise InputError(f"cannot read mesh file {path}: {error.strerror}") from None
    if not source.data.lstrip().startswith(b"$MeshFormat"):
        raise InputError(f"{path}: not a Gmsh mesh (it does not begin with $MeshFormat); export it as .msh 4.1 or 2.2")
    version = 0.0
    names: dict[tuple[int, int], str] = {}
    entities: dict[tuple[int, int], list[int]] = {}
    points: NDArray[np.float64] | None = None
    numbers: NDArray[np.int64] = np.empty(0, np.int64)
    elements: list[tuple[int, list[tuple[int, int]], NDArray[np.int64]]] | None = None
    while (start := source.data.find(b"$", source.at)) >= 0:
        source.at = start
        source.section = source.line()
        if source.section == "$MeshFormat":
            version = _format(source)
        elif source.section == "$PhysicalNames":
            names = _names(source)
        elif source.section == "$Entities":
            entities = _entities(source)
        elif source.section == "$PartitionedEntities":
            raise InputError(f"{path}: partitioned meshes are not supported; save it without partitions")
        elif source.section == "$Nodes":
            numbers, points = _nodes_4(source) if version >= 4 else _nodes_2(source)
        elif source.section == "$Elements":
            elements = _elements_4(source, entities) if version >= 4 else _elements_2(source)
        elif not source.section.startswith("$End"):
            end = source.data.find(b"$End" + source.section[1:].encode(), source.at)
            if end < 0:
                source.fail("the file ends too early")
            source.at = end
            continue
        else:
            continue
        source.section = "after " + source.section
        if not source.line().startswith("$End") and not source.line().startswith("$End"):
            source.fail("the section does not end where it should")
    if points is None or elements is None:
        raise InputError(f"{path}: no $Nodes or no $Elements section; the file is truncated or empty: write it again")
    return _collect(path, points, numbers, elements, names)


def _format(source: _Source) -> float:
    parts = source.line().split()
    try:
        version, binary, size = float(parts[0]), int(parts[1]), int(parts[2])
    except (IndexError, ValueError):
        source.fail("cannot read the format line")
    if version not in (2.2, 4.1) or size != 8:
        raise InputError(f"{source.path}: MSH version {parts[0]} is not supported; export it as 4.1 or 2.2")
    if binary:
        one = source.data[source.at : source.at + 4]
        source.order = "<" if one == b"\x01\x00\x00\x00" else ">"
        source.at += 4
        if source.data[source.at : source.at + 1] == b"\n":
            source.at += 1
        source.binary = True
    return version


def _names(source: _Source) -> dict[tuple[int, int], str]:
    result = {}
    try:
        for _ in range(int(source.line())):
            dim, tag, name = source.line().split(maxsplit=2)
            result[int(dim), int(tag)] = name.strip().strip('"')
    except ValueError:
        source.fail("cannot read a physical name")
    return result


def _entities(source: _Source) -> dict[tuple[int, int], list[int]]:
    result = {}
    counts = source.array("q", 4)
    for dim, count in enumerate(counts):
        for _ in range(int(count)):
            if source.binary:
                tag = int(source.array("i", 1)[0])
                source.array("d", 3 if dim == 0 else 6)
                physical = source.array("i", int(source.array("q", 1)[0]))
                if dim:
                    source.array("i", int(source.array("q", 1)[0]))
            else:
                parts = source.line().split()
                skip = 4 if dim == 0 else 7
                try:
                    tag, n = int(parts[0]), int(parts[skip])
                    physical = np.array([int(p) for p in parts[skip + 1 : skip + 1 + n]], dtype=np.int64)
                except (IndexError, ValueError, OverflowError):
                    source.fail("cannot read an entity")
            result[dim, tag] = [abs(int(p)) for p in physical]
    return result


def _nodes_4(source: _Source) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    blocks = int(source.array("q", 4)[0])
    tags, points = [], []
    for _ in range(blocks):
        if source.binary:
            parametric = int(source.array("i", 3)[2])
            count = int(source.array("q", 1)[0])
        else:
            head = source.array("q", 4)
            parametric, count = int(head[2]), int(head[3])
        if parametric:
            source.fail("parametric nodes are not supported; export without them")
        tags.append(source.array("q", count))
        points.append(source.array("d", 3 * count).reshape(-1, 3))
    if not tags:
        source.fail("there are no nodes")
    return np.concatenate(tags).astype(np.int64), np.concatenate(points)


def _nodes_2(source: _Source) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    count = _count_line(source)
    if source.binary:
        record = np.dtype([("tag", source.order + "i4"), ("x", source.order + "f8", 3)])
        end = source.at + record.itemsize * count
        if count > len(source.data) or end > len(source.data):
            source.fail("the file ends too early")
        data = np.frombuffer(source.data[source.at : end], record)
        source.at = end
        return data["tag"].astype(np.int64), data["x"].astype(float)
    table = source.array("d", 4 * count).reshape(-1, 4)
    if not (np.abs(table[:, 0]) < 2.0**53).all():
        source.fail("a node number cannot be right")
    return table[:, 0].astype(np.int64), table[:, 1:]


def _count_line(source: _Source) -> int:
    try:
        return int(source.line())
    except ValueError:
        source.fail("cannot read the count")


def _type(source: _Source, code: int) -> tuple[str, int, tuple[int, ...] | None]:
    if code not in _TYPES:
        raise InputError(
            f"{source.path}: Gmsh element type {code} is not supported (only first and second order lines, triangles, "
            "quadrilaterals, tetrahedra, hexahedra and prisms are); mesh with order 1 or 2"
        )
    return _TYPES[code]


def _elements_4(
    source: _Source, entities: dict[tuple[int, int], list[int]]
) -> list[tuple[int, list[tuple[int, int]], NDArray[np.int64]]]:
    blocks = int(source.array("q", 4)[0])
    result = []
    for _ in range(blocks):
        if source.binary:
            dim, tag, code = (int(v) for v in source.array("i", 3))
            count = int(source.array("q", 1)[0])
        else:
            dim, tag, code, count = (int(v) for v in source.array("q", 4))
        nodes = _type(source, code)[1]
        table = source.array("q", count * (nodes + 1)).reshape(count, nodes + 1)
        groups = [(dim, physical) for physical in entities.get((dim, tag), [])]
        result.append((code, groups, table[:, 1:].astype(np.int64)))
    return result


def _elements_2(source: _Source) -> list[tuple[int, list[tuple[int, int]], NDArray[np.int64]]]:
    count = _count_line(source)
    rows: dict[tuple[int, int], list[Any]] = defaultdict(list)
    done = 0
    while done < count:
        if source.binary:
            code, n, tags = (int(v) for v in source.array("i", 3))
            nodes = _type(source, code)[1]
            if n < 1 or tags < 0:
                source.fail(f"cannot read element {done + 1}")
            table = source.array("i", n * (1 + tags + nodes)).reshape(n, -1)
            for physical in np.unique(table[:, 1]) if tags else [0]:
                tagged = table[table[:, 1] == physical] if tags else table
                rows[code, int(physical)].extend(tagged[:, 1 + tags :].tolist())
            done += n
            continue
        try:
            parts = [int(p) for p in source.line().split()]
            code, tags = parts[1], parts[2]
        except (ValueError, IndexError):
            source.fail(f"cannot read element {done + 1}")
        if tags < 0 or len(parts) != 3 + tags + _type(source, code)[1] or max(map(abs, parts)) >= 2**62:
            source.fail(f"cannot read element {done + 1}")
        rows[code, parts[3] if tags else 0].append(parts[3 + tags :])
        done += 1
    dims = {"point": 0, "line": 1, "tri": 2, "quad": 2}
    result = []
    for (code, physical), nodes_of in rows.items():
        name = _TYPES[code][0].rstrip("0123456789")
        groups = [(dims.get(name, 3), abs(physical))] if physical else []  # negative: turned round
        result.append((code, groups, np.array(nodes_of, dtype=np.int64)))
    return result


def _collect(
    path: Path,
    points: NDArray[np.float64],
    numbers: NDArray[np.int64],
    elements: list[tuple[int, list[tuple[int, int]], NDArray[np.int64]]],
    names: dict[tuple[int, int], str],
) -> RawMesh:
    order = np.argsort(numbers)
    ordered = numbers[order]
    if (np.diff(ordered) == 0).any():
        twice = int(ordered[:-1][np.diff(ordered) == 0][0])
        raise InputError(f"{path}: node {twice} stands in the file twice; it is damaged: write it again")
    parts: dict[str, dict[str, list[NDArray[np.int64]]]] = {}
    for code, groups, nodes in elements:
        kind, _, permutation = _TYPES[code]
        position = np.searchsorted(ordered, nodes)
        if (position >= len(ordered)).any() or (ordered[np.minimum(position, len(ordered) - 1)] != nodes).any():
            raise InputError(f"{path}: elements use nodes that the file does not list; it is damaged: write it again")
        rows = order[position]
        if permutation is not None:
            rows = rows[:, permutation]
        every: list[tuple[int, int] | None] = [*groups] or [None]
        for key in every:
            name = "" if key is None else names.get(key, f"group_{key[0]}_{key[1]}")
            parts.setdefault(name, {}).setdefault(kind, []).append(rows)
    return RawMesh(points, {n: {k: np.concatenate(v) for k, v in kinds.items()} for n, kinds in parts.items()})
