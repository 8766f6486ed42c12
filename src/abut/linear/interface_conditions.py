"""Rows of the laws as an iterative solver sees them: what couples, in which units, and what their pressures do, roughly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from abut.linear.schur_preconditioner import Apply, PressureBlock, schur_inverse, soft_inverse
from abut.problem.linearised import Rows
from abut.types import Sparse

ACCURACY, ITERATIONS = 0.1, 30  # of the pressures' preconditioner where rows are no multiples of the operator's
FAINT = 1e-3  # share of the largest, below which how much a row looks at the gap counts as that


@dataclass(frozen=True)
class Conditions:
    """The rows lower du + corner dp = ... of n pressures, in which dp = columns * q and every row is taken ``rows`` times.

    lower: (n, n_free), corner: (n, n), sparse; inverse: roughly that of -(lower K^-1 B^T + corner), (n,) -> (n,)."""

    lower: Sparse
    corner: Sparse
    columns: NDArray[np.float64]
    rows: NDArray[np.float64]
    inverse: Apply


def conditions(law: Rows, operator: Sparse, pressures: PressureBlock) -> Conditions:
    """Of the rows that are not decoupled. operator: (n, n_free) B."""
    own = ~law.decoupled
    corner = sp.csr_matrix(law.by_pressure)[own][:, own]
    if not law.symmetric:
        return _general(law.by_displacement[own], corner, operator[own], own, pressures)
    soft = -corner.diagonal()
    if not soft.any():
        sizes = np.full(len(soft), pressures.scale)
        return Conditions(-operator[own], corner, sizes, sizes, schur_inverse(pressures.parts, own))
    diagonal = pressures.diagonal
    sizes = np.sqrt(pressures.unit / (diagonal[own] + soft))  # residuals are measured in the root of energy
    return Conditions(-operator[own], corner, sizes, sizes, soft_inverse(pressures.forward, diagonal, soft))


def _general(
    lower: Sparse, corner: Sparse, operator: Sparse, own: NDArray[np.bool_], pressures: PressureBlock
) -> Conditions:
    """Rows that look at points, as the constraint function's do: a row is about ``share`` times that of the operator."""
    size = np.asarray(operator.multiply(operator).sum(axis=1)).ravel()
    share = np.asarray(lower.multiply(operator).sum(axis=1)).ravel() / np.where(size > 0.0, size, 1.0)
    looks = np.maximum(np.abs(share), FAINT * np.abs(share).max(initial=1e-300))
    diagonal = pressures.diagonal[own]
    columns = np.sqrt(pressures.unit / (diagonal + np.abs(corner.diagonal()) / looks))
    return Conditions(lower, corner, columns, columns / looks, _mixed_inverse(share, corner, own, pressures))


def _mixed_inverse(
    share: NDArray[np.float64], corner: Sparse, own: NDArray[np.bool_], pressures: PressureBlock
) -> Apply:
    """That of -(share S + corner), theory (V22), by Krylov iterations to ``ACCURACY``. Rows that are mostly closed are
    taken for closed, the others for open, one after the other."""
    n, places = len(share), np.flatnonzero(own)
    closed = np.abs(share) * pressures.diagonal[own] > np.abs(corner.diagonal())
    shut = np.zeros(len(own), dtype=bool)
    shut[places[closed]] = True
    by_gap = schur_inverse(pressures.parts, shut)
    beside = corner[closed][:, ~closed]
    by_pressure = spla.splu(corner[~closed][:, ~closed].tocsc()).solve if (~closed).any() else None

    def multiply(p: NDArray[np.float64]) -> NDArray[np.float64]:
        whole = np.zeros(len(own))
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

    whole, first = (spla.LinearOperator((n, n), matvec=f, dtype=float) for f in (multiply, split))

    def apply(r: NDArray[np.float64]) -> NDArray[np.float64]:
        if not r.any():
            return np.zeros(n)
        return np.asarray(-spla.gmres(whole, r, rtol=ACCURACY, restart=ITERATIONS, maxiter=1, M=first)[0])

    return apply
