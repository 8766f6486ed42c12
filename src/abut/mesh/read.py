"""From a mesh file to a checked Mesh: groups of the highest dimension are bodies, those one lower surfaces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from abut.cells import CELLS
from abut.checks import LARGEST
from abut.errors import InputError
from abut.io.deck import read_abaqus
from abut.io.gmsh import read_gmsh
from abut.io.names import is_file
from abut.io.raw import RawMesh
from abut.io.vtu import read_vtu
from abut.mesh.cell_block import CellBlock
from abut.mesh.check import check_mesh, inside
from abut.mesh.clockwise import turn_bodies
from abut.mesh.facets import bodies_at, corner_keys, facet_keys, number_keys
from abut.mesh.record import MeshRecord

Kind = TypeVar("Kind", bound=MeshRecord)
Parts = Mapping[str, NDArray[np.int64]]  # cells by type: (n, n_nodes) point numbers
READERS = {".msh": read_gmsh, ".vtu": read_vtu, ".inp": read_abaqus}


def read_mesh(kind: type[Kind], path: Path) -> Kind:
    """Read and check a mesh file by its ending. kind: the record to make. Raises InputError with the remedy for anything
    unsound."""
    mesh = build(kind, read_raw(path), str(path))
    check_mesh(mesh)
    return mesh


def read_raw(path: Path) -> RawMesh:
    """What a mesh file holds, by its ending. Raises InputError for one that is missing or of another kind."""
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(f"{path}: unknown mesh format '{path.suffix}'; supported: {', '.join(READERS)}")
    if not is_file(path):
        raise InputError(f"mesh file {path} does not exist")
    return reader(path)


def build(kind: type[Kind], raw: RawMesh, where: str = "mesh") -> Kind:
    """Make bodies, surfaces and node sets of the groups of a file; points that no cell uses are dropped, and
    plane bodies of clockwise cells turned round."""
    dims = {key: CELLS[key].dim for parts in raw.groups.values() for key in parts if key != "point"}
    top = max(dims.values(), default=0)
    if top < 2:
        raise InputError(f"{where}: no triangles, quadrilaterals or solid cells in the file")
    for parts in raw.groups.values():
        for key, nodes in parts.items():
            if nodes.size and (nodes.min() < 0 or nodes.max() >= len(raw.points)):
                raise InputError(f"{where}: {key} cells use points that the file does not have; write the mesh again")
    bodies, notes = _bodies(raw, {key for key, dim in dims.items() if dim == top}, where)
    blocks, members = _blocks(bodies)
    used = np.unique(np.concatenate([b.nodes.ravel() for b in blocks]))
    number = np.full(len(raw.points), -1)
    number[used] = np.arange(len(used))
    blocks = tuple(CellBlock(b.kind, number[b.nodes].astype(np.int32)) for b in blocks)
    points = _points(raw.points, used, top, where)
    bare = turn_bodies(kind(np.ascontiguousarray(points), blocks, members, notes=tuple(notes)))
    surfaces, node_sets = {}, {}
    for name, parts in raw.groups.items():
        if not name:
            continue
        facets = [corner_keys(number[v[:, : CELLS[k].corners]]) for k, v in parts.items() if dims.get(k) == top - 1]
        if facets:
            surfaces[name] = _match(name, np.unique(np.concatenate(facets), axis=0), bare, where)
        elif name not in members:
            node_sets[name] = _node_set(name, parts, number, where)
    return replace(bare, surfaces=surfaces, node_sets=node_sets)


def _bodies(raw: RawMesh, kinds: set[str], where: str) -> tuple[Mapping[str, Parts], list[str]]:
    """Cells of the highest dimension, of some kinds, by body, and notes on the file."""
    bodies = {n: {k: v for k, v in p.items() if k in kinds} for n, p in raw.groups.items()}
    bodies = {n: p for n, p in bodies.items() if p}
    notes = list(raw.notes)
    if "" not in bodies:
        return bodies, notes
    if len(bodies) == 1:
        return _components(bodies[""], len(raw.points)), notes
    # Cells outside every group are left out, as Gmsh itself does when it saves groups.
    count = sum(len(nodes) for nodes in bodies.pop("").values())
    return bodies, [*notes, f"{where}: {count} cells outside every group of cells were left out"]


def _points(every: NDArray[np.float64], used: NDArray[np.int64], top: int, where: str) -> NDArray[np.float64]:
    """The points that cells of dimension ``top`` use; (x, y) alone where that is 2."""
    points = every[used]
    if not np.isfinite(points).all():
        bad = int(used[~np.isfinite(points).all(axis=1)][0])
        raise InputError(
            f"{where}: point {bad} (counted from 0) has a coordinate that is no number; write the mesh again"
        )
    if np.abs(points).max() > LARGEST:
        bad = int(used[np.argmax(np.abs(points).max(axis=1))])
        raise InputError(
            f"{where}: point {bad} (counted from 0) has a coordinate beyond {LARGEST:g}; write the mesh again"
        )
    if top == 3:
        return points
    if np.ptp(points[:, 2]) > 1e-9 * np.ptp(points, axis=0).max():
        raise InputError(
            f"{where}: the highest cells are triangles or quadrilaterals, but not in a plane z = constant; give them a "
            "thickness (mesh.shells), or, for a solid, its volume a physical group, so that its cells are saved"
        )
    return points[:, :2]


def _node_set(name: str, parts: Parts, number: NDArray[np.int64], where: str) -> NDArray[np.int64]:
    """Points of a group that is no body and no surface; number: (n,) of the file's points in the mesh, or -1."""
    nodes = np.unique(np.concatenate([number[v].ravel() for v in parts.values()]))
    nodes = nodes[nodes >= 0].astype(np.int64)
    if not len(nodes):
        raise InputError(
            f"{where}: no cell of a body uses the points of group '{name}'; take the group out, or give the body "
            "there a physical group"
        )
    return nodes


