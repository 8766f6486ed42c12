"""A multigrid V-cycle in single precision: a preconditioner needs no more digits, and time is that of reading matrices.

Smoothing is by Chebyshev polynomials in the matrix times the inverse of its diagonal (Adams, Brezina, Hu and Tuminaro 2003).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut._core import block_product
from abut.types import Sparse

SMOOTHED = (0.05, 1.1)  # share of the spectrum's end that smoothing damps; its upper end is an estimate from below
JACOBI = 4 / 3  # over the largest eigenvalue: damping of the smoothed aggregates (Vanek, Mandel and Brezina 1996)
LUMPED = 0.1  # share of its diagonal that the strong part must keep to be divided by
SINGULAR = 1e-10  # eigenvalue of the coarsest matrix over its largest that counts as zero
PROBES = 10  # Lanczos steps for that estimate

Single = NDArray[np.float32]
Blocks = tuple[NDArray[np.int32], NDArray[np.int32], Single]  # indptr, indices, blocks (n, r, c)


@dataclass(frozen=True)
class Level:
    """matrix, diagonal and largest eigenvalue of diagonal^-1 matrix; smooth: the interpolation in double precision;
    interpolate from, restrict to the next level; degree of the polynomial that smooths."""

    matrix: Blocks
    inverse_diagonal: Single
    largest: float
    smooth: Sparse
    interpolate: Blocks
    restrict: Blocks
    degree: int


@dataclass(frozen=True)
class Levels:
    """coarsest: inverse of the last matrix."""

    levels: Sequence[Level]
    coarsest: Single

    def cycle(self, residual: NDArray[np.float64]) -> NDArray[np.float64]:
        """One symmetric V-cycle, (n,) -> (n,)."""
        size = float(np.abs(residual).max(initial=0.0))
        if not size > 0.0:
            return np.zeros_like(residual)
        return size * self._descend(0, (residual / size).astype(np.float32)).astype(np.float64)

    def _descend(self, number: int, residual: Single) -> Single:
        if number == len(self.levels):
            return np.asarray(self.coarsest @ residual)
        level = self.levels[number]
        first, residual = _smooth(level, residual, with_residual=True)
        below = self._descend(number + 1, block_product(*level.restrict, residual))
        correction = block_product(*level.interpolate, below)
        residual = residual - block_product(*level.matrix, correction)
        last, _ = _smooth(level, residual, with_residual=False)
        return np.asarray(first + correction + last)


def level(matrix: Sparse, strong: Sparse, tentative: Sparse) -> Level:
    """A level from its matrix and the interpolation of aggregates (both BSR), smoothed by one step of Jacobi's iteration
    with the ``strong`` part of the matrix."""
    blocks, diagonal = _blocks(matrix), matrix.diagonal()
    small = np.finfo(np.float32).eps * diagonal.max()  # coarse functions that small aggregates cannot carry are zero
    inverse_diagonal = _inverted(diagonal, small)
    single = inverse_diagonal.astype(np.float32)
    largest = damping = _largest(blocks, single)
    if strong is not matrix:
        lumped = strong.diagonal()
        inverse_diagonal = _inverted(np.where(lumped > LUMPED * diagonal, lumped, diagonal), small)
        damping = _largest(_blocks(strong), inverse_diagonal.astype(np.float32))
    image = (strong @ tentative).tobsr(tentative.blocksize)
    rows = np.repeat(np.arange(len(image.indptr) - 1), np.diff(image.indptr))
    image.data *= JACOBI / damping * inverse_diagonal.reshape(-1, image.blocksize[0], 1)[rows]
    smooth = (tentative - image).tobsr(tentative.blocksize)
    degree = math.ceil(math.sqrt(largest))  # flat and stretched cells widen the spectrum: longer polynomials
    return Level(blocks, single, largest, smooth, _blocks(smooth), _blocks(smooth.T.tobsr()), degree)


def _inverted(diagonal: NDArray[np.float64], small: float) -> NDArray[np.float64]:
    """One over it, zero where it is small."""
    return np.asarray(np.divide(1.0, diagonal, out=np.zeros_like(diagonal), where=diagonal > small))


def coarse_matrix(matrix: Sparse, level: Level) -> Sparse:
    """Galerkin's matrix of the next level, BSR."""
    block = level.smooth.blocksize
    image = (matrix @ level.smooth).tobsr(block)
    return (level.smooth.T.tobsr((block[1], block[0])) @ image).tobsr((block[1], block[1]))


def inverse(matrix: Sparse) -> Single:
    """Of the coarsest matrix, which may be singular."""
    return np.linalg.pinv(matrix.toarray(), rcond=SINGULAR, hermitian=True).astype(np.float32)


def _blocks(matrix: Sparse) -> Blocks:
    indptr, indices = (np.ascontiguousarray(a, dtype=np.int32) for a in (matrix.indptr, matrix.indices))
    return indptr, indices, np.ascontiguousarray(matrix.data, dtype=np.float32)


def _smooth(level: Level, residual: Single, with_residual: bool) -> tuple[Single, Single]:
    """Chebyshev from zero: the correction, and what remains of the residual where that is asked for."""
    low, high = (np.float32(level.largest * share) for share in SMOOTHED)
    middle, half = (high + low) / 2, (high - low) / 2
    ratio = half / middle
    direction = level.inverse_diagonal * residual / middle
    correction = direction.copy()
    for _ in range(1, level.degree):
        residual = residual - block_product(*level.matrix, direction)
        following = 1 / (2 * middle / half - ratio)
        direction = following * ratio * direction + 2 * following / half * (level.inverse_diagonal * residual)
        ratio = following
        correction += direction
    return correction, residual - block_product(*level.matrix, direction) if with_residual else residual


def _largest(matrix: Blocks, inverse_diagonal: Single) -> float:
    """Largest eigenvalue of diagonal^-1 matrix by a few steps of Lanczos."""
    root = np.sqrt(inverse_diagonal)
    vector = np.random.default_rng(0).standard_normal(len(root)).astype(np.float32)
    vector /= np.linalg.norm(vector)
    before, beta = np.zeros_like(vector), np.float32(0.0)
    diagonal, beside = [], []
    for _ in range(min(PROBES, len(root))):
        image = root * block_product(*matrix, root * vector) - beta * before
        alpha = image @ vector
        image -= alpha * vector
        beta = np.linalg.norm(image)
        diagonal.append(alpha)
        beside.append(beta)
        if not beta > 0.0:
            break
        before, vector = vector, image / beta
    tridiagonal = np.diag(diagonal) + np.diag(beside[:-1], 1) + np.diag(beside[:-1], -1)
    return float(np.linalg.eigvalsh(tridiagonal).max())
