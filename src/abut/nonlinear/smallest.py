"""Pressures that are one of many, since equations or rigid bodies move several points of a surface together: of all that
give the same forces on the free displacements the smallest is taken."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from abut.problem.laws import SOFT, LawRows
from abut.problem.linearised import Linearised
from abut.solution.state import State

EXACT = 4.0 * float(np.finfo(float).eps)  # of forces, to which the smallest pressures give the same ones: rounding


def yielding(system: Linearised, laws: Sequence[LawRows]) -> list[LawRows]:
    """Laws for one iteration: gaps that say the same twice give way to a change of their pressures, so that it is unique.
    Residuals stay as they are, and with them the solution."""
    return [
        replace(law, by_pressure=(law.by_pressure + SOFT * law.by_gap @ sp.diags(pair.scale)).tocsr())
        if pair.repeated
        else law
        for pair, law in zip(system.pairs, laws)
    ]


def smallest(system: Linearised, state: State) -> State:
    """The state with the smallest multipliers that give the same forces, where they are one of many."""
    chosen = state.closed & system.join([np.full(len(pair), pair.repeated) for pair in system.pairs]).astype(bool)
    if not chosen.any():
        return state
    size: NDArray[np.float64] = np.sqrt(system.weight[chosen])  # of the pressure's square over the area: even if it can
    forces = (sp.diags(1.0 / size) @ system.columns[chosen]).T.tocsr()
    wanted = forces @ (size * state.multipliers[chosen])
    found = spla.lsmr(forces, wanted, atol=EXACT, btol=EXACT, conlim=1.0 / EXACT, maxiter=10 * len(size))[0]
    multipliers = state.multipliers.copy()
    multipliers[chosen] = found / size
    return replace(state, multipliers=multipliers)
