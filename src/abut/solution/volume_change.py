"""How well bodies that hardly change their volume keep it: the certificate's line "volume change"."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.solution.contacts import Check

LIMIT, NOTICED = 0.3, 0.1  # of the largest strain, theory (E13): sound cells have 0.03 at most


@dataclass(frozen=True)
class Growth:
    """A change of volume over the volume; explained: what pressure over bulk modulus, and heat, make of it."""

    total: float
    explained: float

    @property
    def unexplained(self) -> float:
        """What is left, in size."""
        return abs(self.total - self.explained)

    def __str__(self) -> str:
        return f"{self.total:.3g} (pressure over bulk modulus {self.explained:.3g})"


@dataclass(frozen=True)
class VolumeChange:
    """Of the bodies that hardly change their volume, the one whose cell does so most without a reason.

    body: its name; worst: of that cell, place: (dim,) its middle, undeformed; largest: the largest change of a cell of that
    body, largest_place: where; whole: of the body; strain: the largest of a cell of all these bodies. Of tetrahedra whose
    pressures are at corners what is about a corner stands for a cell.
    """

    body: str
    worst: Growth
    place: NDArray[np.float64]
    largest: Growth
    largest_place: NDArray[np.float64]
    whole: Growth
    strain: float

    @property
    def check(self) -> Check:
        """The line of the certificate."""
        at, most = (", ".join(f"{x:.4g}" for x in place) for place in (self.place, self.largest_place))
        meaning = (
            "change of volume of a cell that pressure over bulk modulus does not explain, over the largest strain, of "
            f"bodies that hardly change it: most in '{self.body}' at ({at}), {self.worst}; largest change of a cell there "
            f"{self.largest} at ({most}), of the body {self.whole}"
        )
        return Check("", "volume change", self.worst.unexplained / self.strain, LIMIT, meaning, notice=NOTICED)
