"""Where points touch that were apart in the last converged state: from there their slip counts, theory (G20)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.cells import MAX_FACET_NODES
from abut.contact.bulge import bulge_at
from abut.contact.geometry import facet_sizes
from abut.contact.slip_points import SlipPoints
from abut.mesh.surface import Surface

ROLLING = 1.0 / 3.0  # share of a round contactor's normal in the way on which it and a flat target come together
FLAT = 1e-9  # turn of the normal over a facet that is none
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Sides:
    """Both surfaces at one place, and their nodal normals out of them, (n_facets, 9, dim)."""

    contactor: Surface
    target: Surface
    normals: Array
    target_normals: Array


def apart(points: SlipPoints, sides: Sides) -> Array:
    """Weighted slips at which points close that are apart, facet by facet as in ``slip_now``: (9 n_facets, c), c = 1 in 2D
    and 3 in 3D. As in theory (G20)."""
    own, other = points.facet, points.target_facet
    across = -_unit(_interpolated(points.own, sides.normals[own]))
    facing = _unit(_interpolated(points.other, sides.target_normals[other]))
    between = _at(sides.contactor, own, points.own) - _at(sides.target, other, points.other)
    over = bulge_at(sides.contactor, own, points.own) + bulge_at(sides.target, other, points.other)
    between = between - over[:, None] * across
    bends, target_bends = _bend(sides.contactor, sides.normals)[own], _bend(sides.target, sides.target_normals)[other]
    share = (ROLLING * (bends + 2.0 * target_bends) / (bends + target_bends))[:, None]
    moved = _turned_along(between, _unit(share * across + (1.0 - share) * facing), across)
    if sides.contactor.dim == 2:
        moved = (across[:, 0] * moved[:, 1] - across[:, 1] * moved[:, 0])[:, None]
    else:
        moved = moved - np.einsum("nd,nd->n", across, moved)[:, None] * across
    result = np.zeros((len(sides.contactor), MAX_FACET_NODES, moved.shape[1]))
    np.add.at(result, own, (points.weight[:, None] * points.pressure)[..., None] * moved[:, None])
    return result.reshape(-1, moved.shape[1])


def _bend(surface: Surface, normals: Array) -> Array:
    """How much the normal turns along each facet, per length, (n_facets,)."""
    points, used = surface.points[np.maximum(surface.nodes, 0)], surface.nodes >= 0
    result = np.zeros(len(surface))
    for k in range(MAX_FACET_NODES):
        way, turn = (np.linalg.norm(each - each[:, k : k + 1], axis=2) for each in (points, normals))
        along = np.where(used & used[:, k : k + 1] & (way > 0.0), turn / np.where(way > 0.0, way, 1.0), 0.0)
        result = np.maximum(result, along.max(axis=1))
    return np.asarray(result + FLAT / facet_sizes(surface))


def _turned_along(vectors: Array, start: Array, end: Array) -> Array:
    """Vectors turned as unit vectors ``start`` turn to ``end`` on the shortest way; all (n, dim)."""
    both = start + end
    cosine = np.einsum("nd,nd->n", start, end)
    share = np.einsum("nd,nd->n", both, vectors) / np.maximum(1.0 + cosine, 1e-12)
    return vectors - share[:, None] * both + 2.0 * np.einsum("nd,nd->n", start, vectors)[:, None] * end


def _interpolated(shapes: Array, values: Array) -> Array:
    """(n, 9) and (n, 9, dim) -> (n, dim)."""
    return np.asarray(np.einsum("nk,nkd->nd", shapes, values))


def _at(surface: Surface, facet: NDArray[np.int32], shapes: Array) -> Array:
    return _interpolated(shapes, surface.points[np.maximum(surface.nodes[facet], 0)])


def _unit(vectors: Array) -> Array:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(vectors / np.maximum(length, 1e-300))
