"""Linear elasticity whose stiffness and expansion depend on the direction, at points: theory (A1) to (A4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from abut.materials.directions import PAIRS, turned
from abut.materials.evaluated import Array, Evaluated
from abut.materials.material import OwnMaterial

FIRST, SECOND = np.array(PAIRS).T


@dataclass(frozen=True)
class Directional(OwnMaterial):
    """At n points. stiffness: (n or 1, 6, 6) of local strains, shear doubled; frame: (n or 1, 3, 3) rows are the local
    directions; swelling: (n, 3) thermal strains along these, None without; constant: whether the stiffness is that at any
    temperature. Strains that it takes are whole ones, in global axes."""

    stiffness: Array
    frame: Array
    swelling: Array | None = None

    @property
    def modulus(self) -> float:
        """Young's modulus, as a scale, as in ``Material``."""
        return mean_modulus(self.stiffness[0])

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        """Stresses, tangents and histories at n points, as in ``Material``."""
        turn = turned(self.frame)
        local = _applied(turn, strain)
        if self.swelling is not None:
            local[:, :3] -= self.swelling
        return self._told(turn, _applied(self.stiffness, local), self.stiffness, history)

    def evaluate_finite(self, strain: Array, history: Array) -> Evaluated:
        """Stresses, tangents and histories at n points under finite strains, as in ``FiniteMaterial``: the law of Saint
        Venant and Kirchhoff; heat stretches along the local directions, theory (A3)."""
        if self.swelling is None:
            return self.evaluate(strain, history)
        turn, stretch = turned(self.frame), 1.0 + self.swelling
        both, volume = stretch[:, FIRST] * stretch[:, SECOND], np.prod(stretch, axis=1)
        local = _applied(turn, strain)
        local[:, :3] -= 0.5 * (stretch**2 - 1.0)
        stress = volume[:, None] * _applied(self.stiffness, local / both) / both
        tangent = volume[:, None, None] * self.stiffness / (both[:, :, None] * both[:, None, :])
        return self._told(turn, stress, tangent, history)

    @staticmethod
    def _told(turn: Array, stress: Array, tangent: Array, history: Array) -> Evaluated:
        n, back = len(history), np.swapaxes(turn, 1, 2)
        return _applied(back, stress), np.broadcast_to(back @ tangent @ turn, (n, 6, 6)), history


def mean_modulus(stiffness: Array) -> float:
    """Geometric mean of Young's moduli along the local directions."""
    return float(np.prod(np.diag(np.linalg.inv(stiffness))[:3]) ** (-1.0 / 3.0))


def _applied(matrix: Array, vectors: Array) -> Array:
    """Matrices (n or 1, 6, 6) times vectors (n, 6)."""
    if len(matrix) == 1:
        return np.asarray(vectors @ matrix[0].T)
    return np.asarray((matrix @ vectors[..., None])[..., 0])
