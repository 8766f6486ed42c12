"""code_aster's meshes: its own text format (.mail), and MED (.mmed, .med), which is HDF5 and needs h5py."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from foreign_mesh import ForeignMesh, NotReadable, Part

# Name in a .mail file, in MED, and in abut ("": a point, or a cell that abut does not have)
KINDS = {
    "POI1": ("PO1", ""), "SEG2": ("SE2", "line2"), "SEG3": ("SE3", "line3"), "TRIA3": ("TR3", "tri3"),
    "TRIA6": ("TR6", "tri6"),
    "TRIA7": ("TR7", ""), "QUAD4": ("QU4", "quad4"), "QUAD8": ("QU8", "quad8"), "QUAD9": ("QU9", "quad9"),
    "TETRA4": ("TE4", "tet4"), "TETRA10": ("T10", "tet10"), "PENTA6": ("PE6", "wedge6"), "PENTA15": ("P15", "wedge15"),
    "HEXA8": ("HE8", "hex8"), "HEXA20": ("H20", "hex20"), "HEXA27": ("H27", "hex27"), "PYRAM5": ("PY5", ""),
    "PYRAM13": ("P13", ""), "PENTA18": ("P18", ""),
}  # fmt: skip
COUNTS = {
    "POI1": 1, "SEG2": 2, "SEG3": 3, "TRIA3": 3, "TRIA6": 6, "TRIA7": 7, "QUAD4": 4, "QUAD8": 8, "QUAD9": 9, "TETRA4": 4,
    "TETRA10": 10, "PENTA6": 6, "PENTA15": 15, "HEXA8": 8, "HEXA20": 20, "HEXA27": 27, "PYRAM5": 5, "PYRAM13": 13,
    "PENTA18": 18,
}  # fmt: skip


def read_mail(text: str) -> ForeignMesh:
    """A mesh in code_aster's text format. Raises NotReadable for what is not in it."""
    words: list[str] = []
    for line in text.splitlines():
        words += line.split("%")[0].split()
    points: dict[str, list[float]] = {}
    cells: dict[str, list[list[str]]] = {}
    groups: dict[str, dict[str, list[str]]] = {"GROUP_MA": {}, "GROUP_NO": {}}
    at = 0
    while at < len(words) and words[at] != "FIN":
        head, at = words[at].upper(), at + 1
        end = next((i for i in range(at, len(words)) if words[i].upper() == "FINSF"), len(words))
        body, at = words[at:end], end + 1
        if head in ("COOR_2D", "COOR_3D"):
            width = 1 + int(head[5])
            for i in range(0, len(body), width):
                points[body[i]] = [float(x.upper().replace("D", "E")) for x in body[i + 1 : i + width]]
        elif head in COUNTS:
            width = 1 + COUNTS[head]
            cells.setdefault(head, []).extend(body[i : i + width] for i in range(0, len(body), width))
        elif head in groups:
            name, members = _group(body)
            groups[head][name] = members
        elif head not in ("TITRE", "GROUP_FA"):
            raise NotReadable(f".mail: section {head}")
    row = {name: i for i, name in enumerate(points)}
    parts = [
        Part(KINDS[kind][1], [c[0] for c in own], np.array([[row[n] for n in c[1:]] for c in own], dtype=np.int64))
        for kind, own in cells.items()
    ]
    return ForeignMesh(np.array(list(points.values())), list(points), parts, groups["GROUP_MA"], groups["GROUP_NO"])


def _group(body: list[str]) -> tuple[str, list[str]]:
    text = " ".join(body)
    named = re.match(r"NOM *= *(\S+)(?: +(?:NBOBJ|TYPOBJ|NBLIGT|NBLIGE|NUMIN|NUMAUT) *= *\S+)* *(.*)", text)
    if named:
        return named[1], named[2].split()
    return body[0], body[1:]


def read_med(path: Path) -> ForeignMesh:
    """The mesh of a MED file. Raises NotReadable without h5py, and for a file that is none."""
    try:
        import h5py
    except ImportError:
        raise NotReadable("MED meshes need h5py: pip install h5py") from None
    try:
        with h5py.File(path, "r") as file:
            name = next(iter(file["ENS_MAA"]))
            return _med(file["ENS_MAA"][name], file["FAS"][name] if "FAS" in file and name in file["FAS"] else {})
    except (OSError, KeyError, StopIteration) as error:
        raise NotReadable(f"{path.name}: no MED mesh ({error})") from None


def _med(mesh: Any, families: Any) -> ForeignMesh:
    while "NOE" not in mesh:
        mesh = mesh[next(iter(mesh))]
    coordinates = mesh["NOE"]["COO"]
    n = int(coordinates.attrs["NBR"])
    points = np.array(coordinates).reshape(-1, n).T
    names = [f"N{i + 1}" for i in range(n)]
    groups = {kind: dict(_families(families, kind)) for kind in ("NOEUD", "ELEME")}
    nodes = _members(groups["NOEUD"], mesh["NOE"], names)
    parts, cells, first = [], {}, 1
    codes = dict(KINDS.values())
    for code, own in mesh["MAI"].items() if "MAI" in mesh else ():
        if code not in codes:
            raise NotReadable(f"MED cells of type {code}")
        count = int(own["NOD"].attrs["NBR"])
        numbers = [f"M{first + i}" for i in range(count)]
        parts.append(Part(codes[code], numbers, np.array(own["NOD"], dtype=np.int64).reshape(-1, count).T - 1))
        for name, members in _members(groups["ELEME"], own, numbers).items():
            cells.setdefault(name, []).extend(members)
        first += count
    return ForeignMesh(points, names, parts, cells, nodes)


def _families(families: Any, kind: str) -> Iterator[tuple[int, list[str]]]:
    """Number of each family and the groups that it belongs to."""
    for family in families[kind].values() if kind in families else ():
        if "GRO" in family:
            yield int(family.attrs["NUM"]), _names(family["GRO"]["NOM"])


def _names(of: Any) -> list[str]:
    """Names of 80 signs each, as the file has them: newer HDF5 converts such arrays to nothing else."""
    from h5py import h5s

    signs = np.zeros((of.shape[0], 80), dtype=np.int8)
    of.id.read(h5s.ALL, h5s.ALL, signs, mtype=of.id.get_type())
    return [row.tobytes().split(b"\0")[0].decode("latin-1").strip() for row in signs]


def _members(families: dict[int, list[str]], of: Any, names: list[str]) -> dict[str, list[str]]:
    result: dict[str, list[str]] = {}
    if "FAM" in of:
        for name, number in zip(names, np.array(of["FAM"]).tolist()):
            for group in families.get(number, ()):
                result.setdefault(group, []).append(name)
    return result
