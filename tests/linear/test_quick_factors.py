"""Factors that refine a solution only where it needs to be."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

from abut.linear import direct


@pytest.mark.parametrize("ground", [1.0, 1e-11])
def test_quick_solutions_meet_the_equations(ground: float):
    """A chain of springs between points, each with another one to the ground; where these are weak PARDISO perturbs a pivot,
    and its solution alone leaves a residual of some 1e-9."""
    n = 60
    ends = np.ones(n)
    ends[1:-1] = 2.0
    chain = sp.csr_matrix(sp.diags([-np.ones(n - 1), ends + ground, -np.ones(n - 1)], [-1, 0, 1]))
    force = np.random.default_rng(0).standard_normal(n)
    solution = direct.Factorization(direct.store_diagonal(sp.triu(chain, format="csr")), quick=True).solve(force)
    assert direct.residual(chain, solution, force, False) < direct.ACCURATE
    if ground == 1.0:
        np.testing.assert_allclose(solution, np.linalg.solve(chain.toarray(), force), rtol=1e-12, atol=1e-12)
