"""Factors of a stiffness with what contact holds beside it, theory (J3): solutions, and how many modes lie below."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.linear import direct
from abut.modes.held import Held
from abut.modes.spectrum import Pairs, Pencil, largest
from abut.types import Sparse

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Factors:
    """As ``abut.modes.spectrum.Factored``, of one process. matrix: (n_free, n_free) symmetric CSR."""

    matrix: Sparse
    held: Held
    _factors: direct.Factorization = field(init=False, repr=False)
    _scale: Vector = field(init=False, repr=False)

    def __post_init__(self) -> None:
        scale, below, corner = beside(self.held)
        upper = direct.upper(self.matrix.tocsr())
        whole = sp.bmat([[upper, below.T], [None, corner]], format="csr") if len(scale) else upper
        object.__setattr__(self, "_scale", scale)
        object.__setattr__(self, "_factors", direct.Factorization(direct.store_diagonal(whole), quick=True))

    def solve(self, force: Vector) -> Vector:
        """Solutions of one system, as in ``Factored``."""
        rhs = np.concatenate([force, np.zeros(len(self._scale))])
        return np.asarray(self._factors.solve(rhs)[: len(force)])

    @property
    def negative(self) -> int | None:
        """How many eigenvalues are negative, as in ``Factored``."""
        count = self._factors.negative
        return None if count is None else count - len(self._scale)


def beside(held: Held) -> tuple[Vector, Sparse, Sparse]:
    """What stands beside a stiffness for what contact holds: (m,) factors by which its rows have the size of the stiffness,
    these rows (m, n_free) and the corner (m, m)."""
    rows = held.rows
    unit = float(np.median(np.abs(held.stiffness.diagonal())))
    size = abs(rows).max(axis=1).toarray().ravel() if rows.shape[0] else np.zeros(0)
    scale = unit / np.maximum(size, 1e-300)
    return scale, (sp.diags(scale) @ rows).tocsr(), sp.diags(-(scale**2) * held.give)


class Alone:
    """As ``abut.modes.held.Eigensolver``, on one process: PARDISO or SuperLU, and ARPACK."""

    def factors(self, matrix: Sparse, held: Held) -> Factors:
        """Factors of a symmetric matrix, as in ``Eigensolver``."""
        return Factors(matrix.tocsr(), held)

    def largest(self, pencil: Pencil, count: int, seed: int = 0) -> Pairs:
        """The largest eigenvalues and their vectors, as in ``Eigensolver``."""
        return largest(pencil, count, seed)
