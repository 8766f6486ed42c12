"""Points of a contact that take turns, in Newton's method at large displacements: at a sharp corner one lets go where the
other one closes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from abut.problem.linearised import Linearised
from abut.solution.state import OPEN, State

Advance = Callable[[State], State]


def exchanged(
    system: Linearised, here: State, there: State, closings: NDArray[np.int64], patience: int, advance: Advance
) -> State:
    """The state at the end of an iteration from ``here`` that would end at ``there``.

    A point that has closed again and again penetrates where it is open, and pulls where it is closed with the others. In
    the linear problem a pressure on it changes theirs in proportion, which the two solutions tell; the first of them
    that it brings to nothing opens, and so on until the point presses (principal pivoting, Cottle and Dantzig 1968).
    What pulls when it does opens too, one after the other.
    closings: (n,) how often each multiplier has closed in the step; patience: times from which on a point may take the
    place of another; advance: the linear solution with a state's status. Without it
    the benchmark "beam-on-sharp-end-lower" jumps to a branch without contact."""
    pressures = _pressures(system)
    pulls = pressures & here.closed & (closings >= patience) & (there.multipliers < 0.0)
    if not pulls.any():
        return there
    point = int(np.argmin(np.where(pulls, there.multipliers, 0.0)))
    without = advance(_opened(system, here, point))
    if system.gap(without)[point] >= 0.0:
        return there
    state, result = here, there
    while (other := _gives_way(pressures & state.closed, point, without, result)) is not None:
        state = _opened(system, state, other)
        result = advance(state)
        if result.multipliers[point] > 0.0:
            return _relieved(system, state, result, point, pressures, advance)
        without = advance(_opened(system, state, point))
    return there


def _relieved(
    system: Linearised, state: State, result: State, point: int, pressures: NDArray[np.bool_], advance: Advance
) -> State:
    """Without the points that pull where ``point`` presses, one after the other, as long as it does."""
    while (pulls := pressures & state.closed & (result.multipliers < 0.0)).any():
        state = _opened(system, state, int(np.argmin(np.where(pulls, result.multipliers, 0.0))))
        other = advance(state)
        if other.multipliers[point] <= 0.0:
            break
        result = other
    return result


def _pressures(system: Linearised) -> NDArray[np.bool_]:
    """(n,) multipliers that are pressures of points which open where they pull."""
    result = np.zeros(len(system), dtype=bool)
    for pair, part in zip(system.pairs, system.split(result)):
        if not (pair.decided or pair.smooth):
            part[pair.normal] = True
    return result


def _gives_way(others: NDArray[np.bool_], point: int, without: State, pulled: State) -> int | None:
    """Which of ``others`` (n,) is first without pressure when ``point`` presses more and more, from two solutions: without
    it, and where it pulls. None: none."""
    change = (pulled.multipliers - without.multipliers) / pulled.multipliers[point]
    falls = others & (change < 0.0) & (np.arange(len(others)) != point)
    if not falls.any():
        return None
    lasts = np.where(falls, np.maximum(without.multipliers, 0.0) / np.where(falls, -change, 1.0), np.inf)
    return int(np.argmin(lasts))


def _opened(system: Linearised, state: State, point: int) -> State:
    """With one pressure, and the tractions that it carries, open."""
    status, first = state.status.copy(), 0
    for pair in system.pairs:
        if first <= point < first + len(pair):
            index = pair.index[point - first] if not pair.tied else np.array([point - first])
            status[first + index[index >= 0]] = OPEN
        first += len(pair)
    return state.with_status(status)
