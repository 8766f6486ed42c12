"""Loads that follow the deformation, as a term of the balance of forces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from abut.bodies.follower import follower_pressure
from abut.bodies.mean_turn import Spread, spread
from abut.dofs import dofs_at
from abut.errors import InputError
from abut.model import Load, Model, Moment, Pressure
from abut.model.conditions import weights
from abut.model.coupling import in_line
from abut.problem.constraints import Constraints
from abut.problem.loads import followers, force_and_moment
from abut.problem.rigid_bodies import RigidBody
from abut.problem.terms import MatrixTangent, Motion, Share, Tangent
from abut.types import Array, Sparse


@dataclass(frozen=True)
class FollowerLoads:
    """Pressures on the deformed surfaces of a model, theory (D9), and loads at the references of ``bodies``, (D15)."""

    model: Model
    bodies: Sequence[RigidBody] = ()
    name: str = "followers"
    constant: bool = False

    def evaluate(self, before: Motion, now: Motion) -> Share:
        """Force, tangent and history at a state, as in ``Term``."""
        mesh, factors = self.model.mesh, weights(self.model.histories, now.time)
        points = mesh.points + now.displacement.reshape(mesh.points.shape)
        force, slope = np.zeros(points.size), sp.csr_matrix((points.size, points.size))
        parts: list[tuple[Sparse, Sparse]] = []
        symmetric = True
        for load in followers(self.model):
            factor = factors[self.model.histories.index(load.amplitude)]
            if not isinstance(load, Pressure):
                body = next(body for body in self.bodies if body.name == load.on)
                at = self._at_reference(body, load, factor, points)
                places = _places(body, points)
                force += places @ at.force.ravel()
                if at.turns:
                    parts.append((places @ sp.csr_matrix(at.left), sp.csr_matrix(at.right) @ places.T))
                    symmetric = symmetric and not isinstance(load, Moment)
                continue
            surface = mesh.surface(load.on)
            pushed, by = follower_pressure(
                replace(surface, points=points), load.value, surface.points, f"pressure on '{load.on}': value"
            )
            force, slope = force + factor * pushed, slope + factor * by
        tangent = Slopes(MatrixTangent(-slope), parts)
        return Share(-force, tangent, symmetric=symmetric and not slope.nnz)

    def _at_reference(self, body: RigidBody, load: Load, factor: float, points: Array) -> Spread:
        """points: all of the mesh, deformed."""
        force, moment = force_and_moment(self.model, load)
        middle = body.weights @ body.points
        offset = body.reference - middle
        if body.axisymmetric:
            along = np.outer(body.weights, factor * force)
            return Spread(along, np.zeros((along.size, 6)), np.zeros((6, along.size)), False)
        if len(offset) == 3 and in_line(body.points) and (moment.any() or np.abs(np.cross(offset, force)).any()):
            raise InputError(
                f"loads on {body.words}: its points lie on one line, which leaves the turn about it open; couple points "
                'beside the line, or use kinematics = "small"'
            )
        arms = body.points - middle
        return spread(arms, points[body.nodes], body.weights, offset, factor * force, factor * moment)


def _places(body: RigidBody, points: Array) -> Sparse:
    """(dim n_points, dim n) ones from the points of a body to all."""
    rows = dofs_at(body.nodes, points.shape[1]).ravel()
    return sp.csr_matrix((np.ones(len(rows)), (rows, np.arange(len(rows)))), shape=(points.size, len(rows)))


@dataclass(frozen=True)
class Slopes:
    """A tangent with parts of low rank: minus left (dim n_points, 6) @ right (6, dim n_points), sparse, beside ``own``.
    Written out they would be as large as all points of a body together squared, though the body has six unknowns."""

    own: Tangent
    parts: Sequence[tuple[Sparse, Sparse]]

    def internal(self, displacement: Array) -> Array:
        """Forces by a change of displacements, as in ``Tangent``."""
        return np.asarray(
            self.own.internal(displacement) - sum(left @ (right @ displacement) for left, right in self.parts)
        )

    def reduce(self, constraints: Constraints) -> Sparse:
        """The tangent on the free displacements, as in ``Tangent``, CSR."""
        free, total = constraints.free, self.own.reduce(constraints)
        for left, right in self.parts:
            total = total - (free.T @ left).tocsr() @ (right @ free).tocsr()
        return total.tocsr()
