"""ADJUST with a node set, translated into a distance up to which nodes count as touching."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.io.deck.faces import connectivity
from abut.io.deck.groups import Groups
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Deck, Numbers, Pair

Vector = NDArray[np.float64]


def distance(deck: Deck, groups: Groups, pair: Pair, nodes: Numbers) -> float:
    """The distance that parts the slave nodes in the set from the others; the mesh's size where all are in it.

    Raises InputError where no distance does."""
    extent = float(np.ptp(deck.points, axis=0).max())
    slave = np.unique(np.concatenate([n.ravel() for n in connectivity(deck, groups.rows(pair.slave)).values()]))
    inside = np.isin(slave, nodes)
    if inside.all():
        return extent
    if not inside.any():
        return 0.0
    far = _distances(deck, groups, pair.master, slave)
    low, high = float(far[inside].max()), float(far[~inside].min())
    if not low < high:
        raise DeckError(
            pair.place,
            f"*CONTACT PAIR: ADJUST: nodes of '{pair.slave}' outside the set are as close to "
            f"'{pair.master}' as nodes in it, and abut adjusts all up to a distance; give ADJUST=distance",
        )
    return 0.5 * (low + high)


def _distances(deck: Deck, groups: Groups, master: str, slave: Numbers) -> Vector:
    """From nodes to the nearest point of a surface's facets (straight between corners)."""
    result = np.full(len(slave), np.inf)
    points = deck.points[np.searchsorted(deck.nodes, slave)]
    for kind, nodes in connectivity(deck, groups.rows(master)).items():
        corners = deck.points[np.searchsorted(deck.nodes, nodes[:, : CELLS[kind].corners])]
        for k in range(1, max(2, CELLS[kind].corners - 1)):
            simplex = corners[:, [0, k, k + 1]] if CELLS[kind].dim == 2 else corners
            for i, x in enumerate(points):
                result[i] = min(result[i], _nearest(x, simplex))
    return result


def _nearest(x: Vector, simplices: Vector) -> float:
    """Distance of a point to segments (n, 2, 3) or triangles (n, 3, 3)."""
    best = np.inf
    if simplices.shape[1] == 3:
        a, b, c = simplices.transpose(1, 0, 2)
        normal = np.cross(b - a, c - a)
        normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
        height = ((x - a) * normal).sum(axis=1)
        foot = x - height[:, None] * normal
        sides = [(np.cross(q - p, foot - p) * normal).sum(axis=1) for p, q in ((a, b), (b, c), (c, a))]
        inside = np.min(sides, axis=0) >= 0.0
        best = float(np.abs(height[inside]).min(initial=np.inf))
    for i in range(simplices.shape[1]):
        p, q = simplices[:, i - 1], simplices[:, i]
        along = ((x - p) * (q - p)).sum(axis=1) / np.maximum(((q - p) ** 2).sum(axis=1), 1e-300)
        foot = p + np.clip(along, 0.0, 1.0)[:, None] * (q - p)
        best = min(best, float(np.linalg.norm(x - foot, axis=1).min()))
    return best
