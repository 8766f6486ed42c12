"""Rows of the laws as an iterative solver sees them: what couples, in which units, and what their pressures do, roughly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from abut.linear.schur_preconditioner import Apply, PressureBlock, schur_inverse, selection, soft_inverse
from abut.linear.sliding_rows import Reduced, reduced
from abut.problem.linearised import Rows
from abut.problem.pair import Pair
from abut.types import Sparse

ACCURACY, ITERATIONS = 0.1, 30  # of the pressures' preconditioner where rows are no multiples of the operator's
FAINT = 1e-3  # share of the largest, below which how much a row looks at the gap counts as that


@dataclass(frozen=True)
class Conditions:
    """The rows lower du + corner x + residual = 0 of n unknowns, in which x = columns * q and every row is taken ``rows``
    times; multipliers change by fixed + push^T x.

    lower, forces: (n, n_free), the latter transposed the forces of x; corner: (n, n), sparse; inverse: roughly that of
    -(lower K^-1 forces^T + corner), (n,) -> (n,); symmetric: lower is minus ``forces``."""

    lower: Sparse
    forces: Sparse
    corner: Sparse
    residual: NDArray[np.float64]
    columns: NDArray[np.float64]
    rows: NDArray[np.float64]
    inverse: Apply
    push: Sparse
    fixed: NDArray[np.float64]
    symmetric: bool = True

    def multipliers(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Change of all multipliers."""
        return np.asarray(self.fixed + self.push.T @ x)


def conditions(
    law: Rows, operator: Sparse, pressures: PressureBlock, pairs: Sequence[Pair], columns: Sparse | None = None
) -> Conditions:
    """Of the rows that are not decoupled. operator: (n, n_free) B; columns: (n, n_free) transposed the forces, B where left
    out."""
    if not law.symmetric:
        few = reduced(law, pairs)
        return (
            _general(law, operator, pressures)
            if few is None
            else _sliding(few, operator, operator if columns is None else columns, pressures)
        )
    coupled = ~law.decoupled
    corner, forces, push = sp.csr_matrix(law.by_pressure)[coupled][:, coupled], operator[coupled], selection(coupled)
    soft = -corner.diagonal()
    if not soft.any():
        sizes = np.full(len(soft), pressures.scale)
        inverse = schur_inverse(pressures.parts, push)
    else:
        diagonal = pressures.diagonal
        sizes = np.sqrt(pressures.unit / (diagonal[coupled] + soft))  # residuals are measured in the root of energy
        inverse = soft_inverse(lambda p: push @ pressures.forward(push.T @ p), diagonal[coupled], soft)
    return Conditions(-forces, forces, corner, law.residual[coupled], sizes, sizes, inverse, push, law.fixed)


def _sliding(few: Reduced, operator: Sparse, columns: Sparse, pressures: PressureBlock) -> Conditions:
    """Rows with slip eliminated."""
    pull = few.pull if pressures.covered is None else few.pull @ sp.diags(pressures.covered)
    diagonal, soft = pull.multiply(pull) @ pressures.diagonal, np.abs(few.corner.diagonal())
    sizes = np.where(soft > 0.0, np.sqrt(pressures.unit / (diagonal + soft)), pressures.scale)
    return Conditions(
        -(few.pull @ operator).tocsr(), (few.push @ columns).tocsr(), few.corner, few.residual, sizes, sizes,
        _parted_inverse(few, pull.tocsr(), diagonal, pressures), few.push, few.fixed,
        few.symmetric and operator is columns,
    )  # fmt: skip


