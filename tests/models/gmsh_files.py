"""Gmsh files (2.2) of meshes given as points and groups of cells."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

TYPES = {
    "point": (15, 0),
    "line2": (1, 1),
    "line3": (8, 1),
    "tri3": (2, 2),
    "quad4": (3, 2),
    "quad8": (16, 2),
    "hex8": (5, 3),
}


def write_msh(path: Path, points: ArrayLike, groups: Mapping[str, Mapping[str, ArrayLike]]) -> Path:
    """points: (n, 3); groups: name -> kind -> (n, k) rows of points, in Gmsh's order."""
    x = np.asarray(points, dtype=float)
    names, elements = [], []
    for number, (name, parts) in enumerate(groups.items(), start=1):
        dims = {TYPES[kind][1] for kind in parts}
        assert len(dims) == 1
        names.append(f'{dims.pop()} {number} "{name}"')
        for kind, cells in parts.items():
            for cell in np.asarray(cells).reshape(-1, np.asarray(cells).shape[-1]):
                nodes = " ".join(str(n + 1) for n in cell)
                elements.append(f"{len(elements) + 1} {TYPES[kind][0]} 2 {number} {number} {nodes}")
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names)), *names, "$EndPhysicalNames"]
    lines += ["$Nodes", str(len(x)), *(f"{i} {a:.17g} {b:.17g} {c:.17g}" for i, (a, b, c) in enumerate(x, start=1))]
    lines += ["$EndNodes", "$Elements", str(len(elements)), *elements, "$EndElements"]
    path.write_text("\n".join(lines) + "\n")
    return path
