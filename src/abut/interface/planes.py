"""Planes of symmetry, beyond which the pressure goes on as its mirror image: what that says of averages next to them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.interface.geometry import by_kind, split_at_creases
from abut.interface.recover import Averages
from abut.interface.rim import Rim
from abut.mesh.surface import Surface

CLOSED = 1e-3  # average over the largest from which on a point counts as in contact
STRAIGHT = np.cos(np.deg2rad(20.0))  # mean of unit vectors along the rim on both sides of a point: a bend of 40 degrees
APART = 0.13  # smaller over larger eigenvalue of two planes' normals at a point, from an angle of 40 degrees on


@dataclass(frozen=True)
class Planes:
    """Where a contactor ends at planes of symmetry. count: (n_points,) how many each point lies on, 0, 1 or 2; along:
    (n_points, dim) unit tangent of the rim at points of one plane, zero elsewhere and where the rim bends."""

    count: NDArray[np.int64]
    along: NDArray[np.float64]


def planes(contactor: Surface, rim: Rim, mirrored: NDArray[np.bool_]) -> Planes:
    """The planes from the edges of a contactor's rim that lie on one. rim: of ``contactor``, in 3D; mirrored: (m,) bool."""
    n = len(contactor.points)
    ends = rim.ends[mirrored]
    step = contactor.points[ends[:, 1]] - contactor.points[ends[:, 0]]
    edge, out = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in (step, rim.out[mirrored]))
    tangent, normals, edges = np.zeros((n, 3)), np.zeros((n, 3, 3)), np.bincount(ends.ravel(), minlength=n)
    for own in ends.T:
        np.add.at(tangent, own, edge)
        np.add.at(normals, own, np.einsum("ea,eb->eab", out, out))
    size = np.linalg.eigvalsh(normals)
    count = np.where(edges > 0, 1 + (size[:, 1] > APART * size[:, 2]), 0)
    length = np.linalg.norm(tangent, axis=1)
    straight = (count == 1) & (length >= STRAIGHT * np.maximum(edges, 1))
    return Planes(count, np.where(straight, 1.0 / np.maximum(length, 1e-300), 0.0)[:, None] * tangent)


def evened(contactor: Surface, at: Averages, average: NDArray[np.float64], of: Planes) -> NDArray[np.float64]:
    """Averages (n_points,) of a contactor with those on planes of symmetry mended where triangles meet them, theory (P14).
    The resultant stays, since what one point gains another loses; nothing becomes negative that was not.

    of: the planes of ``contactor``, from which ``at`` was made."""
    owner = split_at_creases(contactor)[1]
    count, along = of.count[owner], of.along[owner]
    closed = average > CLOSED * average.max(initial=0.0)
    result = average.copy()
    for kind, facets in by_kind(at.surface):
        rows = at.corners[facets, : CELLS[kind].corners]
        near = (count[rows] > 0).any(axis=1)
        if CELLS[kind].corners != 3 or not near.any():
            continue
        rows, mass = rows[near], at.mass[facets[near], :3, :3]
        here, other = np.broadcast_arrays(rows[:, :, None], rows[:, None, :])
        towards = closed[here] & closed[other] & (count[here] > count[other])
        away = at.surface.points[here] - at.surface.points[other]
        rise = (along * at.slopes(average)).sum(axis=1)[here] * (along[here] * away).sum(axis=-1)
        if CELLS[kind].degree == 1:
            rise = rise + average[other] - average[here]
        result += _exchanged(at, average, here, other, np.where(towards, mass * rise, 0.0))
    return result


def _exchanged(
    at: Averages,
    average: NDArray[np.float64],
    here: NDArray[np.int64],
    other: NDArray[np.int64],
    flow: NDArray[np.float64],
) -> NDArray[np.float64]:
    """What averages gain (n_points,) by flows of force, each (n, 3, 3), from points ``other`` to points ``here``, of which no
    point gives more than it has."""
    n = len(average)
    given = np.bincount(np.where(flow > 0.0, other, here).ravel(), np.abs(flow).ravel(), n)
    share = np.minimum(1.0, np.maximum(at.weight * average, 0.0) / np.maximum(given, 1e-300))
    flow = flow * share[np.where(flow > 0.0, other, here)]
    gain = np.bincount(here.ravel(), flow.ravel(), n) - np.bincount(other.ravel(), flow.ravel(), n)
    return np.asarray(gain / np.where(at.weight > 0.0, at.weight, 1.0))
