"""Flexible GMRES beside PyAMG's and beside exact arithmetic."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
import scipy.sparse.linalg as spla
from pyamg.krylov import fgmres as reference

from abut.linear.krylov import fgmres

N = 60


def problem() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A matrix, a rough preconditioner and a right-hand side."""
    random = np.random.default_rng(0)
    matrix = np.diag(np.linspace(1.0, 50.0, N)) + 0.3 * random.standard_normal((N, N))
    return matrix, np.diag(1.0 / np.diag(matrix)), random.standard_normal(N)


@pytest.mark.parametrize("restart", [N, 7])
def test_same_iterations_and_answer_as_the_reference(restart: int) -> None:
    matrix, near, rhs = problem()
    x, count, done = fgmres(lambda v: matrix @ v, lambda v: near @ v, rhs, 1e-9, restart, 40)
    history: list[float] = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        expected, _ = reference(
            spla.aslinearoperator(matrix), rhs, tol=1e-9, restart=restart, maxiter=40, M=spla.aslinearoperator(near),
            residuals=history,
        )  # fmt: skip
    assert done
    assert np.linalg.norm(rhs - matrix @ x) <= 2e-9 * np.linalg.norm(rhs)
    assert x == pytest.approx(expected, rel=1e-7)
    assert abs(count - (len(history) - 1)) <= 2


def test_preconditioner_may_change() -> None:
    """Another one in each iteration: the residual is still the smallest over all images, and n of them are all there is."""
    matrix, _, rhs = problem()
    random = np.random.default_rng(1)
    x, count, done = fgmres(
        lambda v: matrix @ v, lambda v: v * random.uniform(0.5, 2.0, N), rhs, 1e-9, N, 1
    )  # fmt: skip
    assert done
    assert count <= N
    assert matrix @ x == pytest.approx(rhs, abs=1e-7)


def test_it_says_when_it_gives_up() -> None:
    matrix, near, rhs = problem()
    assert not fgmres(lambda v: matrix @ v, lambda v: near @ v, rhs, 1e-9, 2, 1)[2]
    assert not fgmres(lambda v: np.full(N, np.nan), lambda v: v, rhs, 1e-9, 5, 2)[2]


def test_nothing_to_solve() -> None:
    x, count, done = fgmres(lambda v: v, lambda v: v, np.zeros(N), 1e-9, 5, 2)
    assert (x.any(), count, done) == (False, 0, True)


def test_exact_in_as_many_iterations_as_different_eigenvalues() -> None:
    values = np.repeat([1.0, 4.0, 9.0], N // 3)
    x, count, done = fgmres(lambda v: values * v, lambda v: v, np.ones(N), 1e-12, N, 1)
    assert done
    assert count == 3
    assert x == pytest.approx(1.0 / values, rel=1e-12)
