"""The lowest eigenpairs of unsymmetric pencils, linear and quadratic, by Arnoldi's method on prepared factors."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from abut.errors import ConvergenceError
from abut.modes.spectrum import TOLERANCE
from abut.types import Sparse

NOTHING = 1e-12  # of the largest t: motions without mass, in dense matrices
BASIS = 40  # least size of the method's basis; smaller problems are solved whole
Vector = NDArray[np.float64]
Complex = NDArray[np.complex128]


def nearest(solve: Callable[[Vector], Vector], mass: Sparse, free: int, count: int) -> tuple[Complex, Complex]:
    """The ``count`` largest t of solve(mass x) = t x, or as many as there are: (n,), and x (size, n).

    solve: x (size,) by forces; mass: (size, size) symmetric, positive semi-definite; free: how many directions there are.
    Raises ConvergenceError."""
    size = mass.shape[0]
    moving = np.flatnonzero(mass.diagonal() > 0.0)
    basis = max(2 * count + 2, BASIS)
    if basis >= min(len(moving), free):
        return _whole(solve, mass, moving, count)
    start = solve(mass @ np.random.default_rng(0).standard_normal(size))
    operator = spla.LinearOperator((size, size), matvec=lambda x: solve(np.ravel(x)), dtype=float)
    values, vectors = _converged(
        lambda: spla.eigs(mass, count, mass, sigma=0.0, which="LM", v0=start, ncv=basis, tol=TOLERANCE, OPinv=operator)
    )
    return 1.0 / values, vectors


def nearest_of_quadratic(
    solve: Callable[[Vector], Vector], turning: Sparse, mass: Sparse, free: int, count: int
) -> tuple[Complex, Complex]:
    """The ``count`` largest t of -solve(turning x + mass x / t) = t x, or as many as there are, complex ones with their
    conjugates: (n,), and x (size, n), theory (J13).

    solve: x (size,) by forces; turning, mass: (size, size), the latter symmetric and positive semi-definite; free: how many
    directions there are. Raises ConvergenceError."""
    size = mass.shape[0]
    moving = np.flatnonzero(mass.diagonal() > 0.0)
    pushed = mass @ np.random.default_rng(0).standard_normal(size)
    start = solve(pushed)
    # Of 1 / t, so that both halves are of one size.
    unit = float(np.sqrt(abs(start @ pushed) / (start @ (mass @ start))))
    basis = max(2 * count + 2, BASIS)
    if basis >= 2 * min(len(moving), free):
        return _whole_quadratic(solve, turning, mass, moving, count, unit)

    def applied(both: Vector) -> Vector:
        x, faster = np.split(np.ravel(both), 2)
        return np.concatenate([-solve(turning @ x + unit * (mass @ faster)), x / unit])

    operator = spla.LinearOperator((2 * size, 2 * size), matvec=applied, dtype=float)
    first = np.concatenate([start, start])
    values, vectors = _converged(lambda: spla.eigs(operator, count, which="LM", v0=first, ncv=basis, tol=TOLERANCE))
    return values, vectors[:size]


def _converged(find: Callable[[], tuple[Complex, Complex]]) -> tuple[Complex, Complex]:
    try:
        return find()
    except spla.ArpackError as reason:
        raise ConvergenceError(f"modes: Arnoldi's method did not converge ({reason}); ask for fewer modes") from None


def _whole(
    solve: Callable[[Vector], Vector], mass: Sparse, moving: NDArray[np.int64], count: int
) -> tuple[Complex, Complex]:
    """As a dense matrix over the unknowns with mass."""
    columns = np.column_stack([solve(force) for force in mass[:, moving].toarray().T])
    values, vectors = np.linalg.eig(columns[moving])
    order = np.argsort(-np.abs(values), kind="stable")[:count]
    order = order[np.abs(values[order]) > NOTHING * np.abs(values).max()]
    values = values[order].astype(complex)
    return values, columns @ vectors[:, order] / values


def _whole_quadratic(
    solve: Callable[[Vector], Vector], turning: Sparse, mass: Sparse, moving: NDArray[np.int64], count: int, unit: float
) -> tuple[Complex, Complex]:
    """As a dense matrix over the unknowns with mass and their velocities over ``unit``."""
    heavy, turned = (
        np.column_stack([solve(force) for force in matrix[:, moving].toarray().T]) for matrix in (mass, turning)
    )
    n = len(moving)
    rows = np.hstack([-turned[moving], -unit * heavy[moving]])
    values, vectors = np.linalg.eig(np.vstack([rows, np.eye(n, 2 * n) / unit]))
    order = np.argsort(-np.abs(values), kind="stable")[:count]
    order = order[np.abs(values[order]) > NOTHING * np.abs(values).max()]
    values, known = values[order].astype(complex), vectors[:n, order]
    return values, -(turned @ known + heavy @ (known / values)) / values
