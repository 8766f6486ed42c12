"""Finite turns of rigid bodies, and of surfaces that are turned about an axis; theory (D11), (D12)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.dofs import dofs_at, n_dofs, widened
from abut.types import Array, Sparse

NEAR = 1e-2  # square of an angle below which series serve
STEP = 1e-30  # of complex steps, which lose no digits
SPIN = np.array([[[(i - j) * (j - k) * (k - i) / -2.0 for j in range(3)] for i in range(3)] for k in range(3)])  # e_k x


@dataclass(frozen=True)
class Turn:
    """Points that turn about a centre by a rotation vector, which is affine in the free displacements.

    nodes: (n,) points; arms: (n, 3) from the centre, undeformed; by_free: (3, n_free) sparse and given: (3, n_histories), of
    the rotation vector, radians; small: whether the small turn of these points is among the linear displacements."""

    nodes: NDArray[np.int64]
    arms: Array
    by_free: Sparse
    given: Array
    small: bool

    def vector(self, free: Array, factors: Array) -> Array:
        """The rotation vector at free displacements (n_free,) and factors (n_histories,) of the histories."""
        return np.asarray(self.by_free @ free + self.given @ factors)


@dataclass(frozen=True)
class Turns:
    """All finite turns of a model, beside what is linear in the displacements: with small turns, which are in it already.

    dim: of the mesh; n_points: of the mesh."""

    turns: Sequence[Turn]
    dim: int
    n_points: int

    def widened(self, n_free: int) -> Turns:
        """With so many unknowns, further ones turning nothing."""
        return replace(self, turns=[replace(turn, by_free=widened(turn.by_free, n_free)) for turn in self.turns])

    def displacement(self, free: Array, factors: Array) -> Array:
        """What finite turns add to the displacements of small ones, (dim n_points,)."""
        result = np.zeros((self.n_points, self.dim))
        for turn in self.turns:
            vector = turn.vector(free, factors)
            beyond = rotation(vector) - np.eye(3)
            if turn.small:
                beyond = beyond - np.einsum("k,kij->ij", vector, SPIN)
            result[turn.nodes] += (turn.arms @ beyond.T)[:, : self.dim]
        return result.ravel()

    def columns(self, free: Array, factors: Array) -> Sparse:
        """Derivative of ``displacement`` by the free displacements, (dim n_points, n_free)."""
        total = sp.csr_matrix((n_dofs(self.n_points, self.dim), len(free)))
        for turn in self.turns:
            if not turn.by_free.nnz:
                continue
            beyond = slopes(turn.vector(free, factors)) - SPIN
            moved = np.einsum("kij,nj->nik", beyond, turn.arms)[:, : self.dim].reshape(-1, 3)
            rows = dofs_at(turn.nodes, self.dim).ravel()
            place = sp.csr_matrix((np.ones(len(rows)), (rows, np.arange(len(rows)))), shape=(total.shape[0], len(rows)))
            total = total + place @ sp.csr_matrix(moved) @ turn.by_free
        return total.tocsr()

    def bending(self, free: Array, factors: Array, force: Array) -> Sparse:
        """Second derivative of the work of forces (dim n_points,) by the free displacements, (n_free, n_free)."""
        total = sp.csr_matrix((len(free),) * 2)
        nodal = np.zeros((self.n_points, 3))
        nodal[:, : self.dim] = force.reshape(-1, self.dim)
        for turn in self.turns:
            if turn.by_free.nnz:
                second = _second(turn.vector(free, factors), nodal[turn.nodes].T @ turn.arms)
                total = total + turn.by_free.T @ sp.csr_matrix(second) @ turn.by_free
        return total.tocsr()


def rotation(vector: Array) -> Array:
    """The matrix (3, 3) that turns about a rotation vector by its length (Rodrigues)."""
    a, b, _, _ = _factors(vector)
    spin = np.einsum("k,kij->ij", vector, SPIN)
    return np.eye(3) + a * spin + b * spin @ spin


def slopes(vector: Array) -> Array:
    """Derivatives (3, 3, 3) of ``rotation`` by the components of the vector, these first."""
    a, b, da, db = _factors(vector)
    spin = np.einsum("k,kij->ij", vector, SPIN)
    square = spin @ spin
    return np.stack(
        [vector[k] * (da * spin + db * square) + a * SPIN[k] + b * (SPIN[k] @ spin + spin @ SPIN[k]) for k in range(3)]
    )


def _factors(vector: Array) -> tuple[Any, Any, Any, Any]:
    """sin f / f, (1 - cos f) / f^2, and their derivatives by f over f; of complex vectors too."""
    square = (vector * vector).sum()
    if abs(square) < NEAR:
        s = square
        return (
            1 - s / 6 * (1 - s / 20 * (1 - s / 42 * (1 - s / 72))),
            0.5 * (1 - s / 12 * (1 - s / 30 * (1 - s / 56))),
            -1 / 3 + s / 30 - s**2 / 840 + s**3 / 45360,
            -1 / 12 + s / 180 - s**2 / 6720 + s**3 / 453600,
        )
    angle = np.sqrt(square)
    a, b = np.sin(angle) / angle, (1 - np.cos(angle)) / square
    return a, b, (np.cos(angle) - a) / square, (a - 2 * b) / square


def _second(vector: Array, work: Array) -> Array:
    """Second derivative (3, 3) of work : rotation(vector)."""
    columns = []
    for step in np.eye(3):
        complex_ = slopes(vector + 1j * STEP * step)
        columns.append(np.einsum("kij,ij->k", complex_.imag, work) / STEP)
    return np.stack(columns, axis=1)


def about(nodes: NDArray[np.int64], points: Array, centre: Array, by_free: Sparse, given: Array, small: bool) -> Turn:
    """A turn of points (n, dim) about a centre (dim,); by_free and given: in the plane (1, n), about its normal."""
    arms, row = np.zeros((len(nodes), 3)), 2 if points.shape[1] == 2 else 0
    arms[:, : points.shape[1]] = points - centre
    place = sp.csr_matrix(np.eye(3)[:, row:])
    return Turn(nodes, arms, (place @ by_free).tocsr(), place @ given, small)
