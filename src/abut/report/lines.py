"""Pressure and gap along a line on a contactor: in 2D the contactor itself, in 3D cuts through the largest pressure."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from abut.report.surface_triangles import Patch, patch
from abut.solution import ContactResult

NOTHING = 1e-3  # pressures below this share of the largest count as none: the constraint function is never quite zero
SHORT = 0.1  # lines shorter than this share of the longest are not worth a picture
AROUND = 0.35  # how far a line goes on beyond the pressed part, as a share of that part's length
EVEN = 0.9  # a pressed part nearly as long in every direction is cut along an axis of coordinates
STRAIGHT = np.cos(np.deg2rad(10.0))  # and so is one that lies along such an axis but for this angle
OFF = 1e-3  # cuts pass beside the node of largest pressure, as a share of the way to the middle of the pressed part


@dataclass(frozen=True)
class Line:
    """points (n, dim), distance along them (n,) with 0 at the largest pressure, pressure and gap (n,); with friction the
    size of the tangential traction and its limit (n,), the coefficient times the pressure.

    Two points in one place with different pressures are a jump between facets; gap is NaN where nothing lies opposite.
    """

    label: str
    points: NDArray[np.float64]
    distance: NDArray[np.float64]
    pressure: NDArray[np.float64]
    gap: NDArray[np.float64]
    traction: NDArray[np.float64] | None = None
    limit: NDArray[np.float64] | None = None

    @property
    def opening(self) -> NDArray[np.float64]:
        """The gap, or NaN all along where it is rounding."""
        some = np.nanmax(np.nan_to_num(np.abs(self.gap)), initial=0.0) > 1e-9 * np.ptp(self.distance)
        return self.gap if some else np.full_like(self.gap, np.nan)

    def distance_from(self, point: NDArray[np.float64]) -> NDArray[np.float64]:
        """Distance along the line with 0 where the line passes nearest to ``point``."""
        a, b = self.points[:-1], self.points[1:]
        way = b - a
        share = np.einsum("ij,ij->i", point - a, way) / np.maximum(np.einsum("ij,ij->i", way, way), 1e-300)
        foot = a + np.clip(share, 0.0, 1.0)[:, None] * way
        k = int(np.argmin(np.linalg.norm(foot - point, axis=1)))
        return self.distance - self.distance[k] - np.linalg.norm(foot[k] - a[k])


def pressure_lines(contact: ContactResult) -> tuple[Line, ...]:
    """Lines on the contactor: one in 2D, in 3D those along and across the longest extent of the pressed part.

    None where nothing is pressed."""
    grid = patch(contact.contactor, 8 if contact.contactor.dim == 2 else 4)
    nodal = [contact.pressure, contact.gap]
    if contact.friction is not None:
        limit = contact.friction.traction_limit
        nodal += [np.linalg.norm(contact.friction.traction, axis=2), np.where(np.isfinite(limit), limit, np.nan)]
    values = np.column_stack([grid.nodal(field) for field in nodal])
    pressure = values[:, 0]
    if not len(grid) or not np.isfinite(contact.statistics.place).all():
        return ()
    x, size = grid.points, float(np.ptp(grid.points, axis=0).max())
    away = np.linalg.norm(x - contact.statistics.place, axis=1)
    here = np.flatnonzero(away <= away.min() + 1e-9 * size)
    top = int(here[np.argmax(pressure[here])])
    if x.shape[1] == 2:
        cuts = [("along the contactor", grid.cells, np.stack([np.arange(len(x))] * 2, axis=1), np.zeros(len(x)))]
    else:
        cuts = [(label, *_cut(grid, x, normal, size)) for label, normal in _planes(grid, x, pressure, top)]
    lines = []
    for label, segments, ends, share in cuts:
        at, along = (_between(field, ends, share) for field in (x, values))
        line = _walk(label, segments, at, along, x[top], 1e-9 * size)
        if line is not None:
            lines.append(line)
    lengths = [float(np.ptp(line.distance)) for line in lines]
    return tuple(line for line, length in zip(lines, lengths) if length > SHORT * max(lengths))


def _planes(
    grid: Patch, x: NDArray[np.float64], pressure: NDArray[np.float64], top: int
) -> list[tuple[str, NDArray[np.float64]]]:
    """Planes (unit normal, constant) of the two cuts through the largest pressure: their directions are the principal ones
    of the pressed part, in the tangent plane."""
    normal = grid.normals[top]
    triangle = x[grid.cells]
    area = 0.5 * np.linalg.norm(np.cross(triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0]), axis=1)
    weight = area * np.maximum(pressure[grid.cells].mean(axis=1), 0.0)
    way = triangle.mean(axis=1) - x[top]
    flat = way - weight @ way / weight.sum()
    flat -= (flat @ normal)[:, None] * normal
    moments = np.einsum("t,ta,tb->ab", weight, flat, flat) / weight.sum()
    values, axes = np.linalg.eigh(moments - moments.trace() * np.outer(normal, normal))  # the normal comes first
    along = np.eye(3)[np.argmin(np.abs(normal))] if values[1] > EVEN * values[2] else axes[:, 2]
    nearest = int(np.argmax(np.abs(along)))
    if abs(along[nearest]) > STRAIGHT:
        along = np.eye(3)[nearest]
    along = along - (along @ normal) * normal
    along /= np.linalg.norm(along)
    across = np.cross(normal, along)
    through = x[top] + OFF * (weight @ way) / weight.sum()
    planes = ((along, across), (across, along))
    return [(f"along {_direction(way)}", np.append(normal, -(normal @ through))) for way, normal in planes]


def _direction(way: NDArray[np.float64]) -> str:
    way = way * np.sign(way[np.argmax(np.abs(way))])
    for axis in range(3):
        if abs(way[axis]) > 1.0 - 1e-6:
            return "xyz"[axis]
    return "(" + ", ".join(f"{value:.2f}".replace("-0.00", "0.00") for value in way) + ")"


def _cut(
    grid: Patch, x: NDArray[np.float64], plane: NDArray[np.float64], size: float
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
    """Triangles cut by a plane: segments (m, 2) between cut points, each on an edge (n, 2) at a share (n,) of its length."""
    height = x @ plane[:3] + plane[3]
    above = np.where(np.abs(height) < 1e-9 * size, 0.0, height) >= 0.0
    sides = above[grid.cells]
    cut = grid.cells[sides.any(axis=1) & ~sides.all(axis=1)]
    edges = cut[:, [[0, 1], [1, 2], [2, 0]]]
    crossed = above[edges[..., 0]] != above[edges[..., 1]]
    ends = edges[crossed]  # two of each triangle, one after the other
    share = height[ends[:, 0]] / (height[ends[:, 0]] - height[ends[:, 1]])
    return np.arange(len(ends)).reshape(-1, 2), ends, share


def _between(values: NDArray[np.float64], ends: NDArray[np.int64], share: NDArray[np.float64]) -> NDArray[np.float64]:
    t = share.reshape(-1, *[1] * (values.ndim - 1))
    return (1.0 - t) * values[ends[:, 0]] + t * values[ends[:, 1]]


def _walk(
    label: str,
    segments: NDArray[np.int64],
    x: NDArray[np.float64],
    values: NDArray[np.float64],
    start: NDArray[np.float64],
    near: float,
) -> Line | None:
    """Join segments end to end, both ways from the one nearest to ``start``, and keep the pressed part with some more;
    values: (n, 2 or 4) pressure, gap, traction and its limit at the points x (n, dim)."""
    if not len(segments):
        return None
    way = _chain(segments, _places(x, near), int(np.argmin(np.linalg.norm(x[segments].mean(axis=1) - start, axis=1))))
    span = x[way[-1]] - x[way[0]]
    if span[np.argmax(np.abs(span))] < 0.0:
        way = way[::-1]
    at, p = x[way], np.nan_to_num(values[way, 0])
    distance = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(at, axis=0), axis=1))])
    distance -= distance[np.argmax(p)]
    pressed = distance[p > NOTHING * p.max(initial=0.0)]
    if not np.ptp(pressed if len(pressed) else [0.0]) > 0.0:
        return None
    more = AROUND * float(np.ptp(pressed))
    kept = (distance >= pressed.min() - more) & (distance <= pressed.max() + more)
    return Line(label, at[kept], distance[kept], p[kept], *values[way][kept].T[1:])


def _places(x: NDArray[np.float64], near: float) -> NDArray[np.int64]:
    """A number for each place: the same for points nearer than ``near``."""
    pairs = cKDTree(x).query_pairs(near, output_type="ndarray")
    graph = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(x), len(x)))
    return np.asarray(connected_components(graph, directed=False)[1])


def _chain(segments: NDArray[np.int64], place: NDArray[np.int64], first: int) -> NDArray[np.int64]:
    """The ends of segments in the order of a walk over them, both ways from segment ``first``."""
    here: dict[int, list[tuple[int, int, int]]] = {}  # place -> segments (number, end there, other end)
    for number, (a, b) in enumerate(segments.tolist()):
        here.setdefault(int(place[a]), []).append((number, a, b))
        here.setdefault(int(place[b]), []).append((number, b, a))
    order, seen = deque(segments[first].tolist()), {first}
    for tip, extend in ((-1, order.extend), (0, order.extendleft)):
        while True:
            following = next((s for s in here[int(place[order[tip]])] if s[0] not in seen), None)
            if following is None:
                break
            seen.add(following[0])
            extend(following[1:])
    return np.array(order, dtype=np.int64)
