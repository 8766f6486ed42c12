"""Masses at points as a term with rates, which it keeps in its history: all that it takes, outside of abut."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from abut import Model
from abut.dofs import DISPLACEMENT, Dofs, Field
from abut.mesh.mesh import Mesh
from abut.model.conditions import History
from abut.model.physics import Held
from abut.problem.terms import MatrixTangent, Motion, Share
from abut.types import Array


@dataclass(frozen=True)
class Newmark:
    """Average acceleration (gamma = 1/2, beta = 1/4): a1 = 4 (u1 - u0) / h^2 - 4 v0 / h - a0, v1 = v0 + h (a0 + a1) / 2."""

    step: float

    def rates(self, moved: Array, velocity: Array, acceleration: Array) -> tuple[Array, Array]:
        """At the end of a step over which points have moved by so much."""
        h = self.step
        after = 4.0 * moved / h**2 - 4.0 * velocity / h - acceleration
        return velocity + 0.5 * h * (acceleration + after), after


@dataclass(frozen=True)
class Inertia:
    """mass: at each node of a surface; duration: of the time from 0 to 1; begins: acceleration (dim,) at the start."""

    on: str
    mass: float
    duration: float
    begins: tuple[float, ...]

    @property
    def amplitudes(self) -> Sequence[History]:
        return []

    def fields(self, mesh: Mesh) -> Sequence[Field]:
        return []

    def held(self, model: Model, dofs: Dofs) -> Sequence[Held]:
        return []

    def terms(self, model: Model, dofs: Dofs) -> Sequence[InertiaTerm]:
        return [InertiaTerm(self, dofs.of(DISPLACEMENT, model.mesh.surface(self.on).node_ids), dofs.size)]


@dataclass(frozen=True)
class InertiaTerm:
    """at: (n, dim) where the displacements of points stand, of ``size`` in all."""

    given: Inertia
    at: Array
    size: int
    name: str = "inertia"
    constant: bool = True

    def evaluate(self, before: Motion, now: Motion) -> Share:
        h = (now.time - before.time) * self.given.duration
        first = {"velocity": np.zeros(self.at.shape), "acceleration": np.zeros(self.at.shape) + self.given.begins}
        known = {**first, **before.history}
        if h == 0.0:
            velocity, acceleration, slope = known["velocity"], known["acceleration"], 0.0
        else:
            moved = now.displacement[self.at] - before.displacement[self.at]
            velocity, acceleration = Newmark(h).rates(moved, known["velocity"], known["acceleration"])
            slope = self.given.mass * 4.0 / h**2
        force = np.zeros(self.size)
        force[self.at] = self.given.mass * acceleration
        diagonal = np.zeros(self.size)
        diagonal[self.at] = slope
        return Share(
            force, MatrixTangent(sp.diags(diagonal).tocsr()), {"velocity": velocity, "acceleration": acceleration}
        )
