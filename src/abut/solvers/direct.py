"""Direct solution of sparse systems: PARDISO where its wheel is installed, SciPy's SuperLU elsewhere."""

from __future__ import annotations

import functools
import importlib.metadata
import os
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from abut.errors import SingularModelError

SYMMETRIC_INDEFINITE, UNSYMMETRIC = -2, 11
RESIDUAL_LIMIT = 1e-6  # relative residual above which a factorisation is taken for singular


@functools.lru_cache(maxsize=1)
def _pardiso() -> Any:
    """pypardiso's module, or None. Its own search for the library walks the whole environment, so name the file."""
    try:
        for file in importlib.metadata.files("mkl") or ():
            if "mkl_rt" in file.name:
                os.environ.setdefault("PYPARDISO_MKL_RT", str(file.locate()))
                break
        import pypardiso

        pypardiso.PyPardisoSolver()
    except (ImportError, OSError, importlib.metadata.PackageNotFoundError):
        return None
    return pypardiso


def solver_name() -> str:
    """Which library ``solve`` uses here."""
    return "PARDISO" if _pardiso() is not None else "SuperLU"


def solve(matrix: Any, rhs: NDArray[np.float64], *, symmetric: bool) -> NDArray[np.float64]:
    """Solve matrix x = rhs; ``matrix`` is CSR with its diagonal stored, for ``symmetric`` only its upper triangle.

    Raises SingularModelError where the matrix is singular to working precision.
    """
    if len(rhs) == 0:
        return np.zeros(0)
    x = _solve_pardiso(matrix, rhs, symmetric) if _pardiso() is not None else _solve_superlu(matrix, rhs, symmetric)
    product = matrix @ x
    if symmetric:
        product = product + matrix.T @ x - matrix.diagonal() * x
    size = np.abs(rhs).max()
    if not np.isfinite(x).all() or np.abs(product - rhs).max() > RESIDUAL_LIMIT * max(size, 1e-300):
        raise SingularModelError("the equations have no unique solution; check supports, contacts and units")
    return x


def _solve_pardiso(matrix: Any, rhs: NDArray[np.float64], symmetric: bool) -> NDArray[np.float64]:
    module = _pardiso()
    solver = module.PyPardisoSolver(mtype=SYMMETRIC_INDEFINITE if symmetric else UNSYMMETRIC)
    # own settings; nested dissection; up to 5 refinements; pivots perturbed at 1e-10 or 1e-13, scaling, matching
    settings = {1: 1, 2: 2, 8: 5, 10: 10 if symmetric else 13, 11: 1, 13: 1, 18: 0, 21: 1}
    for key, value in settings.items():
        solver.iparm[key - 1] = value
    try:
        x: NDArray[np.float64] = solver.solve(matrix, rhs)
    except module.PyPardisoError as error:
        raise SingularModelError(f"the direct solver gave up ({error}); check supports, contacts and units") from None
    finally:
        solver.free_memory(everything=True)
    return x


def _solve_superlu(matrix: Any, rhs: NDArray[np.float64], symmetric: bool) -> NDArray[np.float64]:
    full = matrix + sp.triu(matrix, 1).T if symmetric else matrix
    try:
        return np.asarray(spla.splu(full.tocsc()).solve(rhs))
    except RuntimeError as error:
        raise SingularModelError(f"the direct solver gave up ({error}); check supports, contacts and units") from None
