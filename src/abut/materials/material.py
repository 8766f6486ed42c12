"""What a material is: a function from strains and histories at many points to stresses, tangents and new histories.

Components are xx yy zz xy yz zx; shear strains are doubled (engineering), so that stress times strain is work and the
tangent of a hyperelastic material is symmetric. Axisymmetric: xx radial, yy axial, zz hoop, xy their shear. Strains are
small and without those of temperature; plane strain has zeros out of the plane, and in plane stress the caller finds the
strains out of the plane (``abut.materials.plane_stress``). Stress and tangent: force per area.
"""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Evaluated = tuple[Array, Array, Array]  # stress (n, 6), tangent d stress / d strain (n, 6, 6), new history (n, h)


@runtime_checkable
class Material(Protocol):
    """What bodies ask of their material; every class with these will do. Points are independent of each other."""

    @property
    def density(self) -> float:
        """Mass per volume, used by gravity."""
        ...

    @property
    def expansion(self) -> float:
        """Thermal expansion per degree, alike in all directions."""
        ...

    @property
    def constant(self) -> bool:
        """Whether the tangent never changes and there is no history: the stress is linear in the strain."""
        ...

    @property
    def modulus(self) -> float:
        """Young's modulus at rest or another measure of how stiff it is, > 0, force per area: a scale, no result
        depends on it."""
        ...

    def initial(self, n: int) -> Array:
        """The history of n points before anything has happened, (n, h); h = 0 for a material without."""
        ...

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        """Stress (n, 6), tangent (n, 6, 6) and new history (n, h) at strains (n, 6), after a history (n, h) that is not
        to be changed in place."""
        ...


class OwnMaterial:
    """What a user's own material may inherit: ``evaluate``, as in ``Material``, and ``modulus`` are left to be written."""

    density = 0.0
    expansion = 0.0
    constant = False

    def initial(self, n: int) -> Array:
        """No history: (n, 0)."""
        return np.zeros((n, 0))
