"""The lowest eigenpairs of an unsymmetric pencil by Arnoldi's method on prepared factors."""

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
    try:
        values, vectors = spla.eigs(
            mass, count, mass, sigma=0.0, which="LM", v0=start, ncv=basis, tol=TOLERANCE, OPinv=operator
        )
    except spla.ArpackError as reason:
        raise ConvergenceError(f"modes: Arnoldi's method did not converge ({reason}); ask for fewer modes") from None
    return 1.0 / values, vectors


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
