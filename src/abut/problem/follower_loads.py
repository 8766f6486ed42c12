"""Loads that follow the deformation, as a term of the balance of forces."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from abut.bodies.follower import follower_pressure
from abut.model import Model
from abut.model.conditions import weights
from abut.problem.backend import Serial
from abut.problem.loads import followers
from abut.problem.terms import Motion, Share


@dataclass(frozen=True)
class FollowerLoads:
    """Pressures on the deformed surfaces of a model, theory (D9)."""

    model: Model
    name: str = "followers"
    constant: bool = False

    def evaluate(self, before: Motion, now: Motion) -> Share:
        """As in ``Term``."""
        mesh, factors = self.model.mesh, weights(self.model.histories, now.time)
        points = mesh.points + now.displacement.reshape(mesh.points.shape)
        force, slope = np.zeros(points.size), sp.csr_matrix((points.size, points.size))
        for load in followers(self.model):
            surface, factor = mesh.surface(load.on), factors[self.model.histories.index(load.amplitude)]
            pushed, by = follower_pressure(
                replace(surface, points=points), load.value, surface.points, f"pressure on '{load.on}': value"
            )
            force, slope = force + factor * pushed, slope + factor * by
        return Share(-force, Serial(self.model, -slope), symmetric=not slope.nnz)
