"""Which points a multigrid aggregate may take in: the near ones.

Where cells are long and thin, displacements across the short side hang together far more than along the long one; entries
of the matrix do not show it (finite elements couple all nodes of a cell), distances do, as in the distance Laplacians of
Gee, Siefert, Hu, Tuminaro and Sala 2006. Aggregates then coarsen across thin cells alone until they are no longer thin.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut._core import strong_part
from abut.types import Sparse

REACH = 2.5  # times the distance of the nearest point: takes in all of a cube, and half of its edge with nodes at the middle


def near(matrix: Sparse, points: NDArray[np.float64]) -> Sparse:
    """The matrix (BSR) without couplings to far points, theory (V12), which are added to the diagonal so that translations
    do no more work than before; the matrix itself where no point is far. points: (n_block_rows, dim)."""
    part = strong_part(
        matrix.indptr.astype(np.int32, copy=False), matrix.indices.astype(np.int32, copy=False), matrix.data,
        np.ascontiguousarray(points), REACH,
    )  # fmt: skip
    if part is None:
        return matrix
    indptr, indices, blocks = part
    return sp.bsr_matrix((blocks.reshape(-1, *matrix.blocksize), indices, indptr), shape=matrix.shape)


def means(aggregates: Sparse, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Where aggregates are. aggregates: (n_points, n_aggregates) of ones."""
    count = np.asarray(aggregates.sum(axis=0)).ravel()
    return np.asarray((aggregates.T @ points) / np.maximum(count, 1)[:, None])
