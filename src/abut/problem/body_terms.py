"""Bodies and loads that keep their direction, as terms of the balance of forces."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from abut.bodies.assemble import is_symmetric
from abut.bodies.solids import TemperatureChange
from abut.bodies.stress import PointStress
from abut.model import History as Amplitude
from abut.model import Model
from abut.model.conditions import weights
from abut.model.physics import TEMPERATURE
from abut.problem.backend import Backend
from abut.problem.loads import Loads
from abut.problem.terms import Motion, Share, Term

Vector = NDArray[np.float64]


class Bodies(Term, Protocol):
    """A term that has stresses."""

    def stress(self, motion: Motion) -> PointStress:
        """At the integration points."""
        ...


@dataclass(frozen=True)
class LinearBodies:
    """Linear elastic bodies under small strains: force = K u; their thermal strains are loads. temperatures: change of
    temperature of each body as a whole at a time."""

    backend: Backend
    loads: Loads
    histories: Sequence[Amplitude]
    temperatures: Callable[[float], Mapping[str, float]]
    name: str = "bodies"
    constant: bool = True

    def evaluate(self, before: Motion, now: Motion) -> Share:
        """Force, tangent and history at a state, as in ``Term``; the tangent is the backend."""
        return Share(self.backend.internal(now.displacement), self.backend)

    def stress(self, motion: Motion) -> PointStress:
        """Stresses at integration points, as in ``Bodies``."""
        temperature = self.loads.temperature @ weights(self.histories, motion.time)
        change = TemperatureChange(self.temperatures(motion.time), temperature)
        return self.backend.stress(motion.displacement.reshape(len(temperature), -1), change)


@dataclass(frozen=True)
class SolidBodies:
    """Bodies of any material, those of users' own among them, under small or finite strains, theory (D2). ``evaluate`` and
    ``stress`` raise ``abut.bodies.inverted.Inverted`` at displacements that turn a cell inside out under finite ones."""

    model: Model
    loads: Loads
    backend: Backend
    name: str = "bodies"
    constant: bool = False

    def evaluate(self, before: Motion, now: Motion) -> Share:
        """Force, tangent and history at a state, as in ``Term``."""
        since = None if self.model.small_strains else now.since
        moved, change, history = self._at(now, before.history)
        change = lasting(self.model, change, before, now)
        deformed = self.backend.deform(moved, change, history, since=since)
        symmetric = is_symmetric(self.model.deformable)
        energy = None if self.model.small_strains else deformed.energy
        return Share(deformed.force, deformed.tangent, deformed.history, symmetric, energy)

    def stress(self, motion: Motion) -> PointStress:
        """Stresses at integration points, as in ``Bodies``: Cauchy stresses under finite strains."""
        return self.backend.stress(*self._at(motion, motion.history))

    def _at(
        self, motion: Motion, history: Mapping[str, Vector]
    ) -> tuple[Vector, TemperatureChange, Mapping[str, Vector] | None]:
        change = heated(self.model, self.loads, motion)
        return motion.displacement.reshape(self.model.mesh.points.shape), change, history or None


def heated(model: Model, loads: Loads, motion: Motion) -> TemperatureChange:
    """The change of temperature of bodies: what loads prescribe, and a field of temperatures."""
    temperature = loads.temperature @ weights(model.histories, motion.time)
    if TEMPERATURE in motion.fields:
        temperature = temperature + motion.fields[TEMPERATURE][:, 0]
    return TemperatureChange(model.temperatures(motion.time), temperature)


def lasting(model: Model, change: TemperatureChange, before: Motion, now: Motion) -> TemperatureChange:
    """The same with the time from ``before``, whose history materials are given, to ``now``."""
    return replace(change, elapsed=(now.time - before.time) * model.solve.end)


@dataclass(frozen=True)
class DeadLoads:
    """Loads that keep their direction and place; histories: of the columns of ``loads``."""

    loads: Loads
    histories: Sequence[Amplitude]
    name: str = "loads"
    constant: bool = True

    def evaluate(self, before: Motion, now: Motion) -> Share:
        """Force, tangent and history at a state, as in ``Term``."""
        return Share(-(self.loads.forces @ weights(self.histories, now.time)))
