"""Masses and dashpots at points as a term with rates: all that it takes, outside of abut."""

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
class Inertia:
    """mass, damping: force over acceleration and over velocity, at each node of a surface."""

    on: str
    mass: float
    damping: float = 0.0

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
    constant: bool = False

    def evaluate(self, before: Motion, now: Motion) -> Share:
        assert now.rates is not None, "the physics of a model with inertia have a time integration"
        (by_velocity, by_acceleration), mass, damping = now.rates.slopes, self.given.mass, self.given.damping
        force, diagonal = np.zeros(self.size), np.zeros(self.size)
        force[self.at] = mass * now.rates.accelerations[self.at] + damping * now.rates.velocities[self.at]
        diagonal[self.at] = mass * by_acceleration + damping * by_velocity
        return Share(force, MatrixTangent(sp.diags(diagonal).tocsr()))
