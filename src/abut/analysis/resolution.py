"""Whether contact is as wide as the facets that carry it need: the certificate's line "resolution"."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.analysis.oscillation import CLOSED, Graph
from abut.contact.geometry import split_at_creases
from abut.problem.pair import Pair

MOSTLY = 0.5  # covered share of a point from which on it could carry pressure
FARTHEST = 10  # facets beyond which nobody counts


def resolution(pair: Pair, pressure: NDArray[np.float64], share: NDArray[np.float64], largest: float) -> float:
    """One over the number of facets from the edge of contact to its innermost node; 0 where contact has no free edge.

    pressure: (n_points,) at the corners, of the contactor split at its creases; share: (n_points,) covered share of their
    supports; largest: of the pressure. An edge is free where nodes stay open though target lies opposite most of what is
    theirs: the rim of a body is no edge that facets must find."""
    graph = Graph.of_nodes(split_at_creases(pair.contactor)[0])
    closed = (graph.degree > 0) & (pressure > CLOSED * largest)
    reached = (graph.degree > 0) & ~closed & (share > MOSTLY)
    if not closed.any():
        return 0.0
    for depth in range(1, FARTHEST + 1):
        reached = reached | graph.any_of(reached)
        if reached[closed].all():
            return 1.0 / depth
    return 1.0 / FARTHEST if reached[closed].any() else 0.0
