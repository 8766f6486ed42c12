"""How far metal has yielded at the end of a load step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.solution.contacts import Check

SMALL, SMALL_NOTICED = 0.1, 0.03  # of plastic strains that small kinematics takes for small
LARGE = 1.0  # of logarithmic ones: cells are stretched to e times their length
NONE = 1e-9  # share of the time
GO_ON = "to go on prescribe displacements in place of loads, or give the hardening that the metal has"


@dataclass(frozen=True)
class LimitLoad:
    """Where loads found no equilibrium, or hardly one. missing: share of the time that was not reached, 0 where the run ends
    near the limit; where: time, forces and place, in words."""

    missing: float
    where: str


@dataclass(frozen=True)
class Flow:
    """largest: equivalent plastic strain at an integration point; body and place: where, place (dim,) the middle of the
    undeformed cell; work: of plastic flow since the beginning (force times length); limit: None where there is an
    equilibrium."""

    largest: float
    body: str
    place: NDArray[np.float64]
    work: float
    limit: LimitLoad | None = None

    def checks(self, finite: bool, loaded: bool) -> list[Check]:
        """The lines of the certificate; of the limit load where there are loads."""
        at = ", ".join(f"{value:.4g}" for value in self.place)
        meaning = f"largest equivalent plastic strain, in '{self.body}' at ({at})"
        limit, notice = (LARGE, np.inf) if finite else (SMALL, SMALL_NOTICED)
        result = [Check("", "plastic strain", self.largest, limit, meaning, notice=notice)]
        if loaded:
            short = "share of the time that is left where metal flows and no load step finds an equilibrium"
            if self.limit is None:
                result.append(Check("", "limit load", 0.0, NONE, short, last=True))
            else:  # worth knowing where the loads are carried to the end, too
                said = f"{short}: {self.limit.where}"
                result.append(Check("", "limit load", self.limit.missing, NONE, said, last=True, notice=-1.0))
        return result
