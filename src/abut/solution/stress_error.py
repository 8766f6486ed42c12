"""How far the stresses of the elements are off, by estimate (Zienkiewicz and Zhu 1987), at the end of a step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

MEANING = (
    "estimated error of the elements' stresses in the energy norm, of the whole model or near contact; "
    "what nodes show is closer"
)
AIM = 0.05  # relative error in the energy norm that engineers ask for (Zienkiewicz and Zhu 1987)


@dataclass(frozen=True)
class ContactStressError:
    """The estimate in the cells of a body near pressed facets, theory (Z8). error: relative; size: length of these facets;
    wanted: the length that would bring the error to ``AIM``: it falls like the length, with cells of second order too, since
    the stress has a root at the edge of contact."""

    contact: str
    body: str
    error: float
    size: float
    wanted: float


@dataclass(frozen=True)
class StressError:
    """The difference between recovered and element stress in the energy norm.

    cells: (n_cells,) of each cell relative to its body, per volume: their root mean square over the body by volume is its
    error, theory (Z7); whole: relative, of all bodies; energy: of the recovered stresses, twice the elastic energy; near:
    where bodies touch."""

    cells: NDArray[np.float64]
    whole: float
    energy: float
    near: Sequence[ContactStressError]

    @property
    def stiffer(self) -> float:
        """Share by which the strain energy of bodies that are moved or fitted, not loaded, is too high, and about that by
        which their contacts press too much in the mean: theory (Z8)."""
        return self.whole**2

    def meaning(self, loaded: bool) -> str:
        """What the certificate says of it; loaded: whether forces act, which contacts then carry whatever the mesh is."""
        mean = (
            f"; up to about {self.stiffer:.1%} too much pressure in the mean, as no loads set it" if not loaded else ""
        )
        return f"{MEANING}{mean}"

    @property
    def largest(self) -> float:
        """Of the whole model and where bodies touch."""
        return max([self.whole, *(e.error for e in self.near)])

    @property
    def coarse(self) -> Sequence[ContactStressError]:
        """Where bodies touch and more than ``AIM`` is off, the worst first."""
        return sorted((e for e in self.near if e.error > AIM), key=lambda e: -e.error)
