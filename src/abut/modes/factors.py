"""Factors of a stiffness with what contact holds beside it, theory (J3): solutions, and how many modes lie below."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.linear import direct
from abut.modes.held import Held
from abut.types import Sparse

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Factors:
    """matrix: (n_free, n_free) symmetric CSR, as the stiffness of ``held`` with something added. Raises SingularModelError
    where it is singular."""

    matrix: Sparse
    held: Held
    _factors: direct.Factorization = field(init=False, repr=False)
    _scale: Vector = field(init=False, repr=False)

    def __post_init__(self) -> None:
        held, rows = self.held, self.held.rows
        unit = float(np.median(np.abs(held.stiffness.diagonal())))
        largest = abs(rows).max(axis=1).toarray().ravel() if rows.shape[0] else np.zeros(0)
        scale = unit / np.maximum(largest, 1e-300)
        corner = sp.diags(-(scale**2) * held.give)
        upper = direct.upper(self.matrix.tocsr())
        below = (sp.diags(scale) @ rows).tocsr()
        whole = sp.bmat([[upper, below.T], [None, corner]], format="csr") if rows.shape[0] else upper
        object.__setattr__(self, "_scale", scale)
        object.__setattr__(self, "_factors", direct.Factorization(direct.store_diagonal(whole), quick=True))

    def solve(self, force: Vector) -> Vector:
        """Displacements (n_free,) by forces (n_free,)."""
        rhs = np.concatenate([force, np.zeros(len(self._scale))])
        return np.asarray(self._factors.solve(rhs)[: len(force)])

    @property
    def negative(self) -> int | None:
        """How many of the matrix' eigenvalues on motions that contact allows are negative (Sylvester's law of inertia);
        None where the factors do not tell."""
        count = self._factors.negative
        return None if count is None else count - len(self._scale)
