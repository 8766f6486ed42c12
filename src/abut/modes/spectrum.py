"""The lowest eigenpairs of a symmetric pencil by Lanczos' method on prepared factors, and whether any are missing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from abut.errors import ConvergenceError
from abut.types import Operator

MORE = 4  # eigenvalues beyond those asked for, between which a count finds a gap
APART = 1e-5  # relative distance of eigenvalues that are two
TOLERANCE = 1e-10  # of Ritz values; modes then to about as much, frequencies better
RESTARTS = 100  # of the method; where all t are negative it finds none however long
Vector = NDArray[np.float64]


class Factored(Protocol):
    """Factors of a symmetric matrix, with what contact holds beside it."""

    def solve(self, force: Vector) -> Vector:
        """Displacements (n_free,) by forces (n_free,). Raises SingularModelError."""
        ...

    @property
    def negative(self) -> int | None:
        """How many of the matrix' eigenvalues on motions that contact allows are negative (Sylvester's law of inertia);
        None where the factors do not tell."""
        ...


@dataclass(frozen=True)
class Pencil:
    """solve(left x) = t x on the directions that are free, with ``factors``: shift and invert where ``left`` is the
    ``metric``, t then being 1 / (lambda - shift), largest by size; else the positive t, largest first. metric: symmetric, in
    which modes are orthogonal; size: of x; free: how many directions there are."""

    factors: Factored
    left: Operator
    metric: Operator
    size: int
    free: int

    @property
    def inverts(self) -> bool:
        """Whether it is shift and invert."""
        return self.left is self.metric

    def wanted(self, count: int) -> tuple[int, int]:
        """How many t there may be, at most ``count``, and the size of a basis to find them in."""
        found = max(min(count, self.free - 1), 1)
        return found, min(max(2 * found + 1, 20), self.size)

    def start(self, seed: int) -> Vector:
        """A vector (size,) to begin with."""
        return self.factors.solve(self.left @ np.random.default_rng(seed).standard_normal(self.size))


@dataclass(frozen=True)
class Pairs:
    """values: (n,) t; vectors: (size, n)."""

    values: Vector
    vectors: Vector


def largest(pencil: Pencil, count: int, seed: int = 0) -> Pairs:
    """The ``count`` largest t of ``pencil``, or as many as there may be; of positive t those found where iterations end.
    Raises ConvergenceError where they end else."""
    count, basis = pencil.wanted(count)
    start, shape = pencil.start(seed), (pencil.size, pencil.size)
    operator = spla.LinearOperator(shape, matvec=lambda x: pencil.factors.solve(np.ravel(x)), dtype=float)
    try:
        if pencil.inverts:
            values, vectors = spla.eigsh(
                pencil.left,
                count,
                pencil.metric,
                sigma=0.0,
                which="LM",
                v0=start,
                ncv=basis,
                tol=TOLERANCE,
                OPinv=operator,
            )
            values = 1.0 / values
        else:
            values, vectors = spla.eigsh(
                pencil.left,
                count,
                pencil.metric,
                Minv=operator,
                which="LA",
                v0=start,
                ncv=basis,
                tol=TOLERANCE,
                maxiter=RESTARTS,
            )
    except spla.ArpackNoConvergence as ended:
        if pencil.inverts:
            raise ConvergenceError(f"modes: Lanczos' method did not converge ({ended}); ask for fewer modes") from None
        values, vectors = ended.eigenvalues, ended.eigenvectors
    except spla.ArpackError as reason:
        raise ConvergenceError(f"modes: Lanczos' method did not converge ({reason}); ask for fewer modes") from None
    return Pairs(values, vectors)


def gap_after(values: Vector, count: int, rounding: float = 0.0) -> tuple[int, float] | None:
    """How many of ascending ``values`` (n,) lie below the first gap at or after the first ``count``, and a number in that
    gap; None where there is none. rounding: of values."""
    for i in range(count, len(values)):
        below, above = values[i - 1], values[i]
        if above - below > max(APART * max(abs(above), abs(below)), 2.0 * rounding):
            return i, float(0.5 * (below + above))
    return None
