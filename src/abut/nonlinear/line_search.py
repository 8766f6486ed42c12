"""The one line search: a step is halved until it leaves no more than before."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from abut.nonlinear.settings import Settings

Trial = TypeVar("Trial")


def shortened(
    full: Trial, part: Callable[[float], Trial], size: Callable[[Trial], float], limit: float, settings: Settings
) -> tuple[Trial, bool]:
    """The step to take, and whether it leaves no more than before.

    full: the whole step; part: a share of it; size: what one leaves open; limit: what was left before."""
    share, best = 1.0, full
    for _ in range(settings.newton.halvings):
        if size(best) <= max(limit, settings.newton.balanced):
            return best, True
        share *= 0.5
        best = part(share)
    return best, False
