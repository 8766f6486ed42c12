"""Line meshes with a section as hex20: one over a rectangle or an ellipse, a ring of them over a box or a pipe.

The section at a node lies across the mean tangent of the elements there, as far as these are within 20 degrees of each other
and have the same section; others have a section of their own there, and the node is a knot, as for shells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.mesh.thin.shells import ALIKE, EQUAL

Numbers = NDArray[np.int64]
Vector = NDArray[np.float64]
CORNERS = np.array([[-1, 1], [-1, -1], [1, -1], [1, 1]]) / 2.0  # along n1 and n2, over the widths
POINTS = np.vstack(
    [CORNERS, (CORNERS + np.roll(CORNERS, -1, axis=0)) / 2.0]
)  # of a section: corners, edges between them
COUNT = len(POINTS)
AREA = 2.0 + 8.0 / 3.0 * (np.sqrt(2.0) - 1.0)  # of an ellipse of radius 1: a square and four segments of parabolas
EVEN = np.sqrt(np.pi / AREA)  # times the radius: the same area as the circle


def _round(sides: int) -> Vector:
    """Points (2 sides, 2) of a circle of diameter 1: corners, from that of the square on, then those between them."""
    angles = 2.0 * np.pi / sides * np.concatenate([np.arange(sides), np.arange(sides) + 0.5]) + 0.75 * np.pi
    return np.stack([np.cos(angles), np.sin(angles)], axis=1) / 2.0


OUTLINES = {"rectangle": POINTS, "ellipse": _round(4), "box": POINTS, "pipe": _round(8)}  # over the widths
HOLLOW = ("box", "pipe")
CURVED = ("ellipse", "pipe")
_START, _END, _MIDDLE = 0, 1, 2
_HEX20 = (  # (which node of the line, which point of its section)
    (_START, 0), (_END, 0), (_END, 1), (_START, 1), (_START, 3), (_END, 3), (_END, 2), (_START, 2),
    (_MIDDLE, 0), (_END, 4), (_MIDDLE, 1), (_START, 4), (_MIDDLE, 3), (_END, 6), (_MIDDLE, 2), (_START, 6),
    (_START, 7), (_END, 7), (_END, 5), (_START, 5),
)  # fmt: skip


@dataclass(frozen=True)
class Beam:
    """cells: (n, 3) rows of points: start, end, middle. Of each: axis (n, 3), near which the first direction n1 of the
    section lies; widths (n, 2), or (n, 3, 2) at its nodes, along n1 and n2 = tangent x n1 [length]; offsets (n, 2) of the
    nodes from the centre, over these; walls (n, 4) of hollow ones at the sides -n1, -n2, n1, n2 [length], of a pipe all
    alike. form: a name in ``OUTLINES``. Every node of round ones lies on the circle or ellipse, between the nodes there are
    parabolas: the area of an ellipse is 1.2 % smaller, its second moments are 2.3 %, those of a pipe, of eight cells, 0.1 %
    and 0.2 %."""

    cells: Numbers
    axis: Vector
    widths: Vector
    offsets: Vector
    walls: Vector
    form: str = "rectangle"


@dataclass(frozen=True)
class Sections:
    """points: (s m, 3), m for each section: corners, then the middles of sides, as in ``OUTLINES``; of hollow ones corners
    outside, corners inside, middles outside, inside, and between corners. node: (s,) which it stands on; cells: (n, c, 20)
    rows of ``points``, whose first face is an outer one of hollow sections, the second an inner one; shares: (s, m, k) of
    its (outer) corners in the motion of each of its points where the section stays one and strains evenly."""

    points: Vector
    node: Numbers
    cells: Numbers
    shares: Vector


def expand_beams(points: Vector, beam: Beam) -> Sections:
    """The solid cells of beams. points: (n, 3). Raises ValueError for an element without a length, or along its axis: its
    argument is the number of the cell."""
    start, end, middle = (points[beam.cells[:, i]] for i in range(3))
    tangents = np.stack(
        [4 * middle - 3 * start - end, 3 * end + start - 4 * middle, end - start], axis=1
    )  # at start, end, middle
    lengths = np.linalg.norm(tangents, axis=2)
    extent = np.abs(points[beam.cells]).max() + 1.0
    second = np.cross(tangents, beam.axis[:, None, :])
    sizes = np.linalg.norm(second, axis=2)
    short = (lengths < 1e-12 * extent) | (sizes < 1e-9 * lengths * np.linalg.norm(beam.axis, axis=1)[:, None])
    if short.any():
        raise ValueError(int(np.flatnonzero(short.any(axis=1))[0]))
    tangents, second = tangents / lengths[..., None], second / sizes[..., None]
    node = beam.cells.ravel()
    wide = beam.widths if beam.widths.ndim == 3 else beam.widths[:, None]
    wide, aside = np.broadcast_arrays(wide, beam.offsets[:, None] * wide, np.empty((len(beam.cells), 3, 2)))[:2]
    own = np.concatenate([wide, aside, np.repeat(beam.walls[:, None], 3, axis=1)], axis=2).reshape(3 * len(wide), -1)
    section, first = _sections(node, tangents.reshape(-1, 3), second.reshape(-1, 3), own)
    count = len(first)
    along, across = np.zeros((count, 3)), np.zeros((count, 3))
    np.add.at(along, section, tangents.reshape(-1, 3))
    np.add.at(across, section, second.reshape(-1, 3))
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    across -= (across * along).sum(axis=1, keepdims=True) * along
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    frame = np.stack([np.cross(across, along), across], axis=1)  # n1, n2
    widths, offsets, walls = own[first, None, :2], own[first, None, 2:4], own[first, None, 4:]
    place, quads = OUTLINES[beam.form] * widths, np.arange(COUNT)[None]
    corners = place.shape[1] // 2
    if beam.form in HOLLOW:
        outer, inner = (
            _box(widths, walls[:, 0]) if beam.form == "box" else (place, place * (1.0 - 2.0 * walls[..., :1] / widths))
        )
        corners = outer.shape[1] // 2
        place, quads = _hollow(outer, inner), _ring(corners)
    shares = 1.0 / corners + place @ np.linalg.pinv(place[:, :corners])
    at = points[node[first]][:, None, :] + np.einsum("spa,sax->spx", place - offsets, frame)
    of = section.reshape(-1, 3)
    cells = np.stack([place.shape[1] * of[:, which, None] + quads[:, point] for which, point in _HEX20], axis=2)
    return Sections(at.reshape(-1, 3), node[first], cells, np.where(np.abs(shares) > 1e-12, shares, 0.0))


def _box(widths: Vector, walls: Vector) -> tuple[Vector, Vector]:
    """Outlines (s, 24, 2) outside and inside of walls (s, 4): three points a side, so that a short cell at each end of a
    wall lets it warp towards the corner; with one cell a wall, torsion is as stiff as without warping."""
    ways = np.roll(CORNERS, -1, axis=0) - CORNERS  # along the sides
    inwards = walls[..., None] * np.stack([-ways[:, 1], ways[:, 0]], axis=1)
    start, end = CORNERS * widths, np.roll(CORNERS, -1, axis=0) * widths
    wall = np.maximum(np.roll(walls, 1, axis=1), np.roll(walls, -1, axis=1))[..., None]  # as at both ends, so that
    free = ((end - start) * ways).sum(axis=2, keepdims=True) - 2.0 * wall  # the mean of the points is the centre
    reach = (wall + np.minimum(wall, free / 3.0)) * ways
    outer = np.stack([start, start + reach, end - reach], axis=2)
    inner = outer + inwards[:, :, None]
    inner[:, :, 0] += np.roll(inwards, 1, axis=1)
    corners = [points.reshape(len(widths), -1, 2) for points in (outer, inner)]
    outside, inside = (np.concatenate([x, (x + np.roll(x, -1, axis=1)) / 2.0], axis=1) for x in corners)
    return outside, inside


def _hollow(outer: Vector, inner: Vector) -> Vector:
    """Points (s, 5 k, 2) of sections between two outlines (s, 2 k, 2)."""
    k = outer.shape[1] // 2
    return np.concatenate(
        [outer[:, :k], inner[:, :k], outer[:, k:], inner[:, k:], (outer[:, :k] + inner[:, :k]) / 2.0], axis=1
    )


def _ring(k: int) -> Numbers:
    """Points of each of the k cells over such a section: corners from an outer one on, then the edges between them."""
    i = np.arange(k)
    j = (i + 1) % k
    return np.stack([i, j, k + j, k + i, 2 * k + i, 4 * k + j, 3 * k + i, 4 * k + i], axis=1)


def _sections(node: Numbers, tangent: Vector, second: Vector, own: Vector) -> tuple[Numbers, Numbers]:
    """The section of each node of a cell, and of each section the first of these that has it."""
    result = np.full(len(node), -1, np.int64)
    firsts: list[int] = []
    order = np.argsort(node, kind="stable")
    starts = np.flatnonzero(np.diff(node[order], prepend=-1))
    for left in np.split(order, starts[1:]):
        while len(left):
            lead = left[0]
            mine = (tangent[left] @ tangent[lead] > ALIKE) & (second[left] @ second[lead] > ALIKE)
            mine &= (np.abs(own[left] - own[lead]) <= EQUAL * np.abs(own[lead]).max()).all(axis=1)
            mine[0] = True
            result[left[mine]] = len(firsts)
            firsts.append(int(lead))
            left = left[~mine]
    return result, np.array(firsts, np.int64)
