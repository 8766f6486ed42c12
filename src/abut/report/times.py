"""The axis of what is drawn over the steps."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from abut.model import Model
from abut.solution import Solution
from abut.types import Json

SHARE = "time (share of the load, where no amplitude says otherwise)"


def time_label(model: Model) -> str:
    """What the axis says; where the run has an end of its own, times are those of the job file."""
    return SHARE if model.solve.end == 1.0 else "time"


def time_at(model: Model, shares: Any) -> NDArray[np.float64]:
    """Times from shares of the end."""
    return np.asarray(shares, dtype=float) * model.solve.end


def time_axis(solution: Solution) -> Json:
    """For the page's script: times at the ends of the steps, and what the axis says."""
    times = [step.time for step in solution.steps]
    return {"time": times, "label": time_label(solution.model)}
