"""The normals of a contact at small displacements, where supports have a say."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.contact.bulge import Held
from abut.contact.common_normals import common_normals
from abut.contact.coupling import Couple
from abut.contact.geometry import nodal_normals, turning_within
from abut.errors import InputError
from abut.mesh.surface import Surface
from abut.model import Model
from abut.model.symmetry import held_directions

Array = NDArray[np.float64]
LEAN = (
    3.0  # of a normal out of a plane of symmetry, over the angle by which its facet turns that way: 1 on round surfaces
)
LESS = 1.2  # of it over those farther away, which lean more; alike in the corner of a ball
UPRIGHT = 1e-9  # lean that is rounding
SAME = 1e-6  # directions that differ by less are one


def contact_normals(
    model: Model, contactor: Surface, target: Surface, share: float, reach: float, couple: Couple
) -> Array:
    """As ``common_normals``; at nodes that supports hold beside them, as at a plane of symmetry, they lie in the directions
    that are left."""
    held = held_directions(model.mesh, model.supports)
    outward, mirrors = _upright(contactor, held)
    if share == 0.0:
        return outward
    try:
        other, _ = _upright(target, held)
    except InputError:  # a facet without a normal at a node: the contactor may still see the others
        return outward
    normals = common_normals(contactor, target, outward, other, share, reach, couple)
    return mirrors.straightened(contactor, normals)


@dataclass(frozen=True)
class _Mirrors:
    """Points (n,) on planes of symmetry, sorted, and projections (n, dim, dim) on what lies in these."""

    points: NDArray[np.int64]
    projection: Array

    def straightened(self, surface: Surface, normals: Array, limit: float = LEAN) -> Array:
        """Normals (n_facets, 9, dim) of a surface in the planes; as they are where they lean by more than ``limit`` times
        the angle by which their facets turn, or would have to turn by more than 60 degrees."""
        if not len(self.points):
            return normals
        facet, local = np.nonzero(surface.nodes >= 0)
        node = surface.nodes[facet, local]
        at = np.minimum(np.searchsorted(self.points, node), len(self.points) - 1)
        here = self.points[at] == node
        facet, local, at = facet[here], local[here], at[here]
        inside = np.einsum("vab,vb->va", self.projection[at], normals[facet, local])
        lean, length = np.linalg.norm(normals[facet, local] - inside, axis=1), np.linalg.norm(inside, axis=1)
        turn = np.zeros(len(self.points))
        np.maximum.at(turn, at, turning_within(surface, normals)[facet])
        change = (lean > 0.0) & (lean <= limit * turn[at]) & (length > 0.5)
        result = normals.copy()
        result[facet[change], local[change]] = inside[change] / length[change, None]
        return result


def _upright(surface: Surface, held: Held | None) -> tuple[Array, _Mirrors]:
    """Nodal normals (n_facets, 9, dim). Those of facets that lie on one side of a plane of symmetry alone lean out of it,
    and farther from it the more: by as much as a round surface turns across the plane. Such ones are put into it; others
    stay: a cone does not turn along its axis, however its normals lean, and those of a crowned roller lean most on the
    planes that hold its ends."""
    normals, dim = nodal_normals(surface), surface.dim
    points, directions = _planes(surface, held)
    if not len(points):
        return normals, _Mirrors(np.zeros(0, dtype=np.int64), np.zeros((0, dim, dim)))
    facet, local = np.nonzero(surface.nodes >= 0)
    order = np.argsort(surface.nodes[facet, local], kind="stable")
    facet, local = facet[order], local[order]
    node = surface.nodes[facet, local]
    first, last = (np.searchsorted(node, points, side) for side in ("left", "right"))
    pair = np.repeat(np.arange(len(points)), last - first)
    visit = np.arange(len(pair)) - np.repeat(np.cumsum(last - first) - (last - first), last - first) + first[pair]
    facet, local = facet[visit], local[visit]
    along = np.einsum("vka,va->vk", normals[facet], directions[pair])
    own = along[np.arange(len(pair)), local]
    along *= np.where(own < 0.0, -1.0, 1.0)[:, None]
    others = surface.nodes[facet] >= 0
    least = np.where(others, along, np.inf).min(axis=1)
    most = np.where(others, along, -np.inf).max(axis=1)
    others[np.arange(len(pair)), local] = False
    lean, turn, farther = np.zeros((3, len(points)))
    np.maximum.at(lean, pair, np.abs(own))
    np.maximum.at(turn, pair, most - least)
    np.maximum.at(farther, pair, np.where(others, along, -np.inf).max(axis=1))
    on = (lean <= UPRIGHT) | ((lean <= LEAN * turn) & (lean <= LESS * farther))
    mirrors = _mirrors(points[on], directions[on])
    return mirrors.straightened(surface, normals), mirrors


def _planes(surface: Surface, held: Held | None) -> tuple[NDArray[np.int64], Array]:
    """Points (n,) of a surface and unit normals (n, dim) of planes that hold them, each once."""
    if held is None:
        return np.zeros(0, dtype=np.int64), np.zeros((0, surface.dim))
    on = np.isin(held.points, surface.node_ids)
    points, directions = held.points[on], held.directions[on]
    largest = directions[np.arange(len(points)), np.abs(directions).argmax(axis=1)]
    directions = directions * np.sign(largest)[:, None]
    key = np.column_stack([points, np.round(directions / SAME)])
    _, index = np.unique(key, axis=0, return_index=True)
    return points[index], directions[index]


def _mirrors(points: NDArray[np.int64], directions: Array) -> _Mirrors:
    ids, at = np.unique(points, return_inverse=True)
    gram = np.zeros((len(ids), directions.shape[1], directions.shape[1]))
    np.add.at(gram, at, directions[:, :, None] * directions[:, None, :])
    size, axes = np.linalg.eigh(gram)
    free = (size < SAME).astype(float)
    return _Mirrors(ids, np.einsum("nab,nb,ncb->nac", axes, free, axes))
