"""Bodies that lie in each other: points of one behind the outside of another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from abut.cells import CELLS
from abut.mesh.exterior import exterior
from abut.mesh.mesh import Mesh
from abut.mesh.surface import Surface

NEAREST = 4  # pieces of facets by their middles, among which the nearest one is looked for
DEEP = 0.1  # of a facet's size: less is what chords of round bodies do
INSIDE = 1e-9  # barycentric coordinate

Array = NDArray[np.float64]
Rows = NDArray[np.int64]
Joined = tuple[Rows, Rows]  # rows (cell, local facet) of two sides, (n, 2) each


@dataclass(frozen=True)
class Passing:
    """bodies: of which the first has points inside the second; depth: of the deepest one, a length; share: that over the
    size of
    the facet that it has passed; place: (dim,) where it is."""

    bodies: tuple[str, str]
    depth: float
    share: float
    place: Array


@dataclass(frozen=True)
class _Outside:
    """The outside of all bodies in pieces (2D: segments, 3D: triangles). corners: (n, dim) point numbers; key, body: (n,) of
    the facet, as from ``_keys``, and of its body; size: (n,) a length."""

    corners: Rows
    key: Rows
    body: Rows
    size: Array


def passing(mesh: Mesh, points: Array, joined: Sequence[Joined]) -> tuple[Passing, ...]:
    """Bodies that lie in each other by more than a part of a facet, the deepest first, each pair of bodies once.

    points: (n_points, dim) where they are; joined: sides that contacts or ties keep apart or together, which do not
    count."""
    outside = _outside(mesh, points)
    sides = [(_keys(one), _keys(other)) for one, other in joined]
    names = list(mesh.bodies)
    boxes = [_box(points[outside.corners[outside.body == b]].reshape(-1, mesh.dim)) for b in range(len(names))]
    found: dict[frozenset[int], Passing] = {}
    for a, b in permutations(range(len(names)), 2):
        low, high = np.maximum(boxes[a][0], boxes[b][0]), np.minimum(boxes[a][1], boxes[b][1])
        if (low >= high).any():
            continue
        one = _deepest(outside, points, a, b, (low, high), sides)
        if one is not None and (frozenset((a, b)) not in found or one[1] > found[frozenset((a, b))].share):
            depth, share, node = one
            found[frozenset((a, b))] = Passing((names[a], names[b]), depth, share, points[node].copy())
    return tuple(sorted(found.values(), key=lambda item: -item.share))


def _keys(rows: Rows) -> Rows:
    return np.asarray(8 * rows[:, 0] + rows[:, 1])  # no cell has more than 8 facets


def _box(points: Array) -> tuple[Array, Array]:
    if not len(points):
        none = np.zeros(points.shape[1])
        return none, none
    return points.min(axis=0), points.max(axis=0)


def _outside(mesh: Mesh, points: Array) -> _Outside:
    rows = exterior(mesh)
    surface = mesh.facets(rows)
    owner = np.full(mesh.n_cells, -1)
    for number, cells in enumerate(mesh.bodies.values()):
        owner[cells] = number
    facets, corners = _pieces(surface)
    x = points[corners]
    size = (x.max(axis=1) - x.min(axis=1)).max(axis=1)
    return _Outside(corners, _keys(rows)[facets], owner[rows[facets, 0]], size)


def _pieces(surface: Surface) -> tuple[Rows, Rows]:
    """Number of the facet, (n,), and corners, (n, dim), of the segments or triangles that facets are made of."""
    facets, corners = [], []
    for code in np.unique(surface.kinds):
        kind = next(cell for cell in CELLS.values() if cell.code == code)
        here = np.flatnonzero(surface.kinds == code)
        fans = ((0, 1),) if kind.corners == 2 else ((0, 1, 2),) if kind.corners == 3 else ((0, 1, 2), (0, 2, 3))
        for fan in fans:
            facets.append(here)
            corners.append(surface.nodes[here][:, fan].astype(np.int64))
    return np.concatenate(facets), np.concatenate(corners)


def _deepest(
    outside: _Outside, points: Array, a: int, b: int, box: tuple[Array, Array], sides: Sequence[tuple[Rows, Rows]]
) -> tuple[float, float, int] | None:
    """Depth, over the facet's size, and number of the point of body ``a`` that is deepest in ``b``, of those in a box;
    None where
    none is deep enough."""
    mine, theirs = (np.flatnonzero(outside.body == body) for body in (a, b))
    nodes = np.unique(outside.corners[mine])
    nodes = nodes[((points[nodes] >= box[0]) & (points[nodes] <= box[1])).all(axis=1)]
    x = points[outside.corners[theirs]]
    near = ((x.max(axis=1) >= box[0]) & (x.min(axis=1) <= box[1])).all(axis=1)
    theirs, x = theirs[near], x[near]
    if not len(nodes) or not len(theirs):
        return None
    _, nearest = cKDTree(x.mean(axis=1)).query(points[nodes], k=min(NEAREST, len(theirs)))
    nearest = nearest.reshape(len(nodes), -1)
    away, depth = _distance(points[nodes][:, None], x[nearest])
    best = np.argmin(away, axis=1)
    every = np.arange(len(nodes))
    piece, depth = theirs[nearest[every, best]], depth[every, best]
    share = np.where(np.isfinite(depth), depth, 0.0) / outside.size[piece]
    share[_joined(outside, nodes, piece, mine, sides)] = 0.0
    deepest = int(np.argmax(share))
    return None if share[deepest] <= DEEP else (float(depth[deepest]), float(share[deepest]), int(nodes[deepest]))


def _joined(
    outside: _Outside, nodes: Rows, piece: Rows, mine: Rows, sides: Sequence[tuple[Rows, Rows]]
) -> NDArray[np.bool_]:
    """Points and the pieces nearest to them, (n,) each, that are on the two sides of one contact; mine: pieces of the
    points' body."""
    result = np.zeros(len(nodes), dtype=bool)
    for one, other in sides:
        for own, opposite in ((one, other), (other, one)):
            on = np.unique(outside.corners[mine][np.isin(outside.key[mine], own)])
            result |= np.isin(nodes, on) & np.isin(outside.key[piece], opposite)
    return result


