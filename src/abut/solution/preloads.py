"""What the sections of preloads carry at the end of a step, and the lines of the certificate about them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.solution.contacts import Check

REACHED = 1e-6  # of the tension that is given, or of what a locked section has been shortened by
LOOSE = 0.5  # nothing between 0 and 1
WEAK = 1e-3  # of the forces that weak springs may carry


@dataclass(frozen=True)
class PreloadResult:
    """A preload's section at the end of a step. tension: along its normal, force; shortening: how far its sides are drawn
    over each other, length; force (dim,), moment (1,) or (3,): what the side before the section exerts on that beyond it,
    about the middle of the section (zero if axisymmetric); prescribed: tension that is given at the time, None where the
    shortening is; kept: shortening that a locked one had when it was locked, else None."""

    tension: float
    shortening: float
    force: NDArray[np.float64]
    moment: NDArray[np.float64]
    prescribed: float | None
    kept: float | None = None

    @property
    def error(self) -> float:
        """What is missing of what is prescribed or kept, over it."""
        if self.kept is not None:
            return abs(self.shortening - self.kept) / max(abs(self.kept), 1e-300)
        if self.prescribed is None:
            return 0.0
        return abs(self.tension - self.prescribed) / max(abs(self.prescribed), abs(self.tension), 1e-300)


def preload_checks(steps: Sequence[Mapping[str, PreloadResult]]) -> list[Check]:
    """Over the steps, with what every bolt carries; none without preloads."""
    names = list(steps[0]) if steps else []
    if not names:
        return []
    error, worst = max((step[name].error, name) for step in steps for name in names)
    tensions = {name: [step[name].tension for step in steps] for name in names}
    loose = ", ".join(repr(name) for name, values in tensions.items() if min(values) < 0.0)
    ranges = ", ".join(f"{name!r} {min(values):.6g} to {max(values):.6g}" for name, values in tensions.items())
    return [
        Check("", "preload", error, REACHED,
              f"what is missing of a tension, or of a shortening that is locked, over it, at most, in {worst!r}"),
        Check("", "loose bolts", float(bool(loose)), LOOSE,
              "1 where the section of a preload carries compression, which a bolt does not"
              f"{': ' * bool(loose)}{loose}; tensions over the steps: {ranges}"),
    ]  # fmt: skip


def weak_checks(forces: Sequence[NDArray[np.float64]], reference: float) -> list[Check]:
    """Of springs that are there to keep loose parts in place; none without. reference: the size of the forces."""
    if not forces:
        return []
    most = max(float(np.linalg.norm(force)) for force in forces)
    return [
        Check("", "weak springs", most / reference, WEAK, "largest force of weak springs over the size of the forces")
    ]
