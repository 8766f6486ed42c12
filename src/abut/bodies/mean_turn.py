"""The turn that takes points nearest to where they are, and its derivative; theory (D14), (D15), (D16)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from abut.dofs import dofs_at
from abut.types import Array


def spin(vectors: Array) -> Array:
    """The matrices (..., 3, 3) that multiply a vector by cross(v, .)."""
    result = np.zeros((*vectors.shape, 3))
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        result[..., j, i], result[..., i, j] = vectors[..., k], -vectors[..., k]
    return result


def mean_turn(arms: Array, points: Array, weights: Array) -> Array:
    """The rotation (3, 3) by which arms (n, dim), their weighted mean zero, come nearest to points (n, dim) about theirs."""
    at = points - weights @ points
    product = at.T @ (weights[:, None] * arms)
    if arms.shape[1] == 2:
        c, s = product[0, 0] + product[1, 1], product[1, 0] - product[0, 1]
        c, s = np.array([c, s]) / (np.hypot(c, s) or 1.0)
        return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    u, _, v = np.linalg.svd(product)
    return np.asarray(u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ v)) or 1.0]) @ v)


@dataclass(frozen=True)
class Spread:
    """Forces at points that follow their turn. force: (n, dim); left @ right: (dim n, 6) and (6, dim n), their derivative by
    the points, where there is one (turns)."""

    force: Array
    left: Array
    right: Array
    turns: bool


def spread(arms: Array, points: Array, weights: Array, offset: Array, force: Array, moment: Array) -> Spread:
    """A force (dim,) at ``offset`` (dim,) from the mean of undeformed points, which turns with them, and a moment (1,) or
    (3,), as forces at the points now (n, dim): theory (D15). arms: (n, dim) from the mean, undeformed; weights: (n,), sum 1.

    The points must not lie on a line in 3D, unless neither the moment nor the offset has a part that turns about it."""
    n, dim = arms.shape
    whole = [_in_space(x) for x in (arms, points, offset[None], force[None])]
    (arms, points), offset, force = whole[:2], whole[2][0], whole[3][0]
    moment = moment if dim == 3 else np.array([0.0, 0.0, moment[0]])
    turns = bool(moment.any() or (offset.any() and force.any()))
    turn = mean_turn(arms[:, :dim], points[:, :dim], weights)
    a, y, d = arms @ turn.T, points - weights @ points, turn @ offset
    product = np.einsum("n,ni,nj->ij", weights, a, y)
    axes = np.eye(3)[:, 0 if dim == 3 else 2 :]
    inertia = axes.T @ (np.trace(product) * np.eye(3) - product) @ axes
    soft = axes @ np.linalg.pinv(0.5 * (inertia + inertia.T), rcond=1e-12, hermitian=True) @ axes.T
    s = soft @ (moment + np.cross(d, force))
    forces = weights[:, None] * (force + np.cross(s, a))
    along, across = spin(a), spin(np.cross(s, a))
    by_turn = np.einsum("ij,njk->ink", soft, weights[:, None, None] * along).reshape(3, -1)
    bent = spin(force) @ spin(d) - spin(product @ s)
    by_own = np.einsum("n,nij->inj", weights, across).reshape(3, -1)
    by_lever = soft @ (bent @ by_turn + by_own)
    left = -weights[:, None, None] * np.concatenate([along, spin(s) @ along], axis=2)
    kept = dofs_at(np.arange(n), 3)[:, :dim].ravel()
    return Spread(forces[:, :dim], left.reshape(-1, 6)[kept], np.concatenate([by_lever, by_turn])[:, kept], turns)


def _in_space(vectors: Array) -> Array:
    result = np.zeros((len(vectors), 3))
    result[:, : vectors.shape[1]] = vectors
    return result
