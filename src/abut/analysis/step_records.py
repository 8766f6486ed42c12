"""Records of converged steps for a restart, and their attempts from these."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from abut.errors import InputError
from abut.nonlinear.load_step import Attempt
from abut.solution import Saved


def saved_step(attempt: Attempt, linear: str) -> Saved:
    """linear: the solver that was used, "direct" or "amg"."""
    return Saved(attempt.number, attempt.state, attempt.inside, linear, attempt.iterations)


def check_order(resume: Sequence[Saved], n_free: int, n_multipliers: int) -> None:
    """Raise InputError unless the records are those of steps 1, 2, ... of a model of this size."""
    for number, saved in enumerate(resume, start=1):
        sizes = len(saved.state.unknowns), len(saved.state.multipliers)
        if saved.number != number or sizes != (n_free, n_multipliers):
            raise InputError(
                f"resume: expected step {number} with {n_free} displacements and {n_multipliers} multipliers, got step "
                f"{saved.number} with {sizes[0]} and {sizes[1]}; give all steps done before, of the same model, in order"
            )


def restored(saved: Saved) -> Attempt:
    """The load step as it was when it converged."""
    none = np.zeros(len(saved.state.status), dtype=bool)
    return Attempt(saved.number, saved.state, True, saved.iterations, none, saved.inside, saved.state.time)
