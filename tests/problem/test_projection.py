"""A matrix over all values as one over the unknowns: what is only picked is taken apart, the product is the same."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

from abut.problem.projection import projected


def changes(rows: int, columns: int, rng: np.random.Generator) -> sp.csr_matrix:
    """Rows that are unknowns themselves (of several the same one, and not in order), sums of some, and zero."""
    free = np.zeros((rows, columns))
    for row in range(rows):
        kind = rng.integers(4)
        if kind < 2:
            free[row, min(row * columns // rows, columns - 1) if kind else rng.integers(columns)] = 1.0
        elif kind == 2:
            free[row, rng.integers(0, columns, 3)] = rng.standard_normal()
    return sp.csr_matrix(free)


@pytest.mark.parametrize(("rows", "columns"), [(40, 30), (20, 20), (25, 10), (12, 1)])
def test_the_product_of_three(rows: int, columns: int) -> None:
    rng = np.random.default_rng(rows)
    for _ in range(20):
        matrix = sp.random(rows, rows, 0.3, random_state=rng, format="csr")
        free = changes(rows, columns, rng)
        got = projected(matrix, free)
        assert got.shape == (columns, columns)
        assert got.toarray() == pytest.approx(
            (free.T @ matrix @ free).toarray(), abs=1e-13
        )  # sums of some forty numbers


def test_picking_alone() -> None:
    matrix = sp.random(9, 9, 0.5, random_state=1, format="csr")
    kept = [1, 2, 5, 8]
    free = sp.csr_matrix(np.eye(9)[:, kept])
    assert (projected(matrix, free).toarray() == matrix.toarray()[np.ix_(kept, kept)]).all()
