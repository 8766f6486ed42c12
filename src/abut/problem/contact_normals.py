"""The normals of a contact where supports have a say: at planes of symmetry they lie in these."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut.contact.bulge import Held
from abut.contact.common_normals import common_normals
from abut.contact.coupling import Couple
from abut.contact.geometry import (
    OnPlanes,
    Smoothing,
    facet_sizes,
    nodal_normals,
    smoothing,
    split_at_creases,
    turning_within,
)
from abut.contact.turned_images import extended, used_sides
from abut.errors import InputError
from abut.mesh.surface import Surface
from abut.model import Model
from abut.model.symmetry import held_directions

Array = NDArray[np.float64]
SEEN = 2  # rings of facets around a contactor whose own normals decide those at its nodes
LEAN = (
    3.0  # of a normal out of a plane of symmetry, over the angle by which its facet turns that way: 1 on round surfaces
)
LESS = 1.2  # of it over those farther away, which lean more; alike in the corner of a ball
HARDLY = 0.1  # of it over that angle, from which down it is the error of a curved facet's own normal, to either side
UPRIGHT = 1e-9  # lean that is rounding
SAME = 1e-6  # directions that differ by less are one
BEYOND = (
    1e-3  # of its size: how far a facet may reach beyond a plane of symmetry, as meshes are written with few digits
)
CLAMPED = 0.5  # length of the part of a normal along which its point may move, below which it is held


def contact_normals(
    model: Model, contactor: Surface, target: Surface, share: float, reach: float, couple: Couple
) -> Array:
    """As ``common_normals``; at nodes that supports hold beside them, as at a plane of symmetry, they lie in the directions
    that are left. Beyond the sides of a sector both go on, turned."""
    held = held_directions(model.mesh, model.supports)
    if used_sides(contactor) is None and used_sides(target) is None:
        return _between((contactor, held), (target, held), share, reach, couple)
    mine = extended(contactor, SEEN)
    opposite = extended(target, 1 + math.ceil(float(SEEN * facet_sizes(contactor).max() / facet_sizes(target).min())))
    one, other = ((more.surface, None if held is None else held.turned(more)) for more in (mine, opposite))
    return _between(one, other, share, reach, couple)[: len(contactor)]


def _between(
    mine: tuple[Surface, Held | None], opposite: tuple[Surface, Held | None], share: float, reach: float, couple: Couple
) -> Array:
    """The same of surfaces as they are, contactor and target, each with the points of it that supports hold."""
    (contactor, held), (target, of_target) = mine, opposite
    outward, mirrors = _upright(contactor, held)
    try:
        other, _ = _upright(target, of_target)
    except InputError:  # a facet without a normal at a node: the contactor may still see the others
        return outward
    normals = common_normals(contactor, target, outward, other, share, reach, couple)
    return mirrors.straightened(contactor, normals)


def moving_smoothing(surface: Surface, held: Held | None) -> Smoothing:
    """Where the normals of a surface that moves are averaged, as at the outset, and where they stay in planes of symmetry:
    those that are put into them at small displacements, and those that lie in them already, but for clamped points, at
    which a surface ends, however it turns beside them. Raises InputError as ``smoothing``."""
    across = smoothing(surface)
    normals = nodal_normals(surface, across)
    mirrors = _mirrors_of(surface, normals, held)
    if not len(mirrors.points):
        return across
    at = mirrors.leaning(surface, normals)
    moves = np.einsum("vab,vb->va", mirrors.free[at.point], normals[at.facet, at.local])
    kept = (at.lean > UPRIGHT) | (np.linalg.norm(moves, axis=1) > CLAMPED)
    visit = np.cumsum(surface.nodes.ravel() >= 0) - 1
    visits = visit.reshape(surface.nodes.shape)[at.facet[kept], at.local[kept]]
    return replace(across, planes=OnPlanes(visits, mirrors.projection[at.point[kept]]))


@dataclass(frozen=True)
class _Leaning:
    """Nodes of facets at planes of symmetry: facet, local number and point among ``_Mirrors.points``, (n,); inside:
    (n, dim) what of their normals lies in the planes; lean: (n,) the length of what does not."""

    facet: NDArray[np.int64]
    local: NDArray[np.int64]
    point: NDArray[np.int64]
    inside: Array
    lean: Array


@dataclass(frozen=True)
class _Mirrors:
    """Points (n,) on planes of symmetry, sorted, of a surface that is split at its creases, projections (n, dim, dim) on
    what lies in the planes, and on the directions in which the points are free; nodes: (n_facets, 9) of the split
    surface."""

    points: NDArray[np.int64]
    projection: Array
    free: Array
    nodes: NDArray[np.int32]

    def leaning(self, surface: Surface, normals: Array) -> _Leaning:
        """Of normals (n_facets, 9, dim) of the surface those that belong into the planes: not those which lean by more than
        ``LEAN`` times the angle by which their facets turn, or would have to turn by more than 60 degrees."""
        facet, local = np.nonzero(self.nodes >= 0)
        node = self.nodes[facet, local]
        at = np.minimum(np.searchsorted(self.points, node), len(self.points) - 1)
        here = self.points[at] == node
        facet, local, at = facet[here], local[here], at[here]
        inside = np.einsum("vab,vb->va", self.projection[at], normals[facet, local])
        lean, length = np.linalg.norm(normals[facet, local] - inside, axis=1), np.linalg.norm(inside, axis=1)
        turn = np.zeros(len(self.points))
        np.maximum.at(turn, at, turning_within(surface, normals)[facet])
        on = (lean <= np.maximum(LEAN * turn[at], UPRIGHT)) & (length > 0.5)
        return _Leaning(facet[on], local[on], at[on], inside[on], lean[on])

    def straightened(self, surface: Surface, normals: Array) -> Array:
        """Normals (n_facets, 9, dim) of the surface in the planes, where they belong there; as they are elsewhere, and where
        they are in them but for rounding."""
        if not len(self.points):
            return normals
        at = self.leaning(surface, normals)
        change = at.lean > UPRIGHT
        inside, result = at.inside[change], normals.copy()
        result[at.facet[change], at.local[change]] = inside / np.linalg.norm(inside, axis=1, keepdims=True)
        return result


def _upright(surface: Surface, held: Held | None) -> tuple[Array, _Mirrors]:
    """Nodal normals (n_facets, 9, dim), those at planes of symmetry in these."""
    normals = nodal_normals(surface)
    mirrors = _mirrors_of(surface, normals, held)
    return mirrors.straightened(surface, normals), mirrors


def _mirrors_of(surface: Surface, normals: Array, held: Held | None) -> _Mirrors:
    """The points of a surface on planes of symmetry. normals: nodal ones. There it ends: facets lie on one side of the plane
    alone. Normals lean out of it, and farther from it the more: by as much as a round surface turns across the plane. Other
    points that supports hold are left out: a cone does not turn along its axis, however its normals lean, and those of a
    crowned roller lean most on the planes that hold its ends."""
    split, owner = split_at_creases(surface)
    points, directions = _planes(split, owner, held)
    if not len(points):
        none = np.zeros((0, surface.dim, surface.dim))
        return _Mirrors(points, none, none, split.nodes)
    facet, local = np.nonzero(split.nodes >= 0)
    order = np.argsort(split.nodes[facet, local], kind="stable")
    facet, local = facet[order], local[order]
    node = split.nodes[facet, local]
    first, last = (np.searchsorted(node, points, side) for side in ("left", "right"))
    pair = np.repeat(np.arange(len(points)), last - first)
    visit = np.arange(len(pair)) - np.repeat(np.cumsum(last - first) - (last - first), last - first) + first[pair]
    facet, local = facet[visit], local[visit]
    others = split.nodes[facet] >= 0
    along = np.einsum("vka,va->vk", normals[facet], directions[pair])
    own = along[np.arange(len(pair)), local]
    along *= np.where(own < 0.0, -1.0, 1.0)[:, None]
    least = np.where(others, along, np.inf).min(axis=1)
    most = np.where(others, along, -np.inf).max(axis=1)
    away = split.points[np.maximum(split.nodes[facet], 0)] - split.points[points[pair]][:, None]
    away = np.where(others, np.einsum("vka,va->vk", away, directions[pair]), 0.0) / facet_sizes(split)[facet][:, None]
    others[np.arange(len(pair)), local] = False
    lean, turn, farther, above, below = np.zeros((5, len(points)))
    np.maximum.at(lean, pair, np.abs(own))
    np.maximum.at(turn, pair, most - least)
    np.maximum.at(farther, pair, np.where(others, along, -np.inf).max(axis=1))
    np.maximum.at(above, pair, away.max(axis=1))
    np.maximum.at(below, pair, -away.min(axis=1))
    on = (lean <= np.maximum(HARDLY * turn, UPRIGHT)) | ((lean <= LEAN * turn) & (lean <= LESS * farther))
    on &= np.minimum(above, below) <= BEYOND
    ids, projection = _left(points[on], directions[on])
    every, free = _left(points, directions)
    return _Mirrors(ids, projection, free[np.searchsorted(every, ids)], split.nodes)


def _planes(split: Surface, owner: NDArray[np.int64], held: Held | None) -> tuple[NDArray[np.int64], Array]:
    """Points (n,), sorted, of a surface that is split at its creases, and unit normals (n, dim) of planes that hold them,
    each once. owner: as from ``split_at_creases``."""
    if held is None:
        return np.zeros(0, dtype=np.int64), np.zeros((0, split.dim))
    used = split.node_ids
    on = np.isin(held.points, owner[used])
    points, directions = held.points[on], held.directions[on]
    largest = directions[np.arange(len(points)), np.abs(directions).argmax(axis=1)]
    directions = directions * np.sign(largest)[:, None]
    key = np.column_stack([points, np.round(directions / SAME)])
    _, index = np.unique(key, axis=0, return_index=True)
    number, directions = Held(points[index], directions[index]).at(owner[used])
    return used[number].astype(np.int64), directions


def _left(points: NDArray[np.int64], directions: Array) -> tuple[NDArray[np.int64], Array]:
    """The points (n,) once, sorted, and projections (n, dim, dim) on what their directions leave."""
    ids, at = np.unique(points, return_inverse=True)
    gram = np.zeros((len(ids), directions.shape[1], directions.shape[1]))
    np.add.at(gram, at, directions[:, :, None] * directions[:, None, :])
    size, axes = np.linalg.eigh(gram)
    free = (size < SAME).astype(float)
    return ids, np.einsum("nab,nb,ncb->nac", axes, free, axes)
