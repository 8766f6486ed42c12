"""Von Mises plasticity with isotropic and Prager's hardening as a user would write it (Simo and Hughes 1998, box 3.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from abut.materials.material import Array, Evaluated, OwnMaterial

ONE = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
HALF = np.array([1.0, 1.0, 1.0, 0.5, 0.5, 0.5])
TWICE = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])


@dataclass(frozen=True)
class J2(OwnMaterial):
    """History: plastic strain (6, shear doubled), equivalent plastic strain, back stress (6)."""

    bulk: float
    shear: float
    start: float
    hardening: float
    kinematic: float
    modulus: float = 1.0

    def initial(self, n: int) -> Array:
        return np.zeros((n, 13))

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        elastic = strain - history[:, :6]
        volume = elastic @ ONE
        deviator = 2.0 * self.shear * (elastic - np.outer(volume, ONE) / 3.0) * HALF
        shifted = deviator - history[:, 7:]
        size = np.sqrt((shifted**2) @ TWICE)
        radius = np.sqrt(2.0 / 3.0) * (self.start + self.hardening * history[:, 6])
        flows = size > radius
        stiff = 2.0 * self.shear + 2.0 / 3.0 * (self.hardening + self.kinematic)
        way = np.where(flows, (size - radius) / stiff, 0.0)
        normal = shifted / np.maximum(size, 1e-300)[:, None]
        stress = self.bulk * np.outer(volume, ONE) + deviator - 2.0 * self.shear * way[:, None] * normal
        theta = 1.0 - 2.0 * self.shear * way / np.maximum(size, 1e-300)
        bar = np.where(flows, 2.0 * self.shear / stiff, 0.0) - (1.0 - theta)
        projection = np.diag(HALF) - np.outer(ONE, ONE) / 3.0
        tangent = self.bulk * np.outer(ONE, ONE) + 2.0 * self.shear * theta[:, None, None] * projection
        tangent -= 2.0 * self.shear * bar[:, None, None] * normal[:, :, None] * normal[:, None, :]
        after = history.copy()
        after[:, :6] += way[:, None] * normal * TWICE
        after[:, 6] += np.sqrt(2.0 / 3.0) * way
        after[:, 7:] += 2.0 / 3.0 * self.kinematic * way[:, None] * normal
        return stress, tangent, after