def _blocks(
    bodies: Mapping[str, Parts],
) -> tuple[tuple[CellBlock, ...], dict[str, NDArray[np.int64]]]:
    """One block for each body and type; a cell listed in two bodies stands in the mesh twice and is found later."""
    blocks, members, first = [], {}, 0
    for name, parts in bodies.items():
        start = first
        for kind, nodes in parts.items():
            blocks.append(CellBlock(kind, nodes.astype(np.int32)))
            first += len(nodes)
        members[name] = np.arange(start, first, dtype=np.int64)
    return tuple(blocks), members


def _components(parts: Parts, n_points: int) -> dict[str, Parts]:
    """Cells without groups: every connected set is a body."""
    ends = [(v[:, :1].repeat(v.shape[1], axis=1).ravel(), v.ravel()) for v in parts.values()]
    a, b = np.concatenate([e[0] for e in ends]), np.concatenate([e[1] for e in ends])
    _, label = connected_components(csr_matrix((np.ones(len(a)), (a, b)), shape=(n_points, n_points)), directed=False)
    labels = np.unique(np.concatenate([label[v[:, 0]] for v in parts.values()]))
    return {
        f"body_{i}": {
            k: v[label[v[:, 0]] == component] for k, v in parts.items() if (label[v[:, 0]] == component).any()
        }
        for i, component in enumerate(labels, start=1)
    }


def _match(name: str, wanted: NDArray[np.int64], mesh: MeshRecord, where: str) -> NDArray[np.int64]:
    """Rows (cell, local facet) of the cells to which the facets with corner keys ``wanted`` belong."""
    keys, rows = facet_keys(mesh, wanted[wanted >= 0])
    keys_here, every = number_keys(wanted, keys)
    count = np.bincount(every, minlength=keys_here.max() + 1)[keys_here]
    if (count == 0).any():
        raise InputError(
            f"{where}: surface '{name}' has {int((count == 0).sum())} facets that belong to no cell of a body; give the "
            "volume next to it a physical group, or take the surface out"
        )
    hit = np.isin(every, keys_here)
    if (count > 1).any():
        cells = rows[np.isin(every, keys_here[count > 1]), 0]
        raise InputError(f"{where}: {inside(name, int((count > 1).sum()), bodies_at(mesh, cells))}")
    return rows[hit]
