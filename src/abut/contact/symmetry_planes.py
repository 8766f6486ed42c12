"""Planes of symmetry, beyond which the pressure continues as its mirror image: correction of averages next to them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.cells import BY_CODE, CELLS
from abut.contact.geometry import by_kind, split_at_creases
from abut.contact.nodal_recovery import Averages
from abut.contact.rim import Rim
from abut.mesh.surface import Surface

SHARED = 2.0  # theory (P14): on an even mesh nodes on the plane and those next to it show the same across it
CLOSED = 1e-3  # average over the largest from which on a point counts as in contact
STRAIGHT = np.cos(np.deg2rad(20.0))  # mean of unit vectors along the rim on both sides of a point: a bend of 40 degrees
APART = 0.13  # smaller over larger eigenvalue of two planes' normals at a point, from an angle of 40 degrees on


@dataclass(frozen=True)
class Planes:
    """Where a contactor ends at planes of symmetry. count: (n_points,) how many each point lies on, 0, 1 or 2; along:
    (n_points, dim) unit tangent of the rim at points of one plane, zero elsewhere and where the rim bends; across:
    (n_points, 2, dim) unit normals of the planes, zero where there are fewer; uneven: (n_facets,) facets of cells that do
    not make an even mesh with their mirror images: triangles, and in 3D those that have triangles for facets."""

    count: NDArray[np.int64]
    along: NDArray[np.float64]
    across: NDArray[np.float64]
    uneven: NDArray[np.bool_]


def planes(contactor: Surface, rim: Rim, mirrored: NDArray[np.bool_], uneven: NDArray[np.bool_]) -> Planes:
    """The planes from the edges of a contactor's rim that lie on one, in 2D from its ends. rim: of ``contactor``; mirrored:
    (m,) bool; uneven: as in ``Planes``."""
    out = rim.out[mirrored] / np.linalg.norm(rim.out[mirrored], axis=1, keepdims=True)
    n = len(contactor.points)
    count, along, across = np.zeros(n, dtype=np.int64), np.zeros_like(contactor.points), np.zeros((n, 2, contactor.dim))
    if contactor.dim == 2:
        ends = rim.ends[mirrored, 0]
        count[ends], across[ends, 0] = 1, out
        return Planes(count, along, across, uneven)
    ids, ends = np.unique(rim.ends[mirrored], return_inverse=True)
    n, ends = len(ids), ends.reshape(-1, 2)
    step = contactor.points[ids[ends[:, 1]]] - contactor.points[ids[ends[:, 0]]]
    edge = step / np.linalg.norm(step, axis=1, keepdims=True)
    tangent, normals, edges = np.zeros((n, 3)), np.zeros((n, 3, 3)), np.bincount(ends.ravel(), minlength=n)
    for end in ends.T:
        np.add.at(tangent, end, edge)
        np.add.at(normals, end, np.einsum("ea,eb->eab", out, out))
    size, length = np.linalg.eigvalsh(normals), np.linalg.norm(tangent, axis=1)
    several = size[:, 1] > APART * size[:, 2]
    straight = ~several & (length >= STRAIGHT * edges)
    count[ids] = 1 + several
    along[ids[straight]] = tangent[straight] / length[straight, None]
    for end in ends.T:  # the last edge at a point names a plane, the one that differs most from it the other
        across[ids[end], 0] = np.where((straight | several)[end, None], out, 0.0)
    for end in ends.T:
        other = several[end] & (np.abs((across[ids[end], 0] * out).sum(axis=1)) < STRAIGHT)
        across[ids[end[other]], 1] = out[other]
    return Planes(count, along, across, uneven)


def evened(
    contactor: Surface, at: Averages, average: NDArray[np.float64], of: Planes, sharp: bool = False
) -> NDArray[np.float64]:
    """Averages (n_points,) of a contactor with those on planes of symmetry mended where triangles meet them, theory (P14).
    The resultant stays, since what one point gains another loses; nothing becomes negative that was not.

    of: the planes of ``contactor``, from which ``at`` was made; sharp: averages that do not lag behind, theory (P12)."""
    if contactor.dim == 2:
        return _evened_ends(contactor, at, average, of)
    owner = split_at_creases(contactor)[1]
    count, along = of.count[owner], of.along[owner]
    closed = average > CLOSED * average.max(initial=0.0)
    straight = np.flatnonzero(along.any(axis=1) & closed)
    slope = np.zeros(len(average))
    slope[straight] = (along[straight] * at.slopes(average, straight)).sum(axis=1)
    result = average.copy()
    for kind, facets in by_kind(at.surface):
        rows = at.corners[facets, : CELLS[kind].corners]
        near = (count[rows] > 0).any(axis=1)
        near &= of.uneven[facets]
        if not near.any():
            continue
        rows, mass = rows[near], at.mass[facets[near], :3, :3]
        here, other = np.broadcast_arrays(rows[:, :, None], rows[:, None, :])
        away = at.surface.points[here] - at.surface.points[other]
        rise = np.zeros(away.shape[:-1]) if sharp else slope[here] * (along[here] * away).sum(axis=-1)
        if CELLS[kind].degree == 1:
            rise = SHARED * (rise + average[other] - average[here])
        towards = closed[here] & closed[other] & (count[here] > count[other])
        result += _exchanged(at, average, here, other, np.where(towards, mass * rise, 0.0))
    return result


def _evened_ends(contactor: Surface, at: Averages, average: NDArray[np.float64], of: Planes) -> NDArray[np.float64]:
    """The same in 2D: the pressure is even, so that of a parabola through the last three nodes those on the plane and next
    to it have the shares which leave their resultant, theory (P25). Cells of first order."""
    result = average.copy()
    closed = average > CLOSED * average.max(initial=0.0)
    linear = np.array([CELLS[BY_CODE[k].name].degree == 1 for k in at.surface.kinds], dtype=bool)
    rows = at.corners[:, :2]
    count = of.count[split_at_creases(contactor)[1]]
    for facet in np.flatnonzero((count[rows].sum(axis=1) == 1) & linear & of.uneven):
        end, other = rows[facet] if count[rows[facet, 0]] else rows[facet, ::-1]
        further = np.setdiff1d(rows[(rows == other).any(axis=1)], (end, other))
        on_axis = at.shared[end] != end  # there linear cells have an average of their own, theory (P10)
        if on_axis or len(further) != 1 or count[further[0]] or not closed[[end, other, further[0]]].all():
            continue
        near, far = (np.linalg.norm(at.surface.points[p] - at.surface.points[end]) for p in (other, further[0]))
        part = near**2 / (far**2 - near**2)  # p_end - p_other = part (p_other - p_further)
        both = at.weight[end] * average[end] + at.weight[other] * average[other]
        rise = at.weight[end] * part
        result[other] = max(0.0, (both + rise * average[further[0]]) / (at.weight[end] + at.weight[other] + rise))
        result[end] = (both - at.weight[other] * result[other]) / at.weight[end]
    return result


def _exchanged(
    at: Averages,
    average: NDArray[np.float64],
    here: NDArray[np.int64],
    other: NDArray[np.int64],
    flow: NDArray[np.float64],
) -> NDArray[np.float64]:
    """What averages gain (n_points,) by flows of force (n, 3, 3) from points ``other`` to points ``here``, of which no
    point gives more than it has."""
    n = len(average)
    given = np.bincount(np.where(flow > 0.0, other, here).ravel(), np.abs(flow).ravel(), n)
    share = np.minimum(1.0, np.maximum(at.weight * average, 0.0) / np.maximum(given, 1e-300))
    flow = flow * share[np.where(flow > 0.0, other, here)]
    gain = np.bincount(here.ravel(), flow.ravel(), n) - np.bincount(other.ravel(), flow.ravel(), n)
    return np.asarray(gain / np.where(at.weight > 0.0, at.weight, 1.0))
