"""The drag in a state that belongs to the way under a drag, kept in its history."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.solution.state import State

DRAG = "drag"  # whose history is the drag's force at the end of a part of a step
FORCE = "force"


def with_drag(state: State, force: NDArray[np.float64]) -> State:
    """The state with the force (n_free,) that a drag has in it."""
    return replace(state, history=state.history.with_term(DRAG, {FORCE: force[:, None]}))


def without_drag(state: State) -> State:
    """The state without any, itself where there is none."""
    return replace(state, history=state.history.without(DRAG)) if is_dragged(state) else state


def is_dragged(state: State) -> bool:
    """Whether the state has been reached under a drag."""
    return bool(state.history.of(DRAG))


def drag_of(state: State) -> NDArray[np.float64]:
    """(n_free,) the force of the drag in a state, zero where there is none."""
    force = state.history.of(DRAG).get(FORCE)
    return np.zeros(len(state.unknowns)) if force is None else force[:, 0]
