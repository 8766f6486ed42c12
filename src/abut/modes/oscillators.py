"""Single oscillators, one for each mode: steady vibrations, and motion under forces that are linear between given times."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

Vector = NDArray[np.float64]
Complex = NDArray[np.complex128]
SAME_STEP = 1e-9  # relative difference of steps that share their matrices


@dataclass(frozen=True)
class Oscillators:
    """omega: (n,) angular frequencies, >= 0; damping: (n,) shares of critical damping. Their masses are 1."""

    omega: Vector
    damping: Vector

    def amplitudes(self, angular: Vector) -> Complex:
        """(m, n) under unit forces that go as exp(i angular t), theory (J9)."""
        square = self.omega**2 - angular[:, None] ** 2
        return np.asarray(1.0 / (square + 2j * self.damping * self.omega * angular[:, None]))

    def motion(self, times: Vector, forces: Vector) -> Vector:
        """(m, n) displacements at times (m,), growing, from rest, under forces (m, n) that are linear between these: exact,
        theory (J10)."""
        result, known = np.zeros(forces.shape), dict[float, Vector]()
        speed = np.zeros(forces.shape[1])
        for i, step in enumerate(np.diff(times)):
            key = float(f"{step:.9e}")
            if key not in known:
                known[key] = self._over(float(step))
            rate = np.maximum(self.omega, 1.0 / step)  # numbers of one size
            before = np.stack([result[i], speed / rate, forces[i] / rate**2, (forces[i + 1] - forces[i]) / rate**2])
            result[i + 1], speed = np.einsum("nij,jn->in", known[key], before)
            speed = speed * rate
        return result

    def _over(self, step: float) -> Vector:
        """(n, 2, 4) displacement and speed over rate after a step, by those before, force, and its change in the step."""
        rate = np.maximum(self.omega, 1.0 / step)
        matrix = np.zeros((len(rate), 4, 4))
        matrix[:, 0, 1] = rate * step
        matrix[:, 1, 0] = -(self.omega**2) / rate * step
        matrix[:, 1, 1] = -2.0 * self.damping * self.omega * step
        matrix[:, 1, 2] = rate * step
        matrix[:, 2, 3] = 1.0
        return np.asarray(expm(matrix)[:, :2])


def shares(omega: Vector, given: float | tuple[float, ...], rayleigh: tuple[float, float]) -> Vector:
    """(n,) of critical damping; given: of all, or of the first ones. What Rayleigh's coefficient of the mass does to a
    motion without stiffness is left out."""
    result = np.zeros(len(omega))
    if isinstance(given, tuple):
        result[: len(given)] = given[: len(omega)]
    else:
        result[:] = given
    moving = omega > 0.0
    result[moving] += 0.5 * (rayleigh[0] / omega[moving] + rayleigh[1] * omega[moving])
    return result
