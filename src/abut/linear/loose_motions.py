"""Motions that multigrid does not see, for which a preconditioner has a small dense matrix."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.linear.bodies_now import BodiesNow
from abut.linear.krylov import fgmres
from abut.linear.multigrid import Hierarchy, wide
from abut.linear.solver import Count, Vector
from abut.problem.linearised import Linearised

SAME = 1e-6  # of motions of unit length, below which they are combinations of others
ROUGH, ITERATIONS = 0.03, 50  # of what bodies do where displacements of many points are given


@dataclass(frozen=True)
class Loose:
    """Motions (n_free, m) that multigrid does not see: rigid ones that supports leave free, and displacements of many points
    with what they bring about in the bodies; stiffness: (m, m) against them."""

    motions: NDArray[np.float64]
    stiffness: NDArray[np.float64]


def loose(system: Linearised, bodies: BodiesNow, levels: Hierarchy, count: Count) -> Loose:
    """levels: multigrid for the bodies."""
    many = np.flatnonzero(wide(bodies.free, bodies.points.shape[1]))
    if system.about is None and not len(many):
        return Loose(bodies.motions, np.zeros((bodies.motions.shape[1],) * 2))
    units = np.zeros((len(system.load), len(many)))
    units[many, np.arange(len(many))] = 1.0
    for unit in units.T:
        pull = -np.asarray(system.stiffness @ unit)
        pull[many] = 0.0

        def product(values: Vector) -> Vector:
            image = np.asarray(system.stiffness @ values)
            image[many] = 0.0
            return image

        follows, iterations, _ = fgmres(product, levels.cycle, pull, ROUGH, ITERATIONS, 1)
        count.iterations += iterations
        unit += follows
    both = np.hstack([bodies.motions, units])
    basis, sizes, _ = np.linalg.svd(both / np.linalg.norm(both, axis=0), full_matrices=False)
    motions = basis[:, sizes > SAME]
    return Loose(motions, motions.T @ (system.stiffness @ motions))
