"""Whether what is prescribed has an effect: bodies that are strained, or that grow freely with their temperature."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.bodies.assemble import thermal_load
from abut.bodies.solids import Solids, TemperatureChange
from abut.problem.balance import Balance

NO_STRAIN = 1e-12  # nodal forces over stiffness times displacement from which down they are rounding


def beyond_rounding(forces: NDArray[np.float64], balance: Balance, displacement: NDArray[np.float64]) -> bool:
    """Whether nodal forces (dim n_points,) are more than what rigid motions leave at displacements (dim n_points,)."""
    stiffest = float(balance.diagonal.max(initial=0.0))
    return bool(np.abs(forces).max(initial=0.0) > NO_STRAIN * stiffest * np.abs(displacement).max(initial=0.0))


def grows(solids: Solids, change: TemperatureChange, balance: Balance, displacement: NDArray[np.float64]) -> bool:
    """Whether a change of temperature makes bodies grow that no stress tells of: nothing holds them back, and the stresses
    that the change would make in them as they were are more than rounding."""
    return beyond_rounding(thermal_load(solids, change), balance, displacement)
