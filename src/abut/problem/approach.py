"""What the surfaces of a contact with friction move past each other while they only come closer: no slip, theory (R4)."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from abut.contact.pressure_space import PressureSpace
from abut.problem.pair import Pair
from abut.problem.turned_places import TurnedPlaces

STEEP = 0.5  # cosine between a normal and the direction of approach: beyond 60 degrees as at 60
NO_WAY = 1e-6  # of a mean of unit vectors that cancel each other, or are all held
Array = NDArray[np.float64]


def approach_slip(pair: Pair, gap: Array, multipliers: Array, closed: NDArray[np.bool_]) -> Array:
    """Weighted tangential jumps (n_tangential,) at which what is open closes without slip, if the bodies approach along
    the mean normal of the nearest contact. gap, multipliers, closed: (n,) at the end of the last step, the gap weighted."""
    slip = pair.slip
    assert slip is not None
    result = np.zeros(len(pair))
    normal = pair.normal
    open_by = np.maximum(gap[normal] / pair.weight[normal], 0.0)
    if not open_by.any():
        return result[pair.tangential]
    ways = _ways(pair, open_by, np.maximum(multipliers[normal], 0.0), closed[normal])
    straight = np.maximum(np.einsum("kd,kd->k", slip.normals, ways), STEEP)
    for b, index in enumerate(pair.index[:, 1:].T):
        there = index >= 0
        along = -open_by * np.einsum("kd,kd->k", slip.tangents[:, b], ways) / straight
        result[index[there]] = along[there]
    return (pair.weight * result)[pair.tangential]


def _ways(pair: Pair, open_by: Array, pressure: Array, closed: NDArray[np.bool_]) -> Array:
    """Unit direction of approach for each function, (n_functions, dim): the mean normal of the place where its part of the
    surface is closest, weighted by the pressure where it is in contact; zero where supports leave none."""
    assert pair.slip is not None
    near = _neighbours(pair.space)
    height = np.where(closed, -1.0, open_by)
    down = _next(near, height)
    place = _last(down)
    weight = pair.weight[pair.normal]
    carries = np.bincount(place, pressure * closed, minlength=len(place)) > 0.0
    share = np.where(carries[place], pressure, 1.0) * closed * weight
    roots = np.flatnonzero((place == np.arange(len(place))) & ~closed)
    share = share + _beside(near, open_by, roots, weight)
    constraints = np.where((pair.index[:, 1:] < 0)[..., None], pair.slip.tangents, 0.0)
    normals, turned = pair.slip.normals, TurnedPlaces.of(pair, down, height < 0.0)
    if turned is not None:
        normals, constraints = turned.here(normals), turned.here(constraints)
    dim = pair.contactor.dim
    total, stuck = np.zeros((len(place), dim)), np.zeros((len(place), dim, dim))
    np.add.at(total, place, share[:, None] * normals)
    np.add.at(stuck, place, (share > 0.0)[:, None, None] * np.einsum("kbd,kbe->kde", constraints, constraints))
    if turned is not None:
        total[turned.closed] = total[turned.closed] @ turned.along
    size = np.bincount(place, share, minlength=len(place))
    for root in np.flatnonzero(np.abs(stuck).max(axis=(1, 2)) > 0.0):
        values, axes = np.linalg.eigh(stuck[root])
        free = axes[:, values <= NO_WAY * values[-1]]
        total[root] = free @ (free.T @ total[root])
    length = np.linalg.norm(total, axis=1)
    some = length > NO_WAY * size
    ways = np.where(some[:, None], total / np.where(some, length, 1.0)[:, None], 0.0)
    return np.asarray(ways[place]) if turned is None else turned.there(ways[place])


def _neighbours(space: PressureSpace) -> sp.csr_matrix:
    """Functions that share a facet, (n, n), each its own neighbour."""
    uses = abs(space.plain).tocoo()
    by_facet = sp.csr_matrix(
        (np.ones(len(uses.row)), (uses.row // 9, uses.col)), shape=(uses.shape[0] // 9, len(space))
    )
    return (by_facet.T @ by_facet).tocsr()


def _next(near: sp.csr_matrix, height: Array) -> NDArray[np.int64]:
    """For each function the next one on the steepest way down, (n,), itself where that ends; of a connected part in contact,
    with negative height, the first."""
    n = len(height)
    links = near.tocoo()
    both = (height[links.row] < 0.0) & (height[links.col] < 0.0)
    _, label = connected_components(
        sp.csr_matrix((np.ones(int(both.sum())), (links.row[both], links.col[both])), (n, n))
    )
    _, first = np.unique(label, return_index=True)
    order = np.lexsort((links.col, height[links.col], links.row))
    row, col = links.row[order], links.col[order]
    down = np.arange(n)
    rows, start = np.unique(row, return_index=True)
    down[rows] = col[start]
    return np.where(height < 0.0, first[label], down)


def _last(down: NDArray[np.int64]) -> NDArray[np.int64]:
    """Where the ways end, (n,)."""
    while True:
        further = down[down]
        if (further == down).all():
            return down
        down = further


def _beside(near: sp.csr_matrix, open_by: Array, roots: NDArray[np.int64], weight: Array) -> Array:
    """Weights (n,) of the functions at and beside the closest ones ``roots``, less the farther open."""
    beside = near[roots].tocoo()
    most = np.zeros(len(roots))
    np.maximum.at(most, beside.row, open_by[beside.col])
    less = (1.0 + NO_WAY) * most[beside.row] - open_by[beside.col]
    return np.asarray(np.bincount(beside.col, less * weight[beside.col], minlength=len(open_by)), dtype=float)