def _distance(x: Array, corners: Array) -> tuple[Array, Array]:
    """Distance of points (n, 1, dim) from segments or triangles (n, k, dim, dim), and depth behind them, NaN beside them."""
    first, rest = corners[:, :, 0], corners[:, :, 1:] - corners[:, :, :1]
    along = _coordinates(x - first, rest)
    inside = (along > -INSIDE).all(axis=-1) & (along.sum(axis=-1) < 1.0 + INSIDE)
    clipped = np.clip(along, 0.0, 1.0)
    clipped = clipped / np.maximum(clipped.sum(axis=-1, keepdims=True), 1.0)
    gap = x - first - np.einsum("nka,nkad->nkd", clipped, rest)
    normal = np.stack([rest[:, :, 0, 1], -rest[:, :, 0, 0]], axis=-1) if rest.shape[-1] == 2 else np.cross(
        rest[:, :, 0], rest[:, :, 1]
    )  # fmt: skip
    height = (gap * normal).sum(axis=-1) / np.maximum(np.linalg.norm(normal, axis=-1), 1e-300)
    return np.linalg.norm(gap, axis=-1), np.where(inside, -height, np.nan)


def _coordinates(x: Array, rest: Array) -> Array:
    """Along the edges (n, k, dim - 1, dim) of the foot of x (n, k, dim) in their plane."""
    size, reach = (rest**2).sum(axis=-1), np.einsum("nkad,nkd->nka", rest, x)
    if rest.shape[2] == 1:
        return np.asarray(reach / np.maximum(size, 1e-300))
    both = (rest[:, :, 0] * rest[:, :, 1]).sum(axis=-1)
    area = np.maximum(size[..., 0] * size[..., 1] - both**2, 1e-300)
    first = (size[..., 1] * reach[..., 0] - both * reach[..., 1]) / area
    other = (size[..., 0] * reach[..., 1] - both * reach[..., 0]) / area
    return np.stack([first, other], axis=-1)
