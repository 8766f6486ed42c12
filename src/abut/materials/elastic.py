"""Materials: frozen records that check themselves."""

from __future__ import annotations

from dataclasses import dataclass

from abut import checks
from abut.errors import InputError


@dataclass(frozen=True)
class LinearElastic:
    """Isotropic linear elasticity.

    young:     Young's modulus, force per area, > 0.
    poisson:   Poisson's ratio, -1 < nu < 0.5.
    density:   mass per volume, used by gravity.
    expansion: thermal expansion per degree, used by temperature changes.
    """

    young: float
    poisson: float
    density: float = 0.0
    expansion: float = 0.0

    def __post_init__(self) -> None:
        checks.positive(self.young, "young")
        if not -1.0 < checks.finite(self.poisson, "poisson") < 0.5:
            raise InputError(f"poisson: expected -1 < nu < 0.5, got {self.poisson!r}")
        if checks.finite(self.density, "density") < 0.0:
            raise InputError(f"density: expected a number >= 0, got {self.density!r}")
        checks.finite(self.expansion, "expansion")
