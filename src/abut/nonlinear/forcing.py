"""How accurately Newton's method asks for linear systems to be solved where that is done iteratively."""

from __future__ import annotations

import numpy as np

ROUGH, FINE = 1e-2, 1e-5  # of the residual, that may be left at most, and below which it need not fall
SHARE = 0.5  # of the square of the last reduction
SPARE = 0.1  # of what is left when a step has converged


def forcing(error: float, before: float, balanced: float) -> float:
    """The part of the residual that a linear solution may leave: that of Eisenstat and Walker 1996 (their choice 2), and no
    less than the last iteration needs. error, before: what is left now, and was an iteration ago (infinite in the first);
    balanced: what a converged state may leave."""
    wanted = SHARE * (error / before) ** 2 if np.isfinite(before) else ROUGH
    return float(np.clip(wanted, min(max(FINE, SPARE * balanced / max(error, 1e-300)), ROUGH), ROUGH))
