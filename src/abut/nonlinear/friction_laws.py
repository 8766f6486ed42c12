"""The status that complementarity, Coulomb's law and ties ask for."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.nonlinear.laws import barely_covered
from abut.problem.linearised import NOTHING, Linearised
from abut.problem.pair import Pair
from abut.solution.state import CLOSED, OPEN, SLIPPING, State

Vector = NDArray[np.float64]
Status = NDArray[np.int8]


def next_status(system: Linearised, state: State, balanced: float, largest: float, gap: Vector | None = None) -> Status:
    """The status that the laws ask for, theory (R5), (R6), of each multiplier. What differs by rounding alone stays;
    what hardly has a target opposite is open.
    balanced: rounding, of the largest pressure; largest: of the steps before. gap: (n,) weighted gaps and slips to judge by;
    left out: those of the state."""
    if not len(state.multipliers):
        return state.status
    pressed = np.concatenate([np.zeros(0), *(p[pair.normal] for pair, p in _contacts(system, state.multipliers))])
    reference = float(np.abs(pressed).max(initial=largest))
    small = balanced * max(reference, NOTHING)
    gap = system.gap(state) if gap is None else gap
    gaps, multipliers, before = (system.split(part) for part in (gap, state.multipliers, state.status))
    wanted = [
        np.full(len(pair), CLOSED if pair.two_way else OPEN)
        if pair.decided
        else _wanted(pair, system.factors, gap, part, status, small)
        for pair, gap, part, status in zip(system.pairs, gaps, multipliers, before)
    ]
    return np.where(barely_covered(system), OPEN, system.join(wanted)).astype(np.int8)


def _contacts(system: Linearised, values: Vector) -> list[tuple[Pair, Vector]]:
    return [(pair, part) for pair, part in zip(system.pairs, system.split(values)) if not pair.tied]


def _wanted(pair: Pair, factors: Vector, gap: Vector, multipliers: Vector, status: Status, small: float) -> Status:
    normal, earlier = pair.normal, status[pair.normal]
    depth = -gap[normal] / pair.scale[normal]
    pushed = multipliers[normal] + depth
    closed = np.where(earlier != OPEN, pushed >= -small, pushed > small)
    result = np.where(closed, CLOSED, OPEN)
    if not pair.frictional:
        return result
    limit = pair.friction(factors)
    if not limit.rough:
        drag = pair.tangential_traction(multipliers)
        trial = pair.tangential_traction(multipliers - gap / pair.scale)
        size = np.linalg.norm(trial, axis=1)
        excess = size - limit.at(np.maximum(pushed, 0.0))[0]
        back = (
            np.einsum("kd,kd->k", drag, trial) < -small * size
        )  # slips the way it is pulled: it sticks before it slips back
        slips = np.where(earlier == SLIPPING, (excess >= -small) & ~back, excess > small)
        result = np.where(closed & ((slips & (size > small)) | limit.none), SLIPPING, result)
    return np.asarray(pair.of_functions(result))
