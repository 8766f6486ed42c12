"""Where contact with friction closes next: half spaces tell, as without friction, and what closes sticks at first."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.linear.solver import Prepared
from abut.solution.state import CLOSED, OPEN, State


def foreseen(solver: Prepared, state: State, wanted: NDArray[np.int8]) -> NDArray[np.int8]:
    """The status (n,) to go on with where the laws ask for ``wanted``: closed where half spaces without friction close.
    Which of those stick and slip only a solution tells."""
    system = solver.system
    beside = system.tied | system.join([np.arange(len(p)) >= (len(p.space) if p.frictional else len(p)) for p in system.pairs])
    closed = solver.foresee(system.gap(state), state.multipliers, (wanted != OPEN) | beside, beside)
    result = [
        status if pair.tied else np.where(own, np.where(status == OPEN, CLOSED, status), OPEN)
        for pair, status, own in zip(system.pairs, system.split(wanted), map(_of_pair, system.pairs, system.split(closed)))
    ]
    return system.join(result)
