"""The normals of a contact at small displacements, where supports have a say."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.contact.common_normals import common_normals
from abut.contact.coupling import Couple
from abut.contact.geometry import nodal_normals
from abut.errors import InputError
from abut.mesh.surface import Surface
from abut.problem.constraints import Constraints

Array = NDArray[np.float64]
ROUNDING = 1e-12  # of unit normals
LEAN = 3.0  # of a normal out of a plane of symmetry, over the angle by which its facet turns that way: round surfaces


def contact_normals(
    contactor: Surface, target: Surface, share: float, reach: float, couple: Couple, constraints: Constraints
) -> Array:
    """As ``common_normals``; at nodes that supports hold beside them, as at a plane of symmetry, they lie in the directions
    that are left."""
    outward = _upright(contactor, nodal_normals(contactor), constraints)
    try:
        other = _upright(target, nodal_normals(target), constraints)
    except InputError:  # a facet without a normal at a node: the contactor may still see the others
        return outward
    if share == 0.0:
        return outward
    return _upright(contactor, common_normals(contactor, target, outward, other, share, reach, couple), constraints)


def _upright(surface: Surface, normals: Array, constraints: Constraints) -> Array:
    """Normals (n_facets, 9, dim) of facets that lie on one side of a plane of symmetry alone lean out of it: by as much as
    a round surface turns that way, and no more. (Cones turn round their axis alone: what holds them along it cuts none.)"""
    used = surface.nodes >= 0
    node, vectors = surface.nodes[used].astype(np.int64), normals[used]
    moves = constraints.can_move(node, vectors)
    length, lean = np.linalg.norm(moves, axis=1), np.linalg.norm(vectors - moves, axis=1)
    held = (vectors - moves) / np.maximum(lean, 1e-300)[:, None]
    mean = normals.sum(axis=1) / used.sum(axis=1, keepdims=True)
    away = np.where(used[..., None], normals - mean[:, None], 0.0)[np.nonzero(used)[0]]
    turn = np.zeros(len(surface.points))
    np.maximum.at(turn, node, 2.0 * np.abs(np.einsum("nkd,nd->nk", away, held)).max(axis=1, initial=0.0))
    leans = (lean > ROUNDING) & (lean <= LEAN * turn[node]) & (length > 0.5)
    vectors[leans] = moves[leans] / length[leans, None]
    result = normals.copy()
    result[used] = vectors
    return result
