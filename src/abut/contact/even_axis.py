"""Averages of the pressure at the axis of bodies of revolution, where linear cells have wrong forces; theory (P28)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.contact.geometry import by_kind
from abut.contact.nodal_recovery import ON_AXIS, Averages
from abut.contact.star_fits import Supports, supports

WHOLE = 1e-2  # a support covered to within this share is fully covered
CLOSED = 1e-3  # average over the largest from which on a point counts as in contact
Array = NDArray[np.float64]


def even_at_axis(at: Averages, average: Array) -> Array:
    """Averages (n_points,), at points on the axis and next to them those of p_0 + k r^2 in place of their own where facets
    of first order are ``exact``: with the force of both, and the average at the third point, which is in contact as they
    and the fourth are."""
    surface = at.surface
    if not (surface.axisymmetric and at.exact.any()):
        return average
    result, of = average.copy(), supports(surface)
    beside = _beside(at)
    inside = (average > CLOSED * average.max(initial=0.0)) & (np.abs(at.share - 1.0) <= WHOLE)
    radius = surface.points[:, 0]
    for axis in [point for point in beside if radius[point] <= ON_AXIS * radius[surface.node_ids].max()]:
        chain = [axis]
        while len(chain) < 4:
            further = [point for point in beside[chain[-1]] if point not in chain]
            if len(further) != 1:
                break
            chain += further
        if len(chain) < 4 or not inside[chain].all():
            continue
        first, third = chain[:2], chain[2]
        square = _squares(surface.points, of, axis, chain[:3])
        weight = at.weight[first] / at.weight[first].sum()
        force, middle = weight @ average[first], weight @ square[:2]
        bend = (average[third] - force) / (square[2] - middle)
        result[first] = force + bend * (square[:2] - middle)
    return result


def _beside(at: Averages) -> dict[int, list[int]]:
    """The neighbours of each point that has such facets alone."""
    found: dict[int, list[int]] = {}
    others: set[int] = set()
    for kind, facets in by_kind(at.surface):
        for nodes, exact in zip(at.surface.nodes[facets, :2].tolist(), at.exact[facets].tolist()):
            if CELLS[kind].degree > 1 or not exact:
                others.update(nodes)
            for here, other in (nodes, nodes[::-1]):
                found.setdefault(here, []).append(other)
    return {here: beside for here, beside in found.items() if here not in others}


def _squares(points: Array, of: Supports, origin: int, which: list[int]) -> Array:
    """Averages (n,) of the square of the distance from a point over the functions of points."""
    away = points[which] - points[origin]
    square = np.trace(of.square[which], axis1=1, axis2=2)
    return np.asarray(square + 2.0 * (of.mean[which] * away).sum(axis=1) + (away**2).sum(axis=1))
