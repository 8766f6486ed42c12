"""Partition of the mesh: cells by SCOTCH or ParMETIS, points and free displacements by the cells around them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.dofs import place_of
from abut.linear.multigrid import slots
from abut.mesh.cell_block import CellBlock
from abut.mesh.exterior import facets_of, numbered
from abut.mesh.facets import row_codes
from abut.mesh.mesh import Mesh
from abut.parallel.team import Store, Team
from abut.types import Sparse

FEW = 10  # cells a process below which they are dealt out in their order: a partitioner would leave processes empty
PARTITIONERS = ("ptscotch", "parmetis")


@dataclass(frozen=True)
class Piece:
    """What one process has of a mesh: its cells over the points they use; points, cells: their numbers in the whole. Points
    go by their processes, as displacements do in ``Layout``: what ascends in a piece ascends in the whole."""

    mesh: Mesh
    points: NDArray[np.int64]
    cells: NDArray[np.int64]


@dataclass(frozen=True)
class Layout:
    """Where free displacements stand in PETSc's vectors, which have the processes' shares one after the other.

    slot: (n_free,) place of each; starts: (size + 1,) first place of each process; block: places a point, of which
    those that no free displacement takes are padding.
    """

    slot: NDArray[np.int64]
    starts: NDArray[np.int64]
    block: int

    def shares(self, values: NDArray[np.float64]) -> list[tuple[NDArray[np.float64]]]:
        """Values (n_free, ...) as each process's share of a vector, zero on padding."""
        whole = np.zeros((self.starts[-1], *values.shape[1:]))
        whole[self.slot] = values
        return [(share,) for share in np.split(whole, self.starts[1:-1])]

    def values(self, shares: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
        """Back again."""
        return np.asarray(np.concatenate(shares)[self.slot])


def owners(mesh: Mesh, team: Team) -> NDArray[np.int64]:
    """The process of each cell, (n_cells,)."""
    if team.size == 1 or mesh.n_cells <= FEW * team.size:
        return np.sort(np.arange(mesh.n_cells) % team.size)
    graph = cell_graph(mesh)
    bounds = np.linspace(0, mesh.n_cells, team.size + 1).astype(np.int64)
    rows = [
        (graph.indptr[a : b + 1] - graph.indptr[a], graph.indices[graph.indptr[a] : graph.indptr[b]])
        for a, b in pairwise(bounds)
    ]
    return np.concatenate(team.each(_partition, mesh.n_cells, per_rank=rows)).astype(np.int64)


def cell_graph(mesh: Mesh) -> Sparse:
    """Cells that share a facet, (n_cells, n_cells) CSR."""
    corners, row = facets_of(numbered(mesh))
    code = row_codes(np.sort(corners, axis=1))
    order = np.argsort(code)
    same = np.flatnonzero(np.diff(code[order]) == 0)
    one, other = row[order[same], 0], row[order[same + 1], 0]
    graph = sp.csr_matrix((np.ones(len(one), dtype=np.int8), (one, other)), shape=(mesh.n_cells,) * 2)
    return (graph + graph.T).tocsr()


def _partition(store: Store, n: int, indptr: NDArray[np.int32], indices: NDArray[np.int32]) -> NDArray[np.int32]:
    """The process of each cell among this one's rows of the graph."""
    from petsc4py import PETSc

    ints = PETSc.IntType
    weights = np.ones(len(indices))
    graph = PETSc.Mat().createAIJ(
        ((len(indptr) - 1, n), (len(indptr) - 1, n)), csr=(indptr.astype(ints), indices.astype(ints), weights)
    )
    graph.assemble()
    graph = graph.convert("mpiadj", PETSc.Mat())
    partitioning = PETSc.MatPartitioning().create(graph.comm)
    partitioning.setAdjacency(graph)
    partitioning.setType(next(name for name in PARTITIONERS if PETSc.Sys.hasExternalPackage(name)))
    partitioning.setFromOptions()
    result = PETSc.IS()
    partitioning.apply(result)
    return np.array(result.getIndices(), dtype=np.int32)


def point_owners(mesh: Mesh, owner: NDArray[np.int64]) -> NDArray[np.int64]:
    """The process of each point, the first that has a cell there: (n_points,)."""
    result = np.full(len(mesh.points), owner.max(initial=0))
    for block, first in zip(mesh.blocks, mesh.starts.tolist()):
        here = owner[first : first + len(block.nodes)]
        for node in block.nodes.T:
            np.minimum.at(result, node, here)
    return result


def pieces(mesh: Mesh, owner: NDArray[np.int64], size: int, points: NDArray[np.int64] | None = None) -> list[Piece]:
    """The mesh of each process; ``points``: the process of each point, by which the points of a piece are sorted, then by
    number. Names of bodies stay even where a piece has none of their cells; surfaces and node sets are left out."""
    result = []
    place = np.zeros(len(mesh.points), dtype=np.int32)
    number = np.zeros(mesh.n_cells, dtype=np.int64)
    for rank in range(size):
        cells = np.flatnonzero(owner == rank)
        number[cells] = np.arange(len(cells))
        members = [
            (block.kind, block.nodes[cells[(cells >= first) & (cells < first + len(block.nodes))] - first])
            for block, first in zip(mesh.blocks, mesh.starts.tolist())
        ]
        used = np.zeros(len(mesh.points), dtype=bool)
        for _, nodes in members:
            used[nodes] = True
        kept = np.flatnonzero(used)
        if points is not None:
            kept = kept[np.argsort(points[kept], kind="stable")]
        place[kept] = np.arange(len(kept))
        piece = replace(
            mesh,
            points=mesh.points[kept],
            blocks=tuple(CellBlock(kind, place[nodes]) for kind, nodes in members),
            bodies={name: number[numbers[owner[numbers] == rank]] for name, numbers in mesh.bodies.items()},
            surfaces={},
            node_sets={},
        )
        result.append(Piece(piece, kept, cells))
    return result


def layout(
    free: Sparse, owner: NDArray[np.int64], dim: int, size: int, coupled: bool, more: NDArray[np.int64] | None = None
) -> Layout:
    """Places for the columns of ``free`` (dim n_points, n_free), each with the process (``owner``) of its point. Points are
    filled up to ``dim`` places, unless columns are ``coupled``: those go with their first point, one place each.

    more: processes of the last columns, which move no point; one place each for all columns then."""
    if more is not None:
        coupled, free = True, free.tocsc()[:, : free.shape[1] - len(more)]
    columns = free.tocsc()
    columns.sort_indices()
    point = place_of(columns.indices[columns.indptr[:-1]].astype(np.int64), dim)
    block = 1 if coupled else dim
    slot, blocks = (np.arange(len(point)), point) if coupled else slots(free, dim)
    process = np.empty(len(blocks), dtype=np.int64)
    process[slot // block] = owner[point]
    if more is not None:
        slot, process = np.arange(len(point) + len(more)), np.concatenate([process, more])
    place = np.empty_like(process)
    place[np.argsort(process, kind="stable")] = np.arange(len(process))
    starts = block * np.concatenate([[0], np.cumsum(np.bincount(process, minlength=size))]).astype(np.int64)
    return Layout(block * place[slot // block] + slot % block, starts, block)
