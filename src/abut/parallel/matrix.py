"""The stiffness on the free displacements as a matrix of PETSc's, and what process 0 has of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut._core import padded_blocks
from abut.discretization.supports import Supports
from abut.parallel.partition import Layout
from abut.parallel.team import Store, Team


@dataclass(frozen=True)
class Distributed:
    """On process 0: (n_free, n_free), as far as the search for the active set asks for it."""

    team: Team
    layout: Layout

    @property
    def shape(self) -> tuple[int, int]:
        """As of any matrix."""
        n = len(self.layout.slot)
        return n, n

    def diagonal(self) -> NDArray[np.float64]:
        """(n_free,)."""
        return self.layout.values(self.team.each(_diagonal))

    def __matmul__(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        return self.layout.values(self.team.each(_product, own=self.layout.shares(values)))

    def __add__(self, springs: Any) -> Distributed:
        """With a diagonal matrix added; the matrix itself changes."""
        self.team.each(_stiffen, own=self.layout.shares(springs.diagonal()))
        return self


def reduce(store: Store, starts: NDArray[np.int64], block: int, slot: NDArray[np.int64], free: Any) -> None:
    """Build and keep PETSc's matrix of the stiffness on the free displacements.

    starts, block: as in ``Layout``; free: (dim n_points, k) change of variables of this part's points, on those k free
    displacements that move any of them, in the order of the points; slot: (k,) their places. PETSc adds up what several
    parts have of one entry."""
    from petsc4py import PETSc

    comm, ints = PETSc.COMM_WORLD, PETSc.IntType
    first, last, n = (int(i) for i in (starts[comm.rank], starts[comm.rank + 1], starts[-1]))
    reduced = Supports(free, np.zeros((0, 0))).reduce(store["stiffness"])
    blocks, own = _blocks(reduced, slot, block)
    mapping = PETSc.LGMap().create(blocks.astype(ints), bsize=block, comm=comm)
    shared = PETSc.Mat().createIS(((last - first, n), (last - first, n)), lgmapr=mapping, lgmapc=mapping, comm=comm)
    shared.setISLocalMat(_sequential(own))
    shared.assemble()
    matrix = shared.convert("aij", PETSc.Mat())
    matrix.setBlockSize(block)
    padding = np.ones(last - first, dtype=bool)
    padding[slot[(slot >= first) & (slot < last)] - first] = False
    if padding.any():
        _set_diagonal(matrix, np.where(padding, _largest(matrix, block), _local(matrix)))
    store["matrix"], store["padding"] = matrix, padding


def _blocks(reduced: Any, slot: NDArray[np.int64], block: int) -> tuple[NDArray[np.int64], Any]:
    """Numbers of the blocks that the places belong to, and the matrix filled up to whole blocks, ones on the diagonal."""
    if not len(slot) or block == 1:
        return slot, reduced
    new = np.diff(slot // block, prepend=-1) != 0
    blocks = (slot // block)[new]
    place = block * (np.cumsum(new) - 1) + slot % block
    reduced.sort_indices()
    indptr, indices, values = padded_blocks(
        reduced.indptr.astype(np.int32), reduced.indices.astype(np.int32), reduced.data, place.astype(np.int32), block,
        len(blocks), 1.0,
    )  # fmt: skip
    n = block * len(blocks)
    return blocks, sp.bsr_matrix((values.reshape(-1, block, block), indices, indptr), shape=(n, n)).tocsr()


def _sequential(matrix: Any) -> Any:
    from petsc4py import PETSc

    csr = tuple(part.astype(PETSc.IntType, copy=False) for part in (matrix.indptr, matrix.indices))
    return PETSc.Mat().createAIJ(matrix.shape, csr=(*csr, matrix.data), comm=PETSc.COMM_SELF)


def _local(matrix: Any) -> NDArray[np.float64]:
    """This process's share of the diagonal."""
    return np.array(matrix.getDiagonal().array)


def _largest(matrix: Any, block: int) -> NDArray[np.float64]:
    """The largest diagonal entry of each block, for all of its rows."""
    return np.repeat(_local(matrix).reshape(-1, block).max(axis=1), block)


def _set_diagonal(matrix: Any, values: NDArray[np.float64]) -> None:
    diagonal = matrix.createVecLeft()
    diagonal.array[:] = values
    matrix.setDiagonal(diagonal)


def _diagonal(store: Store) -> NDArray[np.float64]:
    return _local(store["matrix"])


def _stiffen(store: Store, springs: NDArray[np.float64]) -> None:
    _set_diagonal(store["matrix"], _local(store["matrix"]) + springs)


def _product(store: Store, share: NDArray[np.float64]) -> NDArray[np.float64]:
    matrix = store["matrix"]
    x, y = matrix.createVecs()
    x.array[:] = share
    matrix.mult(x, y)
    return np.array(y.array)
