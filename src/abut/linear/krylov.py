"""Flexible GMRES: the preconditioner may change, as one in single precision does (Saad 1993)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Apply = Callable[[Vector], Vector]


DRIFT = 2.0  # by rounding the true residual may lag behind the one that the recurrence tells


def fgmres(
    multiply: Apply, precondition: Apply, rhs: Vector, reduction: float, restart: int, cycles: int
) -> tuple[Vector, int, bool]:
    """Solve multiply(x) = rhs from zero until the residual is ``reduction`` times its first size.

    Returns x, the iterations, and whether that was reached within ``cycles`` times ``restart`` of them."""
    x, residual, count = np.zeros_like(rhs), rhs, 0
    size = float(np.linalg.norm(rhs))
    wanted = reduction * size
    for _ in range(cycles):
        if not size > DRIFT * wanted:
            break
        step, used = _cycle(multiply, precondition, residual, wanted, restart)
        x, count = x + step, count + used
        residual = rhs - multiply(x)
        size = float(np.linalg.norm(residual))
    return x, count, size <= DRIFT * wanted


def _cycle(multiply: Apply, precondition: Apply, residual: Vector, wanted: float, restart: int) -> tuple[Vector, int]:
    """One cycle of at most ``restart`` iterations, and how many it took."""
    n = len(residual)
    basis, images = np.empty((restart + 1, n)), np.empty((restart, n))  # memory is taken only where rows are written
    hessenberg, rotations = np.zeros((restart + 1, restart)), np.zeros((restart, 2))
    reduced = np.zeros(restart + 1)
    reduced[0] = np.linalg.norm(residual)
    basis[0] = residual / reduced[0]
    k = 0
    while k < restart and abs(reduced[k]) > wanted:
        images[k] = precondition(basis[k])
        image = multiply(images[k])
        for _ in range(2):  # Gram and Schmidt, twice, which is as good as Householder and two products a time
            shares = basis[: k + 1] @ image
            image = image - shares @ basis[: k + 1]
            hessenberg[: k + 1, k] += shares
        length = float(np.linalg.norm(image))
        column = hessenberg[: k + 2, k]
        column[k + 1] = length
        for i, (c, s) in enumerate(rotations[:k].tolist()):
            column[i : i + 2] = c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]
        size = float(np.hypot(column[k], length))
        if not size > 0.0 or not np.isfinite(size):
            break
        rotations[k] = column[k] / size, length / size
        column[k : k + 2] = size, 0.0
        c, s = rotations[k].tolist()
        reduced[k : k + 2] = c * reduced[k], -s * reduced[k]
        k += 1
        if not length > 0.0:
            break
        basis[k] = image / length
    coefficients = np.linalg.solve(np.triu(hessenberg[:k, :k]), reduced[:k])
    return np.asarray(coefficients @ images[:k]), k
