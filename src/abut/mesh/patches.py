"""Which cells lie around each corner of each body: the patches over which stresses are recovered."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut._core import shape_functions, single_rows
from abut.cells import CELLS
from abut.mesh.exterior import Cells, exterior, facets_of
from abut.mesh.mesh import Mesh
from abut.mesh.reference import reference_nodes
from abut.types import Sparse

LINEAR = {"tri": "tri3", "quad": "quad4", "tet": "tet4", "hex": "hex8", "wedge": "wedge6"}


@dataclass(frozen=True)
class Patches:
    """Points of several bodies count once in each: these are the values (n_values,) that a body has at its points.

    point: (n_values,) the mesh's point of each; body: (n_values,) number of its body; nodes: by block of the mesh
    connectivity to values, -1 in cells without a material; corner: (n_patches,) value in the middle of each patch;
    around: (n_patches, n_cells) CSR, nonzero where a cell has that corner; blend: (n_values, n_patches) CSR, shares of the
    patches in each value, which add up to 1; degree: (n_patches,) of the cells; outside: (n_facets, 2) = (cell, local
    facet) of the facets with a cell of their body on one side only; skin: (n_patches, n_facets) CSR, nonzero where such a
    facet has that corner; free: (n_facets,) whether no other body has the facet."""

    point: NDArray[np.int64]
    body: NDArray[np.int64]
    nodes: tuple[NDArray[np.int32], ...]
    corner: NDArray[np.int64]
    around: Sparse
    blend: Sparse
    degree: NDArray[np.int32]
    outside: NDArray[np.int64]
    skin: Sparse
    free: NDArray[np.bool_]

    @cached_property
    def shared(self) -> bool:
        """Whether any point belongs to several bodies."""
        return len(np.unique(self.point)) < len(self.point)

    def of_cells(self, cells: NDArray[np.int64], starts: NDArray[np.int64]) -> NDArray[np.int32]:
        """Values at the nodes of cells (n,) of one block, (n, n_nodes); starts: of the mesh."""
        block = int(np.searchsorted(starts, cells[0], side="right")) - 1
        return np.ascontiguousarray(self.nodes[block][cells - starts[block]])


def patches(mesh: Mesh, body_of: NDArray[np.int32]) -> Patches:
    """Of the bodies of a mesh; body_of: (n_cells,) number of each cell's body, -1 for cells that are left out."""
    n_points, cells = len(mesh.points), _deforming(mesh, body_of)
    bodies = int(body_of.max(initial=-1)) + 1
    used = np.zeros((bodies, n_points), dtype=bool)
    for _, nodes, numbers in cells:
        used[np.broadcast_to(body_of[numbers][:, None], nodes.shape), nodes] = True
    body, point = np.nonzero(used)
    values = np.full((bodies, n_points), -1, dtype=np.int32)
    values[body, point] = np.arange(len(point))
    renumbered = [(kind, values[body_of[numbers][:, None], nodes], numbers) for kind, nodes, numbers in cells]
    is_corner = np.zeros(len(point), dtype=bool)
    degree = np.ones(len(point), dtype=np.int32)
    for kind, nodes, _ in renumbered:
        is_corner[nodes[:, : CELLS[kind].corners]] = True
        if CELLS[kind].degree == 2:
            degree[nodes] = 2
    corner = np.flatnonzero(is_corner)
    patch_of = np.full(len(point), -1)
    patch_of[corner] = np.arange(len(corner))
    rows, facet_corners, free = _outside(renumbered, mesh, len(point), bool((np.bincount(point) > 1).any()))
    facet, k = np.nonzero(facet_corners >= 0)
    skin = _pattern(patch_of[facet_corners[facet, k]], facet, (len(corner), len(rows)))
    return Patches(
        point, body, _by_block(mesh, renumbered), corner, _around(renumbered, patch_of, (len(corner), mesh.n_cells)),
        _blend(renumbered, patch_of, (len(point), len(corner))), degree[corner], rows, skin, free,
    )  # fmt: skip


def _deforming(mesh: Mesh, body_of: NDArray[np.int32]) -> Cells:
    result = []
    for block, first in zip(mesh.blocks, mesh.starts.tolist()):
        rows = np.flatnonzero(body_of[first : first + len(block.nodes)] >= 0)
        result.append((block.kind, block.nodes[rows], first + rows))
    return result


def _by_block(mesh: Mesh, cells: Cells) -> tuple[NDArray[np.int32], ...]:
    result = []
    for block, first, (_, nodes, numbers) in zip(mesh.blocks, mesh.starts.tolist(), cells):
        own = np.full(block.nodes.shape, -1, dtype=np.int32)
        own[numbers - first] = nodes
        result.append(own)
    return tuple(result)


def _outside(
    cells: Cells, mesh: Mesh, n_values: int, shared: bool
) -> tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.bool_]]:
    """Rows (cell, local facet) and corners (n, 4) of the facets that only one cell of its body has, and which of these no
    cell of another body has either."""
    corners, rows = facets_of(cells)
    single = single_rows(corners, n_values)
    if not shared and sum(len(numbers) for _, _, numbers in cells) == mesh.n_cells:
        return rows[single], corners[single], np.ones(len(single), dtype=bool)
    alone = np.zeros((mesh.n_cells, 6), dtype=bool)
    there = exterior(mesh)
    alone[there[:, 0], there[:, 1]] = True
    outside = rows[single]
    return outside, corners[single], alone[outside[:, 0], outside[:, 1]]


def _around(cells: Cells, patch_of: NDArray[np.int64], shape: tuple[int, int]) -> Sparse:
    rows, columns = [], []
    for kind, nodes, numbers in cells:
        corners = nodes[:, : CELLS[kind].corners]
        rows.append(patch_of[corners].ravel())
        columns.append(np.repeat(numbers, corners.shape[1]))
    return _pattern(np.concatenate(rows), np.concatenate(columns), shape)


def _pattern(rows: NDArray[np.int64], columns: NDArray[np.int64], shape: tuple[int, int]) -> Sparse:
    matrix = sp.csr_matrix((np.ones(len(rows)), (rows, columns)), shape=shape)
    matrix.sum_duplicates()
    return matrix


def _blend(cells: Cells, patch_of: NDArray[np.int64], shape: tuple[int, int]) -> Sparse:
    """Between corners the patches' polynomials are blended by the linear shape functions of the corners."""
    rows, columns, shares = [], [], []
    seen = np.zeros(shape[0], dtype=bool)
    for kind, nodes, _ in cells:
        corners = CELLS[kind].corners
        weights = corner_weights(kind)
        for i, row in enumerate(weights):
            used = np.flatnonzero(row)
            values, first = np.unique(nodes[:, i], return_index=True)
            new = first[~seen[values]]
            at = nodes[new, i]
            seen[at] = True
            rows.append(np.repeat(at, len(used)))
            columns.append(patch_of[nodes[new][:, :corners][:, used]].ravel())
            shares.append(np.tile(row[used], len(at)))
    return sp.csr_matrix(
        (np.concatenate(shares), (np.concatenate(rows), np.concatenate(columns))), shape=shape, dtype=float
    )


def corner_weights(kind: str) -> NDArray[np.float64]:
    """The linear shape functions of a cell's corners at its nodes, (nodes, corners)."""
    linear = next(value for name, value in LINEAR.items() if kind.startswith(name))
    weights, _ = shape_functions(CELLS[linear].code, np.ascontiguousarray(reference_nodes(kind)))
    return np.where(np.abs(weights) < 1e-12, 0.0, weights)
