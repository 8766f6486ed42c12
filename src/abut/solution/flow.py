"""How far metal has yielded at the end of a load step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.solution.contacts import Check

SMALL, SMALL_NOTICED = 0.1, 0.03  # of plastic strains that small kinematics takes for small
LARGE = 1.0  # of logarithmic ones: cells are stretched to e times their length


@dataclass(frozen=True)
class Flow:
    """largest: equivalent plastic strain at an integration point; body and place: where, place (dim,) the middle of the
    undeformed cell; work: of plastic flow since the beginning (force times length)."""

    largest: float
    body: str
    place: NDArray[np.float64]
    work: float

    def check(self, finite: bool) -> Check:
        """The line of the certificate."""
        at = ", ".join(f"{value:.4g}" for value in self.place)
        meaning = f"largest equivalent plastic strain, in '{self.body}' at ({at})"
        limit, notice = (LARGE, np.inf) if finite else (SMALL, SMALL_NOTICED)
        return Check("", "plastic strain", self.largest, limit, meaning, notice=notice)
