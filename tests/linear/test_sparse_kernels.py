"""Compiled products and the multigrid cycle beside plain NumPy and SciPy in double precision."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pyamg
import pytest
import scipy.sparse as sp
from numpy.typing import NDArray
from pyamg.aggregation import fit_candidates, standard_aggregation

from abut._core import block_product, padded_blocks, principal_submatrix
from abut.linear.multigrid_cycle import SMOOTHED, Levels, coarse_matrix, inverse, level

SHAPES = [(1, 1), (2, 2), (2, 3), (3, 3), (3, 6), (6, 3), (6, 6), (4, 5)]


def random_blocks(shape: tuple[int, int], rows: int = 40, columns: int = 30) -> sp.bsr_matrix:
    r, c = shape
    pattern = sp.random(rows, columns, 0.2, random_state=1, format="csr")
    blocks = np.random.default_rng(2).standard_normal((pattern.nnz, r, c))
    return sp.bsr_matrix((blocks, pattern.indices, pattern.indptr), shape=(rows * r, columns * c))


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_block_product(shape: tuple[int, int], kind: type) -> None:
    matrix = random_blocks(shape)
    x = np.random.default_rng(3).standard_normal(matrix.shape[1])
    got = block_product(matrix.indptr, matrix.indices, matrix.data.astype(kind), x.astype(kind))
    assert got.dtype == kind
    assert got == pytest.approx(matrix @ x, abs=100 * float(np.finfo(kind).eps))


def test_block_product_is_the_same_on_any_number_of_threads() -> None:
    script = (
        "import numpy as np; from abut._core import block_product; r = np.random.default_rng(0); n = 30000;"
        "p = np.arange(0, 2 * n + 1, 2, dtype=np.int32); i = r.integers(0, n, 2 * n).astype(np.int32);"
        "print(block_product(p, i, r.standard_normal((2 * n, 3, 3)), r.standard_normal(3 * n)).tobytes().hex()[:4000])"
    )
    said = [
        subprocess.run(
            [sys.executable, "-c", script],
            env={**os.environ, "OMP_NUM_THREADS": threads}, capture_output=True, text=True, check=True,
        ).stdout
        for threads in ("1", "3")
    ]  # fmt: skip
    assert said[0] == said[1]
    assert len(said[0]) > 1000


def test_principal_submatrix() -> None:
    matrix = sp.random(50, 50, 0.2, random_state=4, format="csr")
    kept = np.flatnonzero(np.random.default_rng(5).random(50) < 0.6)
    place = np.full(50, -1, dtype=np.int32)
    place[kept] = np.arange(len(kept))
    indptr, indices, data = principal_submatrix(matrix.indptr, matrix.indices, matrix.data, place, len(kept))
    got = sp.csr_matrix((data, indices, indptr), shape=(len(kept), len(kept)))
    assert (got != matrix[kept][:, kept]).nnz == 0


@pytest.mark.parametrize("dim", [2, 3])
def test_padded_blocks(dim: int) -> None:
    """Rows and columns at their places, ones on the diagonal where nothing goes."""
    random = np.random.default_rng(9)
    size = 40 * dim
    place = np.flatnonzero(random.random(size) < 0.7)
    place = np.union1d(place, dim * np.arange(40))  # something in every block row
    matrix = (sp.random(len(place), len(place), 0.1, random_state=10) + sp.identity(len(place))).tocsr()
    matrix.sort_indices()
    indptr, indices, blocks = padded_blocks(
        matrix.indptr, matrix.indices, matrix.data, place.astype(np.int32), dim, 40, 0.5
    )
    got = sp.bsr_matrix((blocks.reshape(-1, dim, dim), indices, indptr), shape=(size, size)).toarray()
    expected = np.eye(size)
    expected[place, place] = 0.0
    expected[np.ix_(place, place)] += 0.5 * matrix.toarray()
    assert got == pytest.approx(expected, abs=1e-15)


def hierarchy() -> tuple[list, Levels]:
    """Three levels on an elastic plate: their matrices, and the cycle on them."""
    matrix, near_null = pyamg.gallery.linear_elasticity((20, 20), format="bsr")
    matrices, levels = [matrix], []
    for _ in range(2):
        graph = sp.csr_matrix((np.ones(len(matrices[-1].indices)), matrices[-1].indices, matrices[-1].indptr))
        tentative, near_null = fit_candidates(standard_aggregation(graph)[0], near_null)
        levels.append(level(matrices[-1], matrices[-1], tentative))
        matrices.append(coarse_matrix(matrices[-1], levels[-1]))
    return matrices, Levels(levels, inverse(matrices[-1]))


def twin(levels: list, ours: Levels, residual: NDArray[np.float64], number: int = 0) -> NDArray[np.float64]:
    """The same cycle in double precision, smoothing by the three-term recurrence of Chebyshev polynomials written out."""
    matrix = levels[number].toarray()
    if number == len(levels) - 1:
        return np.linalg.pinv(matrix, hermitian=True) @ residual
    inverse = np.diag(1.0 / np.diag(matrix))
    low, high = (share * ours.levels[number].largest for share in SMOOTHED)
    # The error polynomial is T(middle - x) / T(middle) on the scaled interval; the smoother is (1 - error) / x.
    nodes = np.polynomial.chebyshev.chebpts1(ours.levels[number].degree) * (high - low) / 2 + (high + low) / 2
    error = np.eye(len(matrix))
    for root in nodes:
        error = error @ (np.eye(len(matrix)) - inverse @ matrix / root)
    smooth = (np.eye(len(matrix)) - error) @ np.linalg.inv(matrix)
    x = smooth @ residual
    interpolation = ours.levels[number].smooth
    below = twin(levels, ours, interpolation.T @ (residual - matrix @ x), number + 1)
    x = x + interpolation @ below
    return x + smooth @ (residual - matrix @ x)


def test_cycle_equals_its_twin_in_double_precision() -> None:
    levels, ours = hierarchy()
    assert len(levels) == 3
    residual = np.random.default_rng(6).standard_normal(levels[0].shape[0])
    expected = twin(levels, ours, residual)
    assert np.linalg.norm(ours.cycle(residual) - expected) < 1e-4 * np.linalg.norm(expected)


def test_cycle_is_symmetric_and_positive() -> None:
    levels, ours = hierarchy()
    x, y = np.random.default_rng(7).standard_normal((2, levels[0].shape[0]))
    assert x @ ours.cycle(y) == pytest.approx(y @ ours.cycle(x), rel=1e-3)
    assert x @ ours.cycle(x) > 0


@pytest.mark.parametrize("scale", [1e-60, 1e60])
def test_cycle_is_linear_in_any_unit(scale: float) -> None:
    """Single precision ends at 1e38; residuals do not."""
    levels, ours = hierarchy()
    x = np.random.default_rng(8).standard_normal(levels[0].shape[0])
    assert ours.cycle(scale * x) == pytest.approx(scale * ours.cycle(x), rel=1e-5)
    assert not ours.cycle(0.0 * x).any()


def test_coarse_matrix_is_galerkins() -> None:
    matrices, ours = hierarchy()
    smooth = ours.levels[0].smooth
    expected = (smooth.T @ matrices[0] @ smooth).toarray()
    assert matrices[1].toarray() == pytest.approx(expected, abs=1e-13 * np.abs(expected).max())
