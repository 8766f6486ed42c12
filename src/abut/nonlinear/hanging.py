"""Where a load step has failed: contact that hangs on one node, or goes on opening and closing, and how to mend it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.problem.pair import Pair
from abut.problem.problem import ContactProblem
from abut.solution.state import State


def hanging(problem: ContactProblem, state: State, changing: NDArray[np.bool_]) -> str:
    """Which contacts press on one node of the contactor alone at the last converged state, or go on changing, where, and
    what to do; empty where none does. changing: (n,) multipliers whose status the last iteration changed."""
    told, first = [], 0
    for pair in problem.pairs:
        own = slice(first, first := first + len(pair))
        if pair.decided:
            continue
        pressed, restless = (_nodes(pair, part[own][pair.normal]) for part in (state.closed, changing))
        if len(pressed) == 1:
            told.append(_told(problem, pair, pressed, "hangs on one node of the contactor"))
        elif 0 < len(restless) <= 3:  # more are told in numbers
            told.append(_told(problem, pair, restless, "goes on opening and closing"))
    return "; ".join(told)


def _nodes(pair: Pair, functions: NDArray[np.bool_]) -> NDArray[np.int64]:
    nodes = np.unique(pair.space.node[functions])
    return nodes[nodes >= 0]


def _told(problem: ContactProblem, pair: Pair, nodes: NDArray[np.int64], what: str) -> str:
    places = " and ".join(place(problem, node) for node in nodes)
    cure = cured(pair, nodes) or ": refine the contactor there"
    return f"contact '{pair.contact.name}' {what}, at {places} in the undeformed mesh{cure}"


def place(problem: ContactProblem, node: int) -> str:
    """Where a point of the mesh lies, in words."""
    return f"({', '.join(f'{x:.6g}' for x in problem.model.mesh.points[node])})"


def cured(pair: Pair, nodes: NDArray[np.int64]) -> str:
    """What helps where a contact hangs on nodes, as far as is known: a sharp corner or edge has a function on each of its
    faces; facets that belong to both sides have roles by their rank, which changes from one to the next."""
    if any(int((pair.space.node == node).sum()) > 1 for node in nodes):
        return ", a sharp corner or edge: round it off by a few facets"
    own, other = (8 * side.cells + side.local for side in (pair.contactor, pair.target))
    return ": name the two sides that touch, one as contactor, the other as target" if np.isin(own, other).any() else ""
