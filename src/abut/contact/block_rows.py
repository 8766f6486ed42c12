"""Sparse matrices of small dense blocks, as the compiled core hands them over: compressed rows (value, column, start)."""

from __future__ import annotations

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


def row_numbers(start: Array) -> Array:
    """Of every block."""
    return np.repeat(np.arange(len(start) - 1), np.diff(start))
