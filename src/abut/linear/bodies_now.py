"""The bodies of a problem at a state, as multigrid must know them: where they are, and how they move without strain."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut.bodies.rigid_modes import free_motions, near_null, rigid_modes
from abut.problem.linearised import Linearised
from abut.problem.problem import ContactProblem
from abut.problem.restraint import resistance_of_supports
from abut.types import Sparse


@dataclass(frozen=True)
class BodiesNow:
    """free: (dim n_points, n_free) change of variables; near_null: (n_free, m) motions that strain bodies least; motions:
    (n_free, k) rigid ones that supports leave free; points: (n_points, dim) undeformed."""

    free: Sparse
    near_null: NDArray[np.float64]
    motions: NDArray[np.float64]
    points: NDArray[np.float64]


def bodies_now(problem: ContactProblem, system: Linearised) -> BodiesNow:
    """At the state that a problem was linearised about; where displacements are small, undeformed. Points keep their
    undeformed places: which of them are near each other is a matter of cells, not of what they touch."""
    mesh, constraints, rigid = problem.model.mesh, problem.constraints, problem.restraint.rigid
    if system.about is None:
        undeformed = constraints.coordinates(near_null(mesh, rigid))
        return BodiesNow(constraints.free, undeformed, system.motions, mesh.points)
    at = system.about.at
    moved = constraints.displacement(at, system.factors).reshape(mesh.points.shape)
    now, near = replace(mesh, points=mesh.points + moved), constraints.near(at, system.factors)
    rigid = rigid_modes(now)
    modes = near.coordinates(rigid.modes)
    sprung = modes[problem.springs.columns]
    motions = free_motions([resistance_of_supports(rigid, near), sprung.T @ sprung])
    return BodiesNow(near.free, near.coordinates(near_null(now, rigid)), modes @ motions, mesh.points)
