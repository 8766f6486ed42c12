"""A stiffness with unknowns beside the displacements that belong to bodies alone: pressures that are continuous.

Each of them ties many displacements together. Eliminated, they fill the matrix; kept, they border it with rows that are as
sparse as its own. Everything but a direct solver sees the eliminated matrix, as an operator.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.types import Array, Operator, Sparse


@dataclass(frozen=True)
class Bordered:
    """The matrix A + R^T diag(w) R, theory (E10). matrix: (n, n) CSR A; rows: (m, n) CSR R; weight: (m,) w of any sign."""

    matrix: Sparse
    rows: Sparse
    weight: NDArray[np.float64]

    @property
    def shape(self) -> tuple[int, int]:
        """Of the operator, (n, n)."""
        return self.matrix.shape

    @property
    def T(self) -> Bordered:
        """Transposed."""
        return Bordered(self.matrix.T.tocsr(), self.rows, self.weight)

    def diagonal(self) -> NDArray[np.float64]:
        """(n,)."""
        squares = self.rows.copy()
        squares.data = squares.data**2
        return np.asarray(self.matrix.diagonal() + squares.T @ self.weight)

    def tocsr(self) -> Sparse:
        """The border eliminated: many more entries than ``matrix`` has."""
        return (self.matrix + self.rows.T @ sp.diags(self.weight) @ self.rows).tocsr()

    def within(self, basis: Sparse, reduced: Sparse) -> Bordered:
        """basis^T of it basis, (k, k), for basis (n, k) sparse; reduced: that of ``matrix``."""
        return Bordered(reduced, (self.rows @ basis).tocsr(), self.weight)

    def whole(self) -> Sparse:
        """[A, S^T; S, -C] (n + m, n + m) CSR, theory (E12): with zeros for all but displacements on its right-hand side it
        has the same solution. Rows are scaled so that their entries are of the size of those of A, and none is divided
        by a weight, which may be zero."""
        unit = float(np.median(np.abs(self.matrix.diagonal())))
        largest = _row_max(self.rows)
        scale, size = unit / largest, np.abs(self.weight)
        share = 1.0 / (size / scale**2 + 1.0 / unit)
        rows = sp.diags(np.sqrt(size * share)) @ self.rows
        corner = sp.diags(np.where(self.weight < 0.0, share, -share))
        return sp.bmat([[self.matrix, rows.T], [rows, corner]], format="csr")

    def __matmul__(self, other: Array) -> Array:
        """Times vectors (n,) or (n, k), or a sparse matrix."""
        product = self.rows @ other
        if sp.issparse(product):
            return self.matrix @ other + self.rows.T @ (sp.diags(self.weight) @ product)
        weighted = product * (self.weight if product.ndim == 1 else self.weight[:, None])
        return np.asarray(self.matrix @ other + self.rows.T @ weighted)

    def __add__(self, other: Operator) -> Bordered:
        """With a sparse matrix, with another of its kind, or with 0, of which sums begin."""
        if isinstance(other, Bordered):
            rows = sp.vstack([self.rows, other.rows], format="csr")
            return Bordered(self.matrix + other.matrix, rows, np.concatenate([self.weight, other.weight]))
        if np.isscalar(other):
            return self if other == 0 else cast(Bordered, NotImplemented)
        return Bordered((self.matrix + other).tocsr(), self.rows, self.weight)

    __radd__ = __add__

    def __neg__(self) -> Bordered:
        return -1.0 * self

    def __sub__(self, other: Operator) -> Bordered:
        return self + -other

    def __mul__(self, factor: float) -> Bordered:
        return Bordered((self.matrix * factor).tocsr(), self.rows, self.weight * factor)

    __rmul__ = __mul__


def eliminated(matrix: Operator) -> Operator:
    """Without a border; the same object where there is none."""
    return matrix.tocsr() if isinstance(matrix, Bordered) else matrix


def with_border(matrix: Operator) -> tuple[Sparse, int]:
    """With its border beside it, and how many unknowns that has: the same object and none where there is no border."""
    return (matrix.whole(), len(matrix.weight)) if isinstance(matrix, Bordered) else (matrix, 0)


def widened(rows: Sparse, more: int) -> Sparse:
    """Rows (k, n) CSR with as many empty columns more."""
    if not more:
        return rows
    return sp.csr_matrix((rows.data, rows.indices, rows.indptr), shape=(rows.shape[0], rows.shape[1] + more))


def _row_max(matrix: Sparse) -> NDArray[np.float64]:
    """Largest size of an entry of each row, 1 where all are zero."""
    size = np.asarray(abs(matrix).max(axis=1).toarray()).ravel() if matrix.shape[0] else np.zeros(0)
    return np.where(size > 0.0, size, 1.0)
