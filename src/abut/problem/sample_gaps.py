"""The gap after deformation point by point, at the corners and middles of the segments of a pair at small displacements."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.contact.coupling import GapSamples
from abut.problem.pair import Pair

TOUCHING = 1e-2  # of the largest gap of a facet: how deep surfaces may lie in each other that count as apart there


def gaps_at(pair: Pair, at: GapSamples, displacement: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
    """Gaps (n,) at samples of a pair, and by how much displacements (n_points, dim) change one of them at most."""
    change = np.zeros(len(at.gap))
    for sign, surface, facet, shapes in (
        (1.0, pair.contactor, at.facet, at.contactor_shapes),
        (-1.0, pair.target, at.target_facet, at.target_shapes),
    ):
        nodes = np.maximum(surface.nodes[facet], 0)  # shape functions are zero where padded
        for a in range(surface.dim):
            change += sign * at.normal[:, a] * (shapes * displacement[nodes, a]).sum(axis=1)
    return at.gap + change, float(np.abs(change).max(initial=0.0))


def apart(pair: Pair, displacement: NDArray[np.float64], offset: float) -> NDArray[np.bool_]:
    """Facets (n_facets,) at all points of which the sides are apart, or touch. displacement: (n_points, dim); offset: added
    to all gaps, a length."""
    at, n = pair.coupling.gap_samples, len(pair.contactor)
    return np.zeros(n, dtype=bool) if at is None else facets_apart(at, gaps_at(pair, at, displacement)[0] + offset, n)


def facets_apart(at: GapSamples, gap: NDArray[np.float64], n: int) -> NDArray[np.bool_]:
    """The same of n facets by gaps (n_samples,) at samples."""
    least, most = np.full(n, np.inf), np.zeros(n)
    np.minimum.at(least, at.facet, gap)
    np.maximum.at(most, at.facet, gap)
    return np.asarray((most > 0.0) & (least >= -TOUCHING * most))
