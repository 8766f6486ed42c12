"""Meshes of the package meshio: what it reads from some thirty formats, as a checked mesh of abut."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.errors import InputError
from abut.io.raw import RawMesh
from abut.mesh.check import check_mesh
from abut.mesh.mesh import Mesh
from abut.mesh.read import build

TYPES = {  # both order nodes as VTK does
    "vertex": "point", "line": "line2", "line3": "line3", "triangle": "tri3", "triangle6": "tri6", "quad": "quad4",
    "quad8": "quad8", "quad9": "quad9", "tetra": "tet4", "tetra10": "tet10", "hexahedron": "hex8",
    "hexahedron20": "hex20", "hexahedron27": "hex27", "wedge": "wedge6", "wedge15": "wedge15",
}  # fmt: skip
PHYSICAL = "gmsh:physical"
Groups = dict[str, dict[str, list[NDArray[np.int64]]]]


def from_meshio(mesh: Any) -> Mesh:
    """A mesh that meshio has read or made, checked.

    Bodies, surfaces and node sets are what it names: ``cell_sets``, ``point_sets``, and numbers ``gmsh:physical`` with their
    names in ``field_data``. Sets of the cells of highest dimension are bodies, of those one lower surfaces. meshio itself is
    not needed: any object with these attributes will do.

    Parameters
    ----------
    mesh : meshio.Mesh
        Points, cells, and names.

    Returns
    -------
    Mesh
        With bodies, surfaces and node sets by the same names.

    Raises
    ------
    InputError
        For cells that abut does not have, and meshes that are unsound.

    Examples
    --------
    >>> import abut, meshio  # doctest: +SKIP
    >>> mesh = abut.from_meshio(meshio.read("part.med"))  # doctest: +SKIP
    """
    if not (hasattr(mesh, "points") and hasattr(mesh, "cells")):
        raise InputError(f"from_meshio: expected a mesh of meshio, got {type(mesh).__name__}")
    points = np.asarray(mesh.points, dtype=float)
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise InputError(f"from_meshio: expected points of 2 or 3 coordinates, got an array of shape {points.shape}")
    if points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    blocks = [_block(block) for block in mesh.cells]
    groups: Groups = {}
    left = [np.ones(len(nodes), dtype=bool) for _, nodes in blocks]
    for name, number, chosen in _sets(mesh, [key for key, _ in blocks]):
        key, nodes = blocks[number]
        groups.setdefault(name, {}).setdefault(key, []).append(nodes[chosen])
        left[number][chosen] = False
    for (key, nodes), rest in zip(blocks, left):
        if rest.any() and key != "point":
            groups.setdefault("", {}).setdefault(key, []).append(nodes[rest])
    for name, nodes in (getattr(mesh, "point_sets", None) or {}).items():
        groups.setdefault(str(name), {}).setdefault("point", []).append(np.asarray(nodes, np.int64).reshape(-1, 1))
    parts = {name: {key: np.vstack(rows) for key, rows in of.items()} for name, of in groups.items()}
    made = build(Mesh, RawMesh(points, parts), "from_meshio")
    check_mesh(made)
    return made


def _block(block: Any) -> tuple[str, NDArray[np.int64]]:
    """Type and nodes of a block of cells, which may be a pair."""
    kind, nodes = (block.type, block.data) if hasattr(block, "type") else block
    if kind not in TYPES:
        raise InputError(f"from_meshio: cells of type '{kind}' are not known; known are {', '.join(TYPES)}")
    return TYPES[kind], np.asarray(nodes, dtype=np.int64)


def _sets(mesh: Any, kinds: Sequence[str]) -> list[tuple[str, int, NDArray[np.int64]]]:
    """Names with the number of a block and the cells in it; kinds: of the blocks."""
    found = []
    named: Mapping[str, Any] = getattr(mesh, "cell_sets", None) or {}
    for name, by_block in named.items():
        if name.startswith("gmsh:"):
            continue  # what meshio keeps for itself
        if len(by_block) != len(kinds):
            raise InputError(
                f"from_meshio: cell set '{name}' has {len(by_block)} parts, and there are {len(kinds)} blocks"
            )
        for number, chosen in enumerate(by_block):
            if chosen is not None and len(chosen):
                found.append((str(name), number, np.asarray(chosen, dtype=np.int64)))
    if found:
        return found
    tags = (getattr(mesh, "cell_data", None) or {}).get(PHYSICAL)
    names = {(int(tag), int(dim)): name for name, (tag, dim) in (getattr(mesh, "field_data", None) or {}).items()}
    for number, (kind, values) in enumerate(zip(kinds, () if tags is None else tags)):
        dim = 0 if kind == "point" else CELLS[kind].dim
        for tag in np.unique(values):
            if (int(tag), dim) in names:
                found.append((names[int(tag), dim], number, np.flatnonzero(np.asarray(values) == tag)))
    return found
