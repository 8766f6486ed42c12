"""Sparse matrices of small dense blocks, as the compiled core hands them over: compressed rows (value, column, start)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp

from abut.types import Array, Sparse

CompressedRows = tuple[Array, Array, Array]


def block_rows(parts: CompressedRows, columns: int) -> Sparse:
    """Blocks (n, r, c) in ``columns`` columns of blocks."""
    value, _, start = parts
    return sp.bsr_matrix(parts, shape=(value.shape[1] * (len(start) - 1), value.shape[2] * columns))


def in_place(value: Array, parts: CompressedRows) -> CompressedRows:
    """Other blocks where those of ``parts`` are."""
    return value, parts[1], parts[2]


def weights_of_rows(matrix: Sparse) -> Sparse:
    """A sparse matrix as ``added_up`` takes it."""
    return sp.bsr_matrix(matrix, blocksize=(1, 1))


def added_up(down: Sparse, parts: CompressedRows, columns: int) -> CompressedRows:
    """Rows of blocks (n, r, c) added up with the weights ``down`` (rows, rows of blocks) from ``weights_of_rows``, block by
    block."""
    value, column, start = parts
    r, c = value.shape[1:]
    whole = block_rows((value.reshape(-1, 1, r * c), column, start), columns)
    result = down @ whole
    return result.data.reshape(-1, r, c), result.indices, result.indptr


def interleaved(parts: Sequence[CompressedRows]) -> CompressedRows:
    """Rows of which each has blocks in one part at most."""
    if len(parts) == 1:
        return parts[0]
    value, column = (np.concatenate([part[i] for part in parts]) for i in (0, 1))
    counts = [np.diff(part[2]) for part in parts]
    order = np.argsort(np.concatenate([row_numbers(part[2]) for part in parts]), kind="stable")
    return value[order], column[order], np.concatenate([[0], np.cumsum(np.sum(counts, axis=0))])


def row_numbers(start: Array) -> Array:
    """Of every block."""
    return np.repeat(np.arange(len(start) - 1), np.diff(start))
