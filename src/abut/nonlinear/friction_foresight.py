"""Newton steps with friction that tell which status comes next, and where contact closes: half spaces foresee it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from abut.linear.solver import Prepared
from abut.nonlinear.exact import MOST, STRIDE, TOLD
from abut.nonlinear.iteration import Increment, advance, largest_force
from abut.problem.laws import LawRows
from abut.problem.linearised import Linearised
from abut.problem.pair import Pair
from abut.solution.state import CLOSED, OPEN, State

ENOUGH = 0.1  # reduction of the residual that a solution at least aims at
Laws = Callable[[Linearised, State], Sequence[LawRows]]


def advanced(solver: Prepared, state: State, laws: Laws, increment: Increment, accuracy: float) -> State:
    """The state after a Newton step. An iterative solver, asked for ``accuracy`` of the residual, goes on where forces are
    so far from balance that the state says nothing."""
    system = solver.system
    for _ in range(1 if solver.exact else MOST):
        state = advance(solver, state, laws(system, state), accuracy)
        left = float(np.abs(system.unbalanced(state)).max(initial=0.0))
        left /= largest_force(system, state, system.internal(state), increment)
        if left <= TOLD:
            break
        accuracy = float(np.clip(TOLD / left, STRIDE, ENOUGH))
    return state


def foreseen(solver: Prepared, state: State, wanted: NDArray[np.int8]) -> NDArray[np.int8]:
    """The status (n,) to go on with where the laws ask for ``wanted``: closed where half spaces without friction close, and
    stuck where that is new. What of it slips only a solution tells. ``wanted`` itself where half spaces foresee that no more
    closes than in ``state``, and the laws ask for more."""
    pairs, split = solver.system.pairs, solver.system.split
    beside = solver.system.join([_beside(pair) for pair in pairs]).astype(bool)
    gap = solver.system.gap(state)
    closed = split(solver.foresee(gap, state.multipliers, (wanted != OPEN) | beside, beside))
    result = solver.system.join([_with(*part) for part in zip(pairs, split(wanted), closed)])
    few, many = (int((part != OPEN).sum()) for part in (result, wanted))
    return wanted if few <= int(state.closed.sum()) < many else result


def _beside(pair: Pair) -> NDArray[np.bool_]:
    """Multipliers that never open by themselves, (n,)."""
    return np.arange(len(pair)) >= (0 if pair.two_way else len(pair.space))


def _with(pair: Pair, wanted: NDArray[np.int8], closed: NDArray[np.bool_]) -> NDArray[np.int8]:
    if pair.two_way:
        return wanted
    shut = np.asarray(pair.of_functions(closed[pair.normal]))
    return np.where(shut, np.where(wanted == OPEN, CLOSED, wanted), OPEN)
