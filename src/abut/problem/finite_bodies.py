"""Bodies under finite strains as a term of the balance of forces."""

from __future__ import annotations

from dataclasses import dataclass

from abut.bodies.finite import is_symmetric
from abut.bodies.solids import TemperatureChange
from abut.bodies.stress import PointStress
from abut.model import Model
from abut.model.conditions import weights
from abut.problem.backend import Backend
from abut.problem.loads import Loads
from abut.problem.terms import Motion, Share, Vector


@dataclass(frozen=True)
class FiniteBodies:
    """Hyperelastic bodies under finite strains, theory (D2). ``evaluate`` and ``stress`` raise
    ``abut.bodies.inverted.Inverted`` at displacements that turn a cell inside out."""

    model: Model
    loads: Loads
    backend: Backend
    name: str = "bodies"
    constant: bool = False

    def evaluate(self, before: Motion, now: Motion) -> Share:
        """As in ``Term``."""
        deformed = self.backend.deform(*self._at(now))
        symmetric = is_symmetric(self.model.deformable)
        return Share(deformed.force, deformed.tangent, symmetric=symmetric, energy=deformed.energy)

    def stress(self, motion: Motion) -> PointStress:
        """As in ``Bodies``: Cauchy stresses."""
        return self.backend.stress(*self._at(motion))

    def energy(self, motion: Motion) -> float:
        """Elastic energy of all bodies, force times length (per unit thickness in 2D)."""
        return self.backend.deform(*self._at(motion), tangent=False).energy

    def _at(self, motion: Motion) -> tuple[Vector, TemperatureChange]:
        temperature = self.loads.temperature @ weights(self.model.histories, motion.time)
        change = TemperatureChange(self.model.temperatures(motion.time), temperature)
        return motion.displacement.reshape(len(temperature), -1), change
