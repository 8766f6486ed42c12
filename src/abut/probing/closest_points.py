"""Closest-point projection onto a surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from abut._core import shape_functions
from abut.cells import CELLS, MAX_FACET_NODES
from abut.contact.geometry import by_kind, facet_sizes
from abut.mesh.facets import corner_keys, row_codes
from abut.mesh.surface import Surface
from abut.probing.cells import BULGE, INSIDE, NEAR
from abut.probing.inverse import nearest

ON_SIDE = 1e-9  # in reference coordinates
ONE_PLACE = 1e-6  # feet on neighbouring facets nearer than that, over a facet's size, are one

# Sides of the reference facet: corners, direction out of the facet, level along that, the side's own direction.
_Side = tuple[tuple[int, ...], tuple[float, ...], float, tuple[float, ...]]
_LINE: tuple[_Side, ...] = (((0,), (-1.0,), 1.0, (0.0,)), ((1,), (1.0,), 1.0, (0.0,)))
_TRIANGLE: tuple[_Side, ...] = (
    ((0, 1), (0.0, -1.0), 0.0, (1.0, 0.0)),
    ((1, 2), (1.0, 1.0), 1.0, (-1.0, 1.0)),
    ((2, 0), (-1.0, 0.0), 0.0, (0.0, -1.0)),
)
_SQUARE: tuple[_Side, ...] = (
    ((0, 1), (0.0, -1.0), 1.0, (1.0, 0.0)),
    ((1, 2), (1.0, 0.0), 1.0, (0.0, 1.0)),
    ((2, 3), (0.0, 1.0), 1.0, (-1.0, 0.0)),
    ((3, 0), (-1.0, 0.0), 1.0, (0.0, -1.0)),
)


@dataclass(frozen=True)
class Feet:
    """Nearest points of a surface to n points. point, facet: (k,) numbers of points that have a foot, with the facets it is
    on, several where it is on their common edge; weights: (k, 9) shape functions of the facet there; distance: (n,) to the
    nearest point of the surface, length; beside: (n,) bool, beyond the surface's rim; touching: (n,) bool, on the surface.
    """

    point: NDArray[np.int64]
    facet: NDArray[np.int64]
    weights: NDArray[np.float64]
    distance: NDArray[np.float64]
    beside: NDArray[np.bool_]
    touching: NDArray[np.bool_]


def feet(surface: Surface, points: NDArray[np.float64]) -> Feet:
    """Feet of points (n, dim) on a surface that has facets."""
    facet, point = _candidates(surface, points)
    size = facet_sizes(surface)[facet]
    weights = np.zeros((len(facet), MAX_FACET_NODES))
    miss = np.zeros((len(facet), surface.dim))
    beyond = np.zeros(len(facet), dtype=bool)
    rim = _rim(surface)
    for kind, _ in by_kind(surface):
        cell = CELLS[kind]
        here = np.flatnonzero(surface.kinds[facet] == cell.code)
        x = surface.points[surface.nodes[facet[here], : cell.nodes]]
        xi, way = nearest(kind, x, points[point[here]])
        shapes, slopes = shape_functions(cell.code, np.ascontiguousarray(xi))
        weights[here, : cell.nodes], miss[here] = shapes, way
        tangents = np.einsum("mna,mnd->mad", slopes, x)
        beyond[here] = _past(kind, rim[facet[here]], xi, tangents, way, size[here])
    away = np.linalg.norm(miss, axis=1)
    order = np.lexsort((facet, away, point))
    best = order[np.unique(point[order], return_index=True)[1]]  # of each point, in their order
    same = np.linalg.norm(miss - miss[best[point]], axis=1) <= ONE_PLACE * size
    beside = beyond[best]
    kept = same & ~beside[point]
    near = away[best] <= NEAR * size[best]
    return Feet(point[kept], facet[kept], weights[kept], away[best], beside, near & ~beside)


def _candidates(surface: Surface, points: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Facets and points: all facets whose boxes are no farther from a point than the nearest node is."""
    x = surface.points[np.maximum(surface.nodes, 0)]
    padded = (surface.nodes < 0)[..., None]
    low, high = np.where(padded, np.inf, x).min(axis=1), np.where(padded, -np.inf, x).max(axis=1)
    more = BULGE * (high - low).max(axis=1, keepdims=True)
    low, high = low - more, high + more
    reach, _ = cKDTree(surface.points[surface.node_ids]).query(points)
    found = []
    for point, most in zip(points, reach * (1.0 + INSIDE)):
        gap = np.maximum(np.maximum(low - point, point - high), 0.0)
        found.append(np.flatnonzero(np.einsum("fd,fd->f", gap, gap) <= most**2))
    counts = [len(facets) for facets in found]
    return np.concatenate(found), np.repeat(np.arange(len(points)), counts)


def _sides(kind: str) -> tuple[_Side, ...]:
    cell = CELLS[kind]
    return _LINE if cell.dim == 1 else _TRIANGLE if cell.corners == 3 else _SQUARE


def _rim(surface: Surface) -> NDArray[np.bool_]:
    """Sides of facets that no other facet of the surface has, (n_facets, 4)."""
    keys, places = [], []
    for kind, facets in by_kind(surface):
        for number, (corners, *_) in enumerate(_sides(kind)):
            keys.append(corner_keys(surface.nodes[facets][:, list(corners)].astype(np.int64)))
            places.append(np.stack([facets, np.full(len(facets), number)], axis=1))
    _, inverse, count = np.unique(row_codes(np.concatenate(keys)), return_inverse=True, return_counts=True)
    facet, side = np.concatenate(places)[count[inverse] == 1].T
    result = np.zeros((len(surface), 4), dtype=bool)
    result[facet, side] = True
    return result


def _past(
    kind: str,
    rim: NDArray[np.bool_],
    xi: NDArray[np.float64],
    tangents: NDArray[np.float64],
    way: NDArray[np.float64],
    size: NDArray[np.float64],
) -> NDArray[np.bool_]:
    """Whether points lie beyond the rim: ``way`` (m, dim) leads to them from the facet's points xi, outwards across a side
    that belongs to the rim."""
    result = np.zeros(len(xi), dtype=bool)
    for number, (_, out, level, along) in enumerate(_sides(kind)):
        across = np.einsum("a,mad->md", np.array(out), tangents)
        edge = np.einsum("a,mad->md", np.array(along), tangents)
        share = np.einsum("md,md->m", across, edge) / np.maximum(np.einsum("md,md->m", edge, edge), 1e-300)
        across = across - share[:, None] * edge
        across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-300)
        on_side = xi @ np.array(out) >= level - ON_SIDE
        result |= rim[:, number] & on_side & (np.einsum("md,md->m", across, way) > NEAR * size)
    return result
