"""How far the surfaces of a contact overlap after deformation, point by point."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.discretization.pairs import Pair
from abut.interface.geometry import facet_sizes

ROUNDING = 1e-8  # of the largest change of a gap: overlaps below are left by the solver


def overlap(pair: Pair, displacement: NDArray[np.float64], offset: float) -> float:
    """Largest overlap at the corners and middles of the segments over the size of the contactor's facet, 0 for none.

    displacement: (n_points, dim); offset: added to the geometric gap, a length.
    """
    at = pair.coupling.sights
    if at is None or not len(at.gap):
        return 0.0
    change = np.zeros(len(at.gap))
    for sign, surface, facet, shapes in (
        (1.0, pair.contactor, at.facet, at.own),
        (-1.0, pair.target, at.target_facet, at.other),
    ):
        nodes = np.maximum(surface.nodes[facet], 0)  # shape functions are zero where padded
        for a in range(surface.dim):
            change += sign * at.normal[:, a] * (shapes * displacement[nodes, a]).sum(axis=1)
    depth = -(at.gap + offset + change) - ROUNDING * float(np.abs(change).max())
    return max(float((depth / facet_sizes(pair.contactor)[at.facet]).max()), 0.0)
