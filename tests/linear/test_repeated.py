"""Systems that resemble each other, solved one after the other."""

import numpy as np
import pytest
import scipy.sparse as sp

from abut.linear import direct
from abut.linear.repeated import Repeated

pytestmark = pytest.mark.skipif(direct.pardiso() is None, reason="PARDISO is not installed")


def saddle(n: int, seed: int, contacts: int) -> sp.csr_matrix:
    """Laplace on a cube of n^3 points, unsymmetric by a little, and rows of multipliers with nothing on the diagonal."""
    rng = np.random.default_rng(7)
    line = sp.diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(n, n))
    one = sp.identity(n)
    cube = sum(
        sp.kron(sp.kron(*parts[:2]), parts[2]) for parts in ((line, one, one), (one, line, one), (one, one, line))
    )
    points = np.arange(contacts)
    rows = sp.csr_matrix((np.ones(contacts), (points, points)), shape=(contacts, n**3))
    noise = sp.random(n**3, n**3, 1e-4, random_state=rng)
    changes = sp.diags(1.0 + 0.02 * np.random.default_rng(seed).uniform(-1.0, 1.0, n**3))
    return sp.bmat([[changes @ (cube + noise), -rows.T], [rows, None]], format="csr")


def residual(matrix: sp.csr_matrix, x: np.ndarray, rhs: np.ndarray) -> float:
    return float(np.abs(matrix @ x - rhs).max() / np.abs(rhs).max())


@pytest.mark.long
def test_old_factors_serve_a_matrix_that_changes_little() -> None:
    """Exact for the new matrix all the same."""
    repeated, first, second = Repeated(), saddle(20, 1, 60), saddle(20, 2, 60)
    rhs = np.random.default_rng(3).standard_normal(first.shape[0])
    assert residual(first, repeated.solve(first, rhs, symmetric=False), rhs) < 1e-12
    assert residual(second, repeated.solve(second, rhs, symmetric=False), rhs) < 1e-10
    assert residual(first, repeated.solve(second, rhs, symmetric=False), rhs) > 1e-4
    assert (repeated.analyses, repeated.factorisations) == (1, 1)


def test_one_analysis_while_entries_come_and_go() -> None:
    """A matrix far from the first is factorised anew; entries that the pattern lacks are in the solution, not in the
    factors."""
    repeated, first = Repeated(), saddle(8, 1, 20)
    rhs = np.random.default_rng(3).standard_normal(first.shape[0])
    other = (2.0 * first).tolil()
    other[3, 100] = other[450, 7] = 0.05
    other = other.tocsr()
    repeated.solve(first, rhs, symmetric=False)
    assert residual(other, repeated.solve(other, rhs, symmetric=False), rhs) < 1e-10
    assert (repeated.analyses, repeated.factorisations) == (1, 2)
    dense = (first + sp.random(*first.shape, 0.01, random_state=5)).tocsr()
    assert residual(dense, repeated.solve(dense, rhs, symmetric=False), rhs) < 1e-10
    assert repeated.analyses == 2


def test_a_singular_matrix_is_said_to_be_one() -> None:
    matrix = sp.csr_matrix(np.diag([1.0, 0.0, 1.0]))
    with pytest.raises(direct.SingularModelError):
        Repeated().solve(matrix, np.ones(3), symmetric=False)
