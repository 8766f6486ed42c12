"""How accurately Newton's method asks for linear systems to be solved where that is done iteratively."""

from __future__ import annotations

import numpy as np

from abut.nonlinear.settings import Settings
from abut.problem.linearised import NOTHING


def forcing(error: float, before: float, settings: Settings) -> float:
    """The part of the residual that a linear solution may leave: that of Eisenstat and Walker 1996 (their choice 2), and no
    less than the last iteration needs. error, before: what is left now, and was an iteration ago (infinite in the first)."""
    asked = settings.accuracy
    wanted = asked.share * (error / before) ** 2 if np.isfinite(before) else asked.rough
    last = asked.spare * settings.newton.balanced / max(error, NOTHING)
    return float(np.clip(wanted, min(max(asked.fine, last), asked.rough), asked.rough))
