"""Contact that a step has thrown open, though it alone holds a body: no state that quasi-static loads lead to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.problem.contact_pairs import Pair
from abut.problem.linearised import Linearised
from abut.solution.state import State

FAR = 1.0  # facet sizes by which sides may come apart within a step


def thrown_apart(system: Linearised, before: State, now: State) -> str:
    """Why the state ``now`` does not follow from the converged state ``before``; empty where it may.

    Without friction or pressure a body that supports leave free is in equilibrium anywhere: Newton's method ends there when
    an iteration has thrown it out of its contact."""
    if system.restraint.by_supports:
        return ""
    parts = zip(system.pairs, system.split(before.closed), system.split(now.closed), system.split(system.gap(now)))
    for pair, was, closed, gap in parts:
        if pair.tied or not was[pair.normal].any() or closed[pair.normal].any():
            continue
        if _clearance(pair, gap) > FAR:
            return f"contact '{pair.contact.name}' comes apart at once, and it is what holds a body"
    return ""


def _clearance(pair: Pair, gap: NDArray[np.float64]) -> float:
    """The least gap over the facet size; infinite where nothing is opposite."""
    weight = pair.space.weight
    opposite = weight > 0.0
    return float((gap[pair.normal][opposite] / weight[opposite]).min(initial=np.inf) / pair.size)
