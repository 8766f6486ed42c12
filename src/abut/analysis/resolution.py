"""Whether contact is as wide as the facets that carry it need: the certificate's line "resolution"."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.analysis.oscillation import CLOSED, Graph
from abut.contact.geometry import beside_others, facet_sizes, split_at_creases
from abut.contact.rim import goes_on, rim
from abut.problem.pair import WHOLE, Pair

MOSTLY = 0.5  # covered share of a point from which on it could carry pressure
FARTHEST = 10  # facets beyond which nobody counts
EVEN = 0.1  # of the largest pressure: what is less uneven needs no facets

Array = NDArray[np.float64]


def resolution(pair: Pair, pressure: Array, share: Array, largest: float) -> float:
    """One over the number of facets from the edge of contact to its innermost node; 0 where contact has no free edge.

    pressure: (n_points,) at the corners, of the contactor split at its creases; share: (n_points,) covered share of their
    supports; largest: of the pressure. An edge is free where nodes stay open though target lies opposite most of what is
    theirs: the rim of a body is no edge that facets must find."""
    graph = Graph.of_nodes(split_at_creases(pair.contactor)[0])
    closed = (graph.degree > 0) & (pressure > CLOSED * largest)
    return _inverse_depth(graph, closed, (graph.degree > 0) & ~closed & (share > MOSTLY))


def resolution_between_ends(pair: Pair, pressure: Array, share: Array, largest: float) -> float:
    """The same from where either body ends on one that goes on, as a post does on a block: there the pressure of bodies with
    corners rises without limit. 0 where contact ends nowhere so, and where pressure is nearly the same all over.

    pressure, share, largest: as in ``resolution``."""
    surface = split_at_creases(pair.contactor)[0]
    graph = Graph.of_nodes(surface)
    closed = (graph.degree > 0) & (pressure > CLOSED * largest)
    if not closed.any() or pressure[closed].min() > (1.0 - EVEN) * largest:
        return 0.0
    border = rim(surface)
    size = max(facet_sizes(each).max() for each in (pair.contactor, pair.target))
    between = np.zeros(len(surface.points), dtype=bool)
    nodes = surface.nodes[beside_others(surface)]
    between[nodes[nodes >= 0]] = True  # of one target and the next, which go on for each other
    start = closed & (share < 1.0 - WHOLE) & ~between
    start[border.ends[goes_on(surface, border, pair.target, size)]] = True
    return _inverse_depth(graph, closed, start & (graph.degree > 0))


def _inverse_depth(graph: Graph, closed: NDArray[np.bool_], reached: NDArray[np.bool_]) -> float:
    """One over the number of facets from nodes ``reached`` to the farthest closed one, both (n_points,); 0 from none."""
    if not closed.any():
        return 0.0
    for depth in range(1, FARTHEST + 1):
        reached = reached | graph.any_of(reached)
        if reached[closed].all():
            return 1.0 / depth
    return 1.0 / FARTHEST if reached[closed].any() else 0.0
