"""Nodes in the middle of the edges of thin cells, shared by all cells that meet there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from abut.mesh.facets import row_codes
from abut.mesh.promote import EDGES

Numbers = NDArray[np.int64]
QUADRATIC = {"tri3": "tri6", "quad4": "quad8", "line2": "line3"}
_EDGES = {"tri3": EDGES["tri"], "quad4": EDGES["quad"], "line2": ((0, 1),)}


def edges_of(kind: str) -> Numbers:
    """Local corners (m, 2) at the ends of the edges of a linear cell; none of a quadratic one."""
    return np.array(_EDGES.get(kind, ()), dtype=np.int64).reshape(-1, 2)


def with_middles(
    points: NDArray[np.float64], cells: Sequence[tuple[str, Numbers]]
) -> tuple[NDArray[np.float64], list[tuple[str, Numbers]], Numbers]:
    """Points with the new ones behind them, quadratic cells (kind, (n, k) rows of points), and the ends (m, 2) of the edge
    that each new point is in the middle of. Cells that are quadratic stay as they are."""
    ends = [nodes[:, edges_of(kind)].reshape(-1, 2) for kind, nodes in cells]
    every = np.sort(np.concatenate([np.empty((0, 2), np.int64), *ends]), axis=1)
    if not len(every):
        return points, list(cells), every
    _, one, inverse = np.unique(row_codes(every), return_index=True, return_inverse=True)
    numbers = np.split(len(points) + inverse.ravel(), np.cumsum([len(e) for e in ends])[:-1])
    result = [
        (QUADRATIC.get(kind, kind), np.concatenate([nodes, new.reshape(len(nodes), -1)], axis=1))
        for (kind, nodes), new in zip(cells, numbers)
    ]
    return np.concatenate([points, points[every[one]].mean(axis=1)]), result, every[one]