def _parted_inverse(few: Reduced, pull: Sparse, diagonal: NDArray[np.float64], pressures: PressureBlock) -> Apply:
    """That of pull S push^T - corner, theory (V24): what is closed, sticks, or has springs softer than S (pressures and
    tractions apart), other springs by themselves; where laws are soft, all by Krylov iterations to ``ACCURACY``. pull: that
    of ``few`` in multipliers of S; diagonal: (m,) of pull S push^T."""
    m, soft = int(few.single.sum()), -few.corner.diagonal()
    if few.corner[:m].data.any():

        def multiply(q: NDArray[np.float64]) -> NDArray[np.float64]:
            return np.asarray(few.pull @ pressures.forward(few.push.T @ q) - few.corner @ q)

        return _roughly(multiply, spla.splu((sp.diags(diagonal) - few.corner).tocsc()).solve, len(diagonal))
    together = soft <= diagonal
    share = np.sqrt(np.where(together, 1.0 + soft / diagonal, 0.0))  # so that the diagonal is that of the sum
    by_gap = schur_inverse(pressures.parts, _without_zeros(sp.diags(share) @ pull))
    alone = np.where(together, 0.0, 1.0 / (diagonal + soft))
    return lambda r: by_gap(r) + alone * r


def _without_zeros(matrix: Sparse) -> Sparse:
    matrix = matrix.tocsr()
    matrix.eliminate_zeros()
    return matrix


def _general(law: Rows, operator: Sparse, pressures: PressureBlock) -> Conditions:
    """Rows that look at points, as the constraint function's do: a row is about ``share`` times that of the operator."""
    coupled, fixed = ~law.decoupled, law.fixed
    lower, operator = law.by_displacement[coupled], operator[coupled]
    corner, residual = (
        sp.csr_matrix(law.by_pressure)[coupled][:, coupled],
        (law.residual + law.by_pressure @ fixed)[coupled],
    )
    size = np.asarray(operator.multiply(operator).sum(axis=1)).ravel()
    share = np.asarray(lower.multiply(operator).sum(axis=1)).ravel() / np.where(size > 0.0, size, 1.0)
    looks = np.maximum(np.abs(share), FAINT * np.abs(share).max(initial=1e-300))
    diagonal = pressures.diagonal[coupled]
    columns = np.sqrt(pressures.unit / (diagonal + np.abs(corner.diagonal()) / looks))
    return Conditions(
        lower, operator, corner, residual, columns, columns / looks, _mixed_inverse(share, corner, coupled, pressures),
        selection(coupled), fixed, False,
    )  # fmt: skip


def _mixed_inverse(
    share: NDArray[np.float64], corner: Sparse, coupled: NDArray[np.bool_], pressures: PressureBlock
) -> Apply:
    """That of -(share S + corner), theory (V22), by Krylov iterations to ``ACCURACY``. Rows that are mostly closed are
    taken for closed, the others for open, one after the other."""
    n, places = len(share), np.flatnonzero(coupled)
    closed = np.abs(share) * pressures.diagonal[coupled] > np.abs(corner.diagonal())
    shut = np.zeros(len(coupled), dtype=bool)
    shut[places[closed]] = True
    by_gap = schur_inverse(pressures.parts, selection(shut))
    beside = corner[closed][:, ~closed]
    by_pressure = spla.splu(corner[~closed][:, ~closed].tocsc()).solve if (~closed).any() else None

    def multiply(p: NDArray[np.float64]) -> NDArray[np.float64]:
        whole = np.zeros(len(coupled))
        whole[places] = p
        return np.asarray(share * pressures.forward(whole)[places] + corner @ p)

    def split(r: NDArray[np.float64]) -> NDArray[np.float64]:
        p = np.zeros(n)
        rest = r[closed]
        if by_pressure is not None:
            p[~closed] = by_pressure(r[~closed])
            rest = rest - beside @ p[~closed]
        p[closed] = by_gap(rest / share[closed])
        return p

    roughly = _roughly(multiply, split, n)
    return lambda r: -roughly(r)


def _roughly(multiply: Apply, precondition: Apply, n: int) -> Apply:
    """The inverse by Krylov iterations to ``ACCURACY``."""
    whole, first = (spla.LinearOperator((n, n), matvec=f, dtype=float) for f in (multiply, precondition))

    def apply(r: NDArray[np.float64]) -> NDArray[np.float64]:
        if not r.any():
            return np.zeros(n)
        return np.asarray(spla.gmres(whole, r, rtol=ACCURACY, restart=ITERATIONS, maxiter=1, M=first)[0])

    return apply
