"""The half of a symmetric matrix that PARDISO takes, and systems whose diagonal says how they are factorised."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

from abut.linear import direct


def test_upper_triangle() -> None:
    rng = np.random.default_rng(0)
    for n in (1, 2, 7, 30):
        dense = np.where(rng.random((n, n)) < 0.4, rng.standard_normal((n, n)), 0.0)
        a = sp.csr_matrix(dense)
        product = a @ a.T  # columns not in order
        half = direct.upper(product)
        assert half.toarray() == pytest.approx(np.triu(dense @ dense.T), abs=1e-13)
        assert half.has_sorted_indices
        assert all((np.diff(half[i].indices) > 0).all() for i in range(n))


@pytest.mark.parametrize("shift", [0.0, 3.0, 5.0])
def test_diagonals_of_either_kind(shift: float) -> None:
    """Positive definite, indefinite with a positive diagonal, and with pressures whose diagonal is zero."""
    rng = np.random.default_rng(1)
    n, m = 60, 8
    stiff = sp.diags([-np.ones(n - 1), np.full(n, 6.0 - shift), -np.ones(n - 1)], [-1, 0, 1], format="csr")
    rows = sp.random(m, n, 0.3, random_state=rng, format="csr")
    for whole in (stiff, sp.bmat([[stiff, rows.T], [rows, None]], format="csr")):
        x = rng.standard_normal(whole.shape[0])
        half = direct.store_diagonal(direct.upper(whole))
        assert direct.solve(half, whole @ x, symmetric=True) == pytest.approx(x, abs=1e-9)  # conditions below 1e4
