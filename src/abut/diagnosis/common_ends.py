"""Contact that presses alone at an end common to both sides, as at a clamp: true where blocks bite with their edges, false
where straight cells bend and so cut into each other, theory after (P26)."""

from __future__ import annotations

import numpy as np

from abut.analysis.oscillation import CLOSED, Graph
from abut.contact.geometry import facet_sizes
from abut.contact.nodal_recovery import at_points
from abut.contact.rim import goes_on, rim
from abut.solution import ContactResult


def presses_at_common_end(result: ContactResult) -> bool:
    """Whether points at an edge beyond which neither side goes on press while none beside them does."""
    surface, pressure = result.contactor, np.nan_to_num(result.pressure)
    largest = float(pressure.max(initial=0.0))
    if largest <= 0.0:
        return False
    border, graph = rim(surface), Graph.of_nodes(surface)
    size = max(facet_sizes(each).max() for each in (surface, result.target))
    ends = np.zeros(len(surface.points), dtype=bool)
    ends[border.ends[~goes_on(surface, border, result.target, size)]] = True
    closed = (graph.degree > 0) & (at_points(surface, pressure) > CLOSED * largest)
    return bool((closed & ends & ~graph.any_of(closed & ~ends)).any())
