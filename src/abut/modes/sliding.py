"""What makes vibrations of a sliding assembly unsymmetric: friction that goes with the pressure."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.bordered import eliminated
from abut.linear import direct
from abut.modes.held import Held
from abut.problem.linearised import Linearised
from abut.problem.pair import Pair
from abut.solution.state import State
from abut.types import Sparse

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Sliding:
    """skew: (n_free, n_free) by which the stiffness is more than its symmetric part; pushing: (m, n_free) forces by each
    held multiplier, friction of what slips with them; slips: whether anything does."""

    skew: Sparse
    pushing: Sparse
    slips: bool


def sliding(system: Linearised, state: State, held: Held) -> Sliding:
    """Of a problem near a converged state, theory (J4). held: what contact holds there."""
    parts = zip(system.pairs, *map(system.split, (state.multipliers, state.slipping)))
    blocks = [_follows(pair, system.factors, *part) for pair, *part in parts]
    count = len(state.multipliers)
    follows = sp.block_diag(blocks, format="csr") if blocks else sp.csr_matrix((count, count))
    columns, kept = sp.csr_matrix(system.columns), held.kept
    pushing = (columns[kept] + follows[:, kept].T @ columns).tocsr()
    stiffness = eliminated(system.stiffness)
    return Sliding((0.5 * (stiffness - stiffness.T)).tocsr(), pushing, bool(follows.nnz))


def _follows(pair: Pair, factors: Vector, multipliers: Vector, slipping: NDArray[np.bool_]) -> Sparse:
    """(n, n) change of the tangential tractions that slip by the pressures: the slope of the bound, in the direction that
    they have."""
    n = len(pair)
    if not (n and pair.frictional):
        return sp.csr_matrix((n, n))
    slope = pair.friction(factors).at(np.maximum(multipliers[pair.normal], 0.0))[1]
    first, along = pair.index[:, :1], pair.index[:, 1:]
    there = (along >= 0) & (first >= 0)
    traction = np.where(there, multipliers[along], 0.0)
    size = np.linalg.norm(traction, axis=1, keepdims=True)
    value = slope[:, None] * traction / np.where(size > 0.0, size, 1.0)
    chosen = there & slipping[along] & (value != 0.0)
    pressure = np.broadcast_to(first, along.shape)
    return sp.csr_matrix((value[chosen], (along[chosen], pressure[chosen])), shape=(n, n))


@dataclass(frozen=True)
class UnsymmetricFactors:
    """Factors as ``modes.factors.Factors``, with other forces by the multipliers than rows of gaps. matrix: (n_free, n_free)
    CSR. Raises SingularModelError where it is singular."""

    matrix: Sparse
    held: Held
    pushing: Sparse
    _factors: direct.Factorization = field(init=False, repr=False)
    _whole: Sparse = field(init=False, repr=False)

    def __post_init__(self) -> None:
        held, rows = self.held, self.held.rows
        whole = self.matrix
        if rows.shape[0]:
            unit = float(np.median(np.abs(held.stiffness.diagonal())))
            scale = unit / np.maximum(abs(rows).max(axis=1).toarray().ravel(), 1e-300)
            to_rows, corner = sp.diags(scale), sp.diags(-(scale**2) * held.give)
            whole = sp.bmat([[whole, (to_rows @ self.pushing).T], [to_rows @ rows, corner]])
        matrix = direct.store_diagonal(whole.tocsr())
        object.__setattr__(self, "_whole", matrix)
        object.__setattr__(self, "_factors", direct.Factorization(matrix, quick=True, symmetric=False))

    def solve(self, force: Vector) -> Vector:
        """Displacements (n_free,) by forces (n_free,), corrected once: pivots below 1e-8 of the matrix are perturbed, among
        which are those of soft springs beside stiff bodies."""
        rhs = np.concatenate([force, np.zeros(self.held.rows.shape[0])])
        found = self._factors.solve(rhs)
        return np.asarray((found + self._factors.solve(rhs - self._whole @ found))[: len(force)])
