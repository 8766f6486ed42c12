"""Contact that hangs on one node, where a load step has failed: which, and how to mend it."""

from __future__ import annotations

import numpy as np

from abut.problem.problem import ContactProblem
from abut.solution.state import State


def hanging(problem: ContactProblem, state: State) -> str:
    """Which contacts press on one node of the contactor alone at a state, where, and what to do; empty where none does."""
    told, first = [], 0
    for pair in problem.pairs:
        closed = state.closed[first : first + len(pair)][pair.normal]
        first += len(pair)
        nodes = np.unique(pair.space.node[closed]) if not pair.tied else np.zeros(0, dtype=int)
        if len(nodes) != 1 or nodes[0] < 0:
            continue
        place = ", ".join(f"{x:.6g}" for x in problem.model.mesh.points[nodes[0]])
        sharp = int((pair.space.node == nodes[0]).sum()) > 1
        told.append(
            f"contact '{pair.contact.name}' hangs on one node of the contactor, at ({place}) in the undeformed mesh"
            + (", a sharp corner: round it off by a few facets" if sharp else ": refine the contactor there")
        )
    return "; ".join(told)
