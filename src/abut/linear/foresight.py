"""The next active set, foreseen by contact of half spaces through the present state: solved on the interface alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.linear.schur_preconditioner import Apply, HalfSpaces
from abut.types import Sparse

FORESEEN, SOLVES = 1e-4, 100  # of gaps closed on the interface alone, where the edge of contact is sharp; iterations
LOOSE = 1e-9  # resistance of rows to a motion, over the largest, below which it is none
PREDICTIONS = 30  # active sets tried on the interface alone
Predict = Callable[[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_]], NDArray[np.bool_]]


def foresight(spaces: Callable[[], HalfSpaces], moved: NDArray[np.float64]) -> Predict:
    """A guess at the next active set: contact of half spaces, g = g0 + S (p - p0) + C a, solved on the interface alone.

    spaces: asked when they are first needed; moved: (n, m) change of the weighted gaps by rigid motions that supports leave
    free (C), of any size, which the pressures keep in balance. The function takes gap g0, pressure p0, a first active set,
    the rows that are never open."""

    @cache
    def ready() -> Foresight:
        size = np.linalg.norm(moved, axis=0)
        return Foresight(spaces(), sp.csr_matrix(moved / np.where(size > 0.0, size, 1.0)))

    return lambda *state: ready().predict(*state)


@dataclass(frozen=True)
class Foresight:
    """Contact of half spaces; moved: as in ``foresight``, sparse."""

    half_spaces: HalfSpaces
    moved: Sparse

    def predict(
        self,
        gap: NDArray[np.float64],
        pressure: NDArray[np.float64],
        active: NDArray[np.bool_],
        tied: NDArray[np.bool_],
    ) -> NDArray[np.bool_]:
        p = np.where(tied, 0.0, pressure)
        rest, force = gap - self.half_spaces.forward(p), self.moved.T @ p
        for _ in range(PREDICTIONS):
            normal = active & ~tied
            if not normal.any():
                return active
            p, shift = self._closed(rest, force, normal, p)
            g = rest + self.half_spaces.forward(p) + self.moved @ shift
            following = np.where(active, p > 0.0, g < 0.0) | tied
            if (following == active).all() or not following[~tied].any():
                return active
            active = following
        return active

    def _closed(
        self,
        rest: NDArray[np.float64],
        force: NDArray[np.float64],
        normal: NDArray[np.bool_],
        guess: NDArray[np.float64],
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Pressures on the rows ``normal`` that close the gap there, with the resultants ``force`` on loose bodies, and the
        bodies' motions: conjugate gradients among pressures of these resultants, from ``guess`` on."""
        size = self.half_spaces.size[normal]
        motions = sp.diags(1.0 / size) @ self.moved[normal]
        small = np.linalg.pinv((motions.T @ motions).toarray(), rcond=LOOSE, hermitian=True)

        def balanced(x: NDArray[np.float64]) -> NDArray[np.float64]:
            return np.asarray(x - motions @ (small @ (motions.T @ x)))

        def whole(values: NDArray[np.float64]) -> NDArray[np.float64]:
            result = np.zeros(len(normal))
            result[normal] = values
            return result

        def multiply(x: NDArray[np.float64]) -> NDArray[np.float64]:
            return np.asarray(self.half_spaces.forward(whole(x / size))[normal] / size)

        def precondition(x: NDArray[np.float64]) -> NDArray[np.float64]:
            return balanced(self.half_spaces.inverse(whole(x * size))[normal] * size)

        fixed = rest[normal] / size
        start = balanced(guess[normal] * size) + motions @ (small @ force)
        left = -fixed - multiply(start)
        accuracy = FORESEEN * float(np.linalg.norm(balanced(fixed)))
        found, left = _conjugate_gradients(multiply, precondition, balanced, start, left, accuracy)
        return whole(found / size), small @ (motions.T @ left)


def _conjugate_gradients(
    multiply: Apply, precondition: Apply, balanced: Apply,
    x: NDArray[np.float64], residual: NDArray[np.float64], accuracy: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:  # fmt: skip
    """From x and its residual on, in the space that ``balanced`` projects to, until the residual there is below
    ``accuracy``: solution and residual."""
    direction, before = np.zeros_like(x), np.inf
    for _ in range(SOLVES):
        inside = balanced(residual)
        if np.linalg.norm(inside) <= accuracy:
            break
        better = precondition(inside)
        product = float(inside @ better)
        direction = better + product / before * direction
        before, image = product, multiply(direction)
        energy = float(direction @ image)
        if not (product > 0.0 and energy > 0.0):  # rounding is all that is left
            break
        length = product / energy
        x, residual = x + length * direction, residual - length * image
    return x, residual
