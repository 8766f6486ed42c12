"""From a mesh file to a checked Mesh: groups of the highest dimension are bodies, those one lower surfaces."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from abut.cells import CELLS
from abut.errors import InputError
from abut.io.gmsh import read_gmsh
from abut.io.raw import RawMesh
from abut.io.vtu import read_vtu
from abut.mesh.check import check_mesh
from abut.mesh.mesh import CellBlock, Mesh

READERS = {".msh": read_gmsh, ".vtu": read_vtu}


def read_mesh(path: Path) -> Mesh:
    """Read and check a mesh file by its ending. Raises InputError with the remedy for anything unsound."""
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(f"{path}: unknown mesh format '{path.suffix}'; supported: {', '.join(READERS)}")
    if not path.is_file():
        raise InputError(f"mesh file {path} does not exist")
    mesh = build(reader(path), str(path))
    check_mesh(mesh)
    return mesh


def build(raw: RawMesh, where: str = "mesh") -> Mesh:
    """Make bodies, surfaces and node sets of the groups of a file; points that no cell uses are dropped."""
    dims = {kind: CELLS[kind].dim for parts in raw.groups.values() for kind in parts if kind != "point"}
    top = max(dims.values(), default=0)
    if top < 2:
        raise InputError(f"{where}: no triangles, quadrilaterals or solid cells in the file")
    bodies = {n: {k: v for k, v in p.items() if dims.get(k) == top} for n, p in raw.groups.items()}
    bodies = {n: p for n, p in bodies.items() if p}
    if "" in bodies and len(bodies) > 1:
        bodies.pop("")  # cells outside every group are left out, as Gmsh itself does when it saves groups
    elif "" in bodies:
        bodies = _components(bodies[""], len(raw.points))
    blocks, members = _blocks(bodies)
    used = np.unique(np.concatenate([b.nodes.ravel() for b in blocks]))
    number = np.full(len(raw.points), -1)
    number[used] = np.arange(len(used))
    blocks = tuple(CellBlock(b.kind, number[b.nodes].astype(np.int32)) for b in blocks)
    points = raw.points[used]
    if top == 2:
        if np.ptp(points[:, 2]) > 1e-9 * np.ptp(points, axis=0).max():
            raise InputError(f"{where}: the cells are plane but not in a plane z = constant; shells are not supported")
        points = points[:, :2]
    bare = Mesh(np.ascontiguousarray(points), blocks, members)
    keys, rows = _boundary_keys(bare)
    surfaces, node_sets = {}, {}
    for name, parts in raw.groups.items():
        if not name:
            continue
        facets = [number[v[:, : CELLS[k].corners]] for k, v in parts.items() if dims.get(k) == top - 1]
        if facets:
            surfaces[name] = _match(name, facets, keys, rows, where)
        elif name not in members:
            nodes = np.unique(np.concatenate([number[v].ravel() for v in parts.values()]))
            node_sets[name] = nodes[nodes >= 0].astype(np.int64)
    return Mesh(bare.points, blocks, members, surfaces, node_sets)


def _blocks(
    bodies: dict[str, dict[str, NDArray[np.int64]]],
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


def _components(parts: dict[str, NDArray[np.int64]], n_points: int) -> dict[str, dict[str, NDArray[np.int64]]]:
    """Cells without groups: every connected set is a body."""
    ends = [(v[:, :1].repeat(v.shape[1], axis=1).ravel(), v.ravel()) for v in parts.values()]
    a, b = np.concatenate([e[0] for e in ends]), np.concatenate([e[1] for e in ends])
    _, label = connected_components(csr_matrix((np.ones(len(a)), (a, b)), shape=(n_points, n_points)), directed=False)
    labels = np.unique(np.concatenate([label[v[:, 0]] for v in parts.values()]))
    return {
        f"body_{i}": {k: v[label[v[:, 0]] == own] for k, v in parts.items() if (label[v[:, 0]] == own).any()}
        for i, own in enumerate(labels, start=1)
    }


def _key(corners: NDArray[np.int64]) -> NDArray[np.int64]:
    """Facets as sorted corner numbers, padded to four with -1."""
    result = np.full((len(corners), 4), -1, dtype=np.int64)
    result[:, : corners.shape[1]] = np.sort(corners, axis=1)
    return result


def _boundary_keys(mesh: Mesh) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Corner keys (n, 4) of all facets of all cells, and their rows (cell, local)."""
    keys, rows = [], []
    for block, first in zip(mesh.blocks, mesh.starts):
        for local, (kind, nodes) in enumerate(CELLS[block.kind].facets):
            keys.append(_key(block.nodes[:, nodes[: CELLS[kind].corners]].astype(np.int64)))
            cells = first + np.arange(len(block.nodes))
            rows.append(np.stack([cells, np.full(len(cells), local)], axis=1))
    return np.concatenate(keys), np.concatenate(rows)


def _match(
    name: str, facets: list[NDArray[np.int64]], keys: NDArray[np.int64], rows: NDArray[np.int64], where: str
) -> NDArray[np.int64]:
    """Find the cells to which a surface's facets belong."""
    wanted = np.unique(np.concatenate([_key(f) for f in facets]), axis=0)
    every, inverse = np.unique(np.concatenate([wanted, keys]), axis=0, return_inverse=True)
    inverse = inverse.ravel()
    flag = np.zeros(len(every), dtype=bool)
    flag[inverse[: len(wanted)]] = True
    hit = np.flatnonzero(flag[inverse[len(wanted) :]])
    owner = inverse[len(wanted) :][hit]
    count = np.bincount(owner, minlength=len(every))[inverse[: len(wanted)]]
    if (count == 0).any():
        raise InputError(
            f"{where}: surface '{name}' has {int((count == 0).sum())} facets that belong to no cell of a body; give the "
            "volume next to it a physical group, or take the surface out"
        )
    if (count > 1).any():
        raise InputError(
            f"{where}: surface '{name}' lies inside the material ({int((count > 1).sum())} facets have cells on both "
            "sides); contact needs bodies that do not share nodes: mesh them separately"
        )
    return rows[hit].astype(np.int64)
