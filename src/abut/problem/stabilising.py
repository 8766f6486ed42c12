"""The drag in a state that belongs to the way under a drag, kept in its history."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.solution.state import State


def with_drag(state: State, force: NDArray[np.float64] | None) -> State:
    """The state with the force (n_free,) that a drag has in it, None for no drag."""
    return replace(state, history=replace(state.history, drag=force))


def is_dragged(state: State) -> bool:
    """Whether the state has been reached under a drag."""
    return state.history.drag is not None
