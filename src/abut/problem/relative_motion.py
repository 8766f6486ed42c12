"""In which directions supports let contactor and target move past each other: there is friction along these, theory (R1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from abut.contact.node_to_segment import feet
from abut.dofs import dofs_at, n_dofs
from abut.mesh.surface import Surface
from abut.problem.constraints import Constraints
from abut.types import Sparse

MOVES = 1e-6  # of a point of the target, by unit free displacements, below which it is held
GIVEN = 1e-9  # of the largest displacement prescribed: a difference below it is rounding
SAME = 1e-9  # share of a direction that is rounding
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Passing:
    """moves: (n, dim, dim) projectors on the directions in which two sides pass each other at n functions of the contactor,
    free or as prescribed; own: the same of the contactor's point alone; more: (n,) where the target adds to it."""

    moves: Array
    own: Array
    more: NDArray[np.bool_]

    def carried(self, along: Array) -> NDArray[np.bool_]:
        """Whether the target passes along directions (n, dim) while supports hold the contactor's point, in all or in part,
        (n,)."""
        return self.more & (np.einsum("na,nab,nb->n", along, self.own, along) < 1.0 - SAME)


def passing(
    contactor: Surface,
    target: Surface,
    nodes: NDArray[np.int64],
    normals: Array,
    reach: float,
    constraints: Constraints,
) -> Passing:
    """Of functions at ``nodes`` (n,) of the contactor, -1 for those of a facet alone, which supports do not hold; normals:
    (n, dim) from target to contactor; reach: a length. Where nothing is opposite the nearest node of the target counts."""
    n, dim = normals.shape
    axes = [constraints.can_move(nodes, np.broadcast_to(np.eye(dim)[a], (n, dim))) for a in range(dim)]
    moves = np.where(nodes[:, None, None] >= 0, np.stack(axes, axis=1), np.eye(dim))
    own = moves.copy()
    less = np.flatnonzero(np.abs(own - np.eye(dim)).max(axis=(1, 2), initial=0.0) > SAME)
    own[less] = _spanned(own[less], SAME)
    held = np.flatnonzero(np.abs(own - np.eye(dim)).max(axis=(1, 2), initial=0.0) > SAME)
    more = np.zeros(n, dtype=bool)
    if len(held):
        other = _opposite(contactor.points, target, nodes[held], -normals[held], reach)
        added = _spanned(_freely(other, constraints, dim), MOVES**2)
        added += _spanned(_as_prescribed(other, nodes[held], constraints, dim), GIVEN**2)
        adds = np.abs(added - own[held] @ added).max(axis=(1, 2)) > SAME
        more[held[adds]] = True
        moves[held[adds]] = _spanned(own[held] + added, SAME)[adds]
    return Passing(moves, own, more)


def _opposite(points: Array, target: Surface, nodes: NDArray[np.int64], outward: Array, reach: float) -> Sparse:
    """The target's points opposite ``nodes`` (n,) as means of its nodes, (n, n_points)."""
    facet, weights, _ = feet(points[nodes], outward, target, reach)
    met = np.where((facet >= 0)[:, None], target.nodes[facet], -1)
    row, local = np.nonzero(met >= 0)
    missed = np.flatnonzero(facet < 0)
    ids = target.node_ids
    nearest = ids[cKDTree(target.points[ids]).query(points[nodes[missed]])[1]]
    value = np.concatenate([weights[row, local], np.ones(len(missed))])
    place = np.concatenate([row, missed]), np.concatenate([met[row, local], nearest])
    return sp.csr_matrix((value, place), shape=(len(nodes), len(points)))


def _freely(means: Sparse, constraints: Constraints, dim: int) -> Array:
    """Products (n, dim, dim) of the motions of means of points by unit free displacements."""
    parts = [_component(means, a, dim) @ constraints.free for a in range(dim)]
    return np.array([[np.asarray(p.multiply(q).sum(axis=1)).ravel() for q in parts] for p in parts]).transpose(2, 0, 1)


def _as_prescribed(means: Sparse, nodes: NDArray[np.int64], constraints: Constraints, dim: int) -> Array:
    """Products (n, dim, dim) of what means of points are moved by past ``nodes`` (n,), over the largest there is; all
    directions where either is turned about an axis."""
    given = constraints.prescribed
    size = max(float(np.abs(given).max(initial=0.0)), 1e-300)
    parts = [(_component(means, a, dim) @ given - given[dofs_at(nodes, dim)[:, a]]) / size for a in range(dim)]
    result = np.array([[(p * q).sum(axis=1) for q in parts] for p in parts]).transpose(2, 0, 1)
    for turn in () if constraints.turns is None else constraints.turns.turns:
        if turn.given.any():
            turns = np.zeros(means.shape[1])
            turns[turn.nodes] = 1.0
            result[(abs(means) @ turns > 0.0) != (turns[nodes] > 0.0)] = np.eye(dim)
    return np.asarray(result)


def _component(means: Sparse, axis: int, dim: int) -> Sparse:
    """On displacements (dim n_points,), (n, dim n_points)."""
    at = means.tocoo()
    return sp.csr_matrix((at.data, (at.row, dofs_at(at.col, dim)[:, axis])), (at.shape[0], n_dofs(at.shape[1], dim)))


def _spanned(products: Array, none: float) -> Array:
    """Projectors (n, dim, dim) on what symmetric matrices span, above an eigenvalue that is none."""
    size, axes = np.linalg.eigh(products)
    return np.asarray(np.einsum("nab,nb,ncb->nac", axes, (size > none).astype(float), axes))
