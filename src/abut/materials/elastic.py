"""Materials: frozen records that check themselves."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from abut import checks
from abut._core import Hyperelastic
from abut.errors import InputError
from abut.materials.evaluated import Array, Evaluated
from abut.materials.kernel import Compiled, HyperelasticKernel, Isotropic
from abut.materials.volume_split import Powers, VolumeSplit

INCOMPRESSIBLE = 1e7  # bulk over shear modulus at most: volumes change by 1e-7 p / mu, half of the digits are left


@dataclass(frozen=True)
class LinearElastic:
    """Isotropic linear elasticity.

    Parameters
    ----------
    young : float
        Young's modulus [force per area], > 0.
    poisson : float
        Poisson's ratio, between -1 and 0.5; 0.5 itself for cells that can bear it (integration "mixed", "b-bar" or
        "reduced", or plane stress), where the bulk modulus is ``INCOMPRESSIBLE`` times that of shear.
    density : float
        Mass per volume, used by gravity.
    expansion : float
        Thermal expansion [1/temperature], used by temperature changes.

    Raises
    ------
    InputError
        For values out of these ranges.

    Examples
    --------
    >>> import abut
    >>> steel = abut.LinearElastic(young=210e3, poisson=0.3)  # N, mm
    >>> steel.expansion
    0.0
    """

    young: float
    poisson: float
    density: float = 0.0
    expansion: float = 0.0

    def __post_init__(self) -> None:
        checks.positive(self.young, "young")
        if not -1.0 < checks.finite(self.poisson, "poisson") <= 0.5:
            raise InputError(f"poisson: expected -1 < nu <= 0.5, got {self.poisson!r}")
        if checks.finite(self.density, "density") < 0.0:
            raise InputError(f"density: expected a number >= 0, got {self.density!r}")
        checks.finite(self.expansion, "expansion")

    @property
    def constant(self) -> bool:
        """True, as in ``Material``."""
        return True

    @property
    def modulus(self) -> float:
        """Young's modulus."""
        return self.young

    @property
    def linear(self) -> LinearElastic:
        """Itself, as in ``OwnMaterial``."""
        return self

    def compiled(self, finite: bool) -> Compiled | None:
        """The compiled law, as in ``OwnMaterial``; under finite strains the law of Saint Venant and Kirchhoff."""
        law = HyperelasticKernel(Hyperelastic.SAINT_VENANT_KIRCHHOFF) if finite else Isotropic()
        return Compiled(law, lame(self, None))

    def volume_split(self, finite: bool) -> VolumeSplit | None:
        """What the change of volume alone adds to energy and stress, as in ``OwnMaterial``; the law of Saint Venant and
        Kirchhoff has no part of the volume alone."""
        if finite or not self.poisson > 0.0:
            return None
        bulk, rest = without_bulk(self)
        return VolumeSplit(rest, Powers([0.5 * bulk]))

    def initial(self, n: int) -> Array:
        """It has no history: (n, 0)."""
        return np.zeros((n, 0))

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        """Stresses, tangents and histories at n points, as in ``Material``."""
        lambda_, mu = lame(self, None)
        tangent = np.diag([2.0 * mu] * 3 + [mu] * 3)
        tangent[:3, :3] += lambda_
        return strain @ tangent, np.broadcast_to(tangent, (len(strain), 6, 6)), history


def without_bulk(material: LinearElastic) -> tuple[float, LinearElastic]:
    """What of the bulk modulus is beyond 2/3 of that of shear, and the material, with that of shear, that has no more."""
    bulk, shear = bulk_and_shear(material.young, material.poisson)
    return bulk - 2.0 * shear / 3.0, replace(material, young=2.0 * shear, poisson=0.0)


def lame(material: LinearElastic, plane: str | None) -> tuple[float, float]:
    """Lame's constants; in plane stress lambda is the reduced one."""
    young, poisson = material.young, material.poisson
    mu = young / (2.0 * (1.0 + poisson))
    if plane == "stress":
        return young * poisson / (1.0 - poisson**2), mu
    return bulk_and_shear(young, poisson)[0] - 2.0 * mu / 3.0, mu


def bulk_and_shear(young: float, poisson: float) -> tuple[float, float]:
    """Moduli [force per area]; at a Poisson's ratio of 0.5 the bulk modulus is ``INCOMPRESSIBLE`` times that of shear."""
    shear = young / (2.0 * (1.0 + poisson))
    most = INCOMPRESSIBLE * shear
    return (most if most * 3.0 * (1.0 - 2.0 * poisson) <= young else young / (3.0 * (1.0 - 2.0 * poisson))), shear
