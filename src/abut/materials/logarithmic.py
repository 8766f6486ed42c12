"""Materials in the space of logarithmic strains, theory (Y8), (Y9), (Y10): E = ln U, and the stress conjugate to it.

Any law for small strains, with a history or none, becomes one for finite strains so; Hencky's is linear elasticity there.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from abut._core import PointLaw, hooke
from abut.materials.elastic import LinearElastic, bulk_and_shear, without_bulk
from abut.materials.kernel import Compiled, PointKernel
from abut.materials.material import Array, Evaluated
from abut.materials.volume_split import LogSquared, VolumeSplit


@dataclass(frozen=True)
class Hencky:
    """Logarithmic (Hencky's) elasticity: the stress conjugate to ln U is linear in it.

    For kinematics "finite"; linear elastic under small strains.

    Parameters
    ----------
    young : float
        Young's modulus [force per area], > 0.
    poisson : float
        Poisson's ratio, between -1 and 0.5.
    density : float
        Mass per undeformed volume, used by gravity.
    expansion : float
        Thermal expansion [1/temperature], used by temperature changes.

    Raises
    ------
    InputError
        For values out of these ranges.

    Examples
    --------
    >>> import abut
    >>> abut.Hencky(young=210e3, poisson=0.3).linear.young
    210000.0
    """

    young: float
    poisson: float
    density: float = 0.0
    expansion: float = 0.0

    def __post_init__(self) -> None:
        LinearElastic(self.young, self.poisson, self.density, self.expansion)

    @cached_property
    def linear(self) -> LinearElastic:
        """The material that it is under small strains."""
        return LinearElastic(self.young, self.poisson, self.density, self.expansion)

    @property
    def constant(self) -> bool:
        """False, as in ``Material``."""
        return False

    @property
    def small(self) -> bool:
        """False, as in ``OwnMaterial``: that is what linear elasticity is for."""
        return False

    @property
    def symmetric(self) -> bool:
        """True, as in ``OwnMaterial``."""
        return True

    @property
    def modulus(self) -> float:
        """Young's modulus."""
        return self.young

    def initial(self, n: int) -> Array:
        """It has no history: (n, 0)."""
        return np.zeros((n, 0))

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        """Stresses, tangents and histories at n points, as in ``Material``."""
        return self.linear.evaluate(strain, history)

    def evaluate_finite(self, strain: Array, history: Array) -> Evaluated:
        """Stresses, tangents and histories at n points under finite strains, as in ``FiniteMaterial``."""
        return evaluated(_hooke(self.linear), strain, history, finite=True)

    def compiled(self, finite: bool) -> Compiled | None:
        """The compiled law, as in ``OwnMaterial``."""
        return Compiled(PointKernel(_hooke(self.linear), True)) if finite else self.linear.compiled(False)

    def volume_split(self, finite: bool) -> VolumeSplit | None:
        """What the change of volume alone adds to energy and stress, as in ``OwnMaterial``."""
        if not finite or not self.poisson > 0.0:
            return self.linear.volume_split(False)
        bulk, rest = without_bulk(self.linear)
        return VolumeSplit(replace(self, young=rest.young, poisson=rest.poisson), LogSquared(bulk))


def _hooke(material: LinearElastic) -> PointLaw:
    return hooke(*bulk_and_shear(material.young, material.poisson))


def evaluated(law: PointLaw, strain: Array, history: Array, finite: bool) -> Evaluated:
    """Of a law of the compiled core at points."""
    result: Evaluated = law.evaluate(
        np.ascontiguousarray(strain, dtype=float), np.ascontiguousarray(history, dtype=float), finite
    )
    return result
