"""What solving a load step ends with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.problem.balance import Balance
from abut.solution import Iteration
from abut.solution.state import State

UNSTEADY = "the fluid spreads on with every solution"


@dataclass(frozen=True)
class Attempt:
    """The end of a load step. state: in all free displacements, with history and ``largest`` if it ``converged``; inside:
    (n,) bool, the multipliers in contact that tell where the functions of "dual-P1" are the ordinary ones; cycling: (n,)
    bool, multipliers that keep changing; time: at which it was to end; reason: why it did not converge, where more can be
    said; whole: it ends where a step was asked to, not in between; between, reached: as in ``Found``; balance: the problem
    at the state, None where that is not known."""

    number: int
    state: State
    converged: bool
    iterations: tuple[Iteration, ...]
    cycling: NDArray[np.bool_]
    inside: NDArray[np.bool_]
    time: float
    reason: str = ""
    whole: bool = True
    between: NDArray[np.uint8] | None = None
    balance: Balance | None = None
    reached: State | None = None
