"""Averages of the cells' stresses at the nodes, in which nothing that is known at the surface takes part: what a pressure is
compared with, theory (P17)."""

from __future__ import annotations

import numpy as np

from abut.bodies.solids import Array, Group, Solids
from abut.bodies.stress import PointStress
from abut.mesh.reference import reference_nodes


def averages(solids: Solids, stress: PointStress) -> Array:
    """Stresses xx yy zz xy yz zx at the points, (n_points, 6): those at the integration points, carried linearly to each
    cell's nodes and averaged over the cells of a point; zero where there are none."""
    n = len(solids.points)
    total, count = np.zeros((n, 6)), np.zeros(n)
    for group, at in zip(solids.groups(), stress):
        nodes, values = group.nodes.ravel(), (_to_nodes(group) @ at).reshape(-1, 6)
        count += np.bincount(nodes, minlength=n)
        for component in range(6):
            total[:, component] += np.bincount(nodes, values[:, component], n)
    return np.asarray(total / np.maximum(count, 1.0)[:, None])


def _to_nodes(group: Group) -> Array:
    """Least-squares linear fit to values at the integration points, at the nodes, (nodes, q)."""
    (xi, weights), where = group.rule, reference_nodes(group.kind)
    terms, at = (
        np.concatenate([np.ones((len(x), 1)), x], axis=1)[:, : None if len(xi) > 2 else 1] for x in (xi, where)
    )
    root = np.sqrt(np.abs(weights))[:, None]
    return np.asarray(at @ np.linalg.pinv(root * terms) * root.T)
