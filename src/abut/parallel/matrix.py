"""The stiffness on the free displacements as a distributed PETSc matrix, and its handle on process 0."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut._core import padded_blocks
from abut.parallel.partition import Layout
from abut.parallel.team import Kept, Store, Team
from abut.problem.constraints import Constraints
from abut.types import Foreign, Sparse


@dataclass(frozen=True)
class Distributed:
    """On process 0: (n_free, n_free), as far as the search for the contact status asks for it. kept: PETSc's matrix, of the
    bodies; beside: what process 0 adds to it, sparse, of springs, contact and loads that follow: no more than surfaces."""

    team: Team
    layout: Layout
    kept: Kept
    beside: Sparse | None = None

    @property
    def shape(self) -> tuple[int, int]:
        """As of any matrix."""
        n = len(self.layout.slot)
        return n, n

    def diagonal(self) -> NDArray[np.float64]:
        """(n_free,)."""
        own = self.layout.values(self.team.each(_diagonal, self.kept.number))
        return own if self.beside is None else own + self.beside.diagonal()

    def __matmul__(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        if values.ndim > 1:
            return np.stack([self @ column for column in values.T], axis=1) if values.size else values
        if not values.any():  # as at the state that a problem is linearised about
            return np.zeros_like(values)
        own = self.layout.values(self.team.each(_product, self.kept.number, per_rank=self.layout.shares(values)))
        return own if self.beside is None else np.asarray(own + self.beside @ values)

    def __add__(self, other: Sparse | Distributed) -> Distributed:
        if isinstance(other, Distributed):
            kept, more = self._made(_sum, other.kept.number), other.beside
            return replace(self, kept=kept) if more is None else replace(self, kept=kept) + more
        return replace(self, beside=other.tocsr() if self.beside is None else self.beside + other)

    def __rmul__(self, factor: float) -> Distributed:
        beside = None if self.beside is None else factor * self.beside
        return replace(self, kept=self._made(_scaled, factor), beside=beside)

    @property
    def T(self) -> Distributed:
        """Transposed."""
        beside = None if self.beside is None else self.beside.T.tocsr()
        return replace(self, kept=self._made(_transposed), beside=beside)

    def _made(self, function: Callable[..., Foreign], *arguments: float) -> Kept:
        """What function(PETSc's matrix, store, *arguments) returns, kept by every process."""
        kept = self.team.keep()
        self.team.each(_make, function, self.kept.number, kept.number, *arguments)
        return kept

    def __radd__(self, other: Sparse | int) -> Distributed:
        return self if isinstance(other, int) else self + other  # a sum begins with zero

    def __sub__(self, other: Sparse | Distributed) -> Distributed:
        return self + -1.0 * other

    def beside_by_process(self) -> list[Sparse | None]:
        """The rows of ``beside`` that belong to each process, at their places among its own, columns at those among all."""
        if self.beside is None:
            return [None] * self.team.size
        starts, entries = self.layout.starts, self.beside.tocoo()
        slot, n = self.layout.slot, int(starts[-1])
        placed = sp.csr_matrix((entries.data, (slot[entries.row], slot[entries.col])), shape=(n, n))
        return [placed[a:b] for a, b in pairwise(starts.tolist())]

    def of_bodies(self) -> Distributed:
        """Without what contact and loads add to it."""
        return replace(self, beside=None)

    def whole(self) -> Distributed:
        """With all of it in PETSc's matrix; the same object where it is."""
        if self.beside is None:
            return self
        kept = self.team.keep()
        self.team.each(_add, self.kept.number, kept.number, per_rank=[(rows,) for rows in self.beside_by_process()])
        return replace(self, kept=kept, beside=None)

    @contextmanager
    def with_springs(self, springs: NDArray[np.float64]) -> Iterator[None]:
        """With springs (n_free,) to the ground for a while."""
        self.team.each(_hold, self.kept.number, per_rank=self.layout.shares(springs))
        try:
            yield
        finally:
            self.team.each(_release, self.kept.number)


def tell(store: Store, slot: NDArray[np.int64], free: Sparse) -> None:
    """Keep this part's share of the change of variables. free: (dim n_points, k) of this part's points, on those k free
    displacements that move any of them; slot: (k,) their places, ascending."""
    store["variables"] = slot, free


def reduce(
    store: Store, tangent: str | int, into: int, starts: NDArray[np.int64], block: int, added: bool = False
) -> None:
    """Build PETSc's matrix of a tangent stiffness on the free displacements and keep it under the number ``into``.

    tangent: where the part's own is; it goes, to make room, unless it is to be reduced again. starts, block: as in
    ``Layout``; added: to a stiffness: the part's own stays, and padding is zero. Rows at the border between parts get what
    the others have of them."""
    from petsc4py import PETSc

    comm = PETSc.COMM_WORLD
    slot, free = store["variables"]
    first, last = (int(i) for i in (starts[comm.rank], starts[comm.rank + 1]))
    stays = added or (tangent == "stiffness" and store["again"])
    own = store[tangent] if stays else store.pop(tangent)
    rows = _own_rows(own, slot, free, block, starts // block, comm.tompi4py()).tocsr()
    if block == 1 or added:  # of stresses that are zero nothing may be stored
        rows = _with_diagonal(rows, first)
    matrix = matrix_of(rows, comm)
    matrix.setBlockSize(block)
    padding = np.ones(last - first, dtype=bool)
    padding[slot[(slot >= first) & (slot < last)] - first] = False
    _set_diagonal(matrix, np.where(padding, 0.0 if added else _largest(matrix, block), _local(matrix)))
    store[into] = matrix


def _blocks(stiffness: Sparse, slot: NDArray[np.int64], free: Sparse, block: int) -> tuple[NDArray[np.int64], Sparse]:
    """Numbers of the blocks that the places belong to, and the stiffness in whole blocks, BSR, ones on the diagonal where
    there is no free displacement."""
    reduced = Constraints(free, np.zeros((0, 0))).reduce(stiffness)
    reduced.sort_indices()
    new = np.diff(slot // block, prepend=-1) != 0
    blocks = (slot // block)[new]
    place = block * (np.cumsum(new) - 1) + slot % block
    if block == 1 or not len(slot):
        return blocks, reduced.tobsr((block, block))
    indptr, indices, values = padded_blocks(
        reduced.indptr.astype(np.int32), reduced.indices.astype(np.int32, copy=False), reduced.data,
        place.astype(np.int32), block, len(blocks), 1.0,
    )  # fmt: skip
    n = block * len(blocks)
    return blocks, sp.bsr_matrix((values.reshape(-1, block, block), indices, indptr), shape=(n, n))


def _own_rows(
    stiffness: Sparse, slot: NDArray[np.int64], free: Sparse, block: int, starts: NDArray[np.int64], comm: Foreign
) -> Sparse:
    """The rows of this process, columns numbered as in the whole, BSR: what it has itself and what others have of them.

    starts: first block of each process."""
    blocks, matrix = _blocks(stiffness, slot, free, block)
    owner = np.searchsorted(starts, blocks, side="right") - 1
    others = [rank if rank != comm.rank and (owner == rank).any() else None for rank in range(comm.size)]
    away = [None if rank is None else _rows_of(rank, matrix, blocks, starts) for rank in others]
    received = [rows for rows in comm.alltoall(away) if rows is not None]
    local = _rows_of(comm.rank, matrix, blocks, starts)
    del away, matrix  # as large as the stiffness
    return local + sum(received[1:], received[0]) if received else local


def _with_diagonal(rows: Sparse, first: int) -> Sparse:
    """Rows from ``first`` on of a matrix with all diagonal entries stored: a free rigid body has no stiffness of its own."""
    entries, n = rows.tocoo(), np.arange(rows.shape[0])
    row, column = np.concatenate([entries.row, n]), np.concatenate([entries.col, first + n])
    return sp.csr_matrix((np.concatenate([entries.data, np.zeros(len(n))]), (row, column)), shape=rows.shape)


def _rows_of(process: int, matrix: Sparse, blocks: NDArray[np.int64], starts: NDArray[np.int64]) -> Sparse:
    """Those of a part's rows that belong to a process, at their places among all of its rows, BSR."""
    first, last = starts[process : process + 2]
    begin, end = np.searchsorted(blocks, (first, last))  # what ascends in a part ascends in the whole
    entries = slice(matrix.indptr[begin], matrix.indptr[end])
    indptr = np.zeros(last - first + 1, dtype=np.int32)
    indptr[blocks[begin:end] - first + 1] = np.diff(matrix.indptr[begin : end + 1])
    size = matrix.blocksize[0]
    result = sp.bsr_matrix(
        (matrix.data[entries], blocks[matrix.indices[entries]].astype(np.int32), np.cumsum(indptr, dtype=np.int32)),
        shape=(size * (last - first), size * starts[-1]),
    )
    result.has_canonical_format = True
    return result


def _local(matrix: Foreign) -> NDArray[np.float64]:
    """This process's share of the diagonal."""
    return np.array(matrix.getDiagonal().array)


def _largest(matrix: Sparse, block: int) -> NDArray[np.float64]:
    """The largest diagonal entry of each block, for all of its rows."""
    return np.repeat(_local(matrix).reshape(-1, block).max(axis=1), block)


def _set_diagonal(matrix: Foreign, values: NDArray[np.float64]) -> None:
    diagonal = matrix.createVecLeft()
    diagonal.array[:] = values
    matrix.setDiagonal(diagonal)


def _make(store: Store, function: Callable[..., Foreign], number: int, into: int, *arguments: float) -> None:
    store[into] = function(store[number], store, *arguments)


def _sum(matrix: Foreign, store: Store, other: int) -> Foreign:
    result = matrix.copy()
    result.axpy(1.0, store[other], result.Structure.DIFFERENT_NONZERO_PATTERN)
    return result


def _scaled(matrix: Foreign, store: Store, factor: float) -> Foreign:
    result = matrix.copy()
    result.scale(factor)
    return result


def _transposed(matrix: Foreign, store: Store) -> Foreign:
    return matrix.transpose(type(matrix)())


def _diagonal(store: Store, number: int) -> NDArray[np.float64]:
    return _local(store[number])


def _add(store: Store, number: int, into: int, rows: Sparse) -> None:
    matrix = store[number]
    block = matrix.getBlockSize()
    whole = (own_rows(matrix).tobsr((block, block)) + rows.tobsr((block, block))).tocsr()
    result = matrix_of(whole if block > 1 else _with_diagonal(whole, matrix.getOwnershipRange()[0]), matrix.comm)
    result.setBlockSize(block)
    store[into] = result


def own_rows(matrix: Foreign) -> Sparse:
    """The rows of one of PETSc's matrices that this process has, CSR."""
    indptr, indices, values = matrix.getValuesCSR()
    return sp.csr_matrix((values, indices, indptr), shape=(matrix.getLocalSize()[0], matrix.getSize()[1]))


def matrix_of(rows: Sparse, comm: Foreign) -> Foreign:
    """PETSc's square matrix that has these rows, CSR, on this process."""
    from petsc4py import PETSc

    ints, shape = PETSc.IntType, (rows.shape[0], rows.shape[1])
    rows.sort_indices()
    csr = rows.indptr.astype(ints, copy=False), rows.indices.astype(ints, copy=False), rows.data
    return PETSc.Mat().createAIJ((shape, shape), csr=csr, comm=comm)


def _hold(store: Store, number: int, springs: NDArray[np.float64]) -> None:
    store["diagonal"] = _local(store[number])
    _set_diagonal(store[number], store["diagonal"] + springs)


def _release(store: Store, number: int) -> None:
    _set_diagonal(store[number], store.pop("diagonal"))


def _product(store: Store, number: int, share: NDArray[np.float64]) -> NDArray[np.float64]:
    matrix = store[number]
    x, y = matrix.createVecs()
    x.array[:] = share
    matrix.mult(x, y)
    return np.array(y.array)
