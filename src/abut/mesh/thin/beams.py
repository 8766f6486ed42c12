"""Line meshes with a rectangular or an elliptic section as hex20, one over the section.

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
ROUND = POINTS / (2.0 * np.linalg.norm(POINTS, axis=1, keepdims=True))  # of an ellipse: all on it
OUTLINES = np.stack([POINTS, ROUND])
AREA = 2.0 + 8.0 / 3.0 * (np.sqrt(2.0) - 1.0)  # of one of radius 1: a square and four segments of parabolas
EVEN = np.sqrt(np.pi / AREA)  # times the radius: the same area as the circle
COUNT = len(POINTS)
_START, _END, _MIDDLE = 0, 1, 2
_HEX20 = (  # (which node of the line, which point of its section)
    (_START, 0), (_END, 0), (_END, 1), (_START, 1), (_START, 3), (_END, 3), (_END, 2), (_START, 2),
    (_MIDDLE, 0), (_END, 4), (_MIDDLE, 1), (_START, 4), (_MIDDLE, 3), (_END, 6), (_MIDDLE, 2), (_START, 6),
    (_START, 7), (_END, 7), (_END, 5), (_START, 5),
)  # fmt: skip


@dataclass(frozen=True)
class Beam:
    """cells: (n, 3) rows of points: start, end, middle. Of each: axis (n, 3), near which the first direction n1 of the
    section lies; widths (n, 2) along n1 and n2 = tangent x n1 [length]; offsets (n, 2) of the nodes from the centre,
    over these; round (n,): whether it is the ellipse in these widths, with every node of the solid on it, rather than the
    rectangle. Between the nodes there are parabolas: its area is 1.2 % smaller, its second moments are 2.3 %."""

    cells: Numbers
    axis: Vector
    widths: Vector
    offsets: Vector
    round: NDArray[np.bool_]


@dataclass(frozen=True)
class Sections:
    """points: (8 s, 3), eight for each section: corners, then the middles of its sides; node: (s,) which it stands on;
    cells: (n, 20) rows of ``points``; shares: (s, 8, 4) of its corners in the motion of each of its points where the section
    stays one and strains evenly."""

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
    each = [beam.widths, beam.offsets * beam.widths, beam.round[:, None] * beam.widths[:, :1]]
    own = np.repeat(np.concatenate(each, axis=1), 3, axis=0)
    section, first = _sections(node, tangents.reshape(-1, 3), second.reshape(-1, 3), own)
    count = len(first)
    along, across = np.zeros((count, 3)), np.zeros((count, 3))
    np.add.at(along, section, tangents.reshape(-1, 3))
    np.add.at(across, section, second.reshape(-1, 3))
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    across -= (across * along).sum(axis=1, keepdims=True) * along
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    frame = np.stack([np.cross(across, along), across], axis=1)  # n1, n2
    widths, offsets, shape = own[first, None, :2], own[first, None, 2:4], np.where(own[first, 4], 1, 0)
    place = OUTLINES[shape] * widths - offsets
    at = points[node[first]][:, None, :] + np.einsum("spa,sax->spx", place, frame)
    of = section.reshape(-1, 3)
    cells = np.stack([COUNT * of[:, which] + point for which, point in _HEX20], axis=1)
    return Sections(at.reshape(-1, 3), node[first], cells, _SHARES[shape])


def _shares(outline: Vector) -> Vector:
    """What an affine motion of the corners (n, 2) of a section adds to that of each of its points: (m, n)."""
    corners = outline[: len(CORNERS)]
    shares = 1.0 / len(corners) + outline @ np.linalg.pinv(corners)
    return np.where(np.abs(shares) > 1e-12, shares, 0.0)  # rounding


_SHARES = np.stack([_shares(outline) for outline in OUTLINES])


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
