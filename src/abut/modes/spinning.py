"""What vibrations of a body that turns feel of it: centrifugal forces that grow with the distance, and Coriolis forces."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import scipy.sparse as sp

from abut.bodies.mass import mass
from abut.errors import InputError
from abut.model import Centrifugal, Model
from abut.model.conditions import weights
from abut.problem.backend import Backend
from abut.problem.constraints import Constraints
from abut.types import Operator, Sparse


def spin_softening(model: Model, bodies: Backend, constraints: Constraints, time: float) -> Operator | None:
    """Stiffness (n_free, n_free) that centrifugal forces at a time add, theory (J8); None without."""
    total = None
    for load, factor, own in _turning(model, time):
        mass = bodies.mass(own, load.slope(model.dim, model.mesh.axisymmetric)).reduce(constraints)
        part = -factor * mass
        total = part if total is None else total + part
    return total


def coriolis(model: Model, time: float) -> tuple[Sparse, float]:
    """The skew matrix (dim n_points, dim n_points) CSR of Coriolis forces at a time by velocities seen from what turns,
    theory (J12); and the largest angular speed.

    Raises InputError where nothing turns, or no speed follows from the loads."""
    total, speeds, known = sp.csr_matrix((model.mesh.points.size,) * 2), [0.0], set[str]()
    for load, factor, own in _turning(model, time):
        if factor < 0.0 or known & own.keys():
            what = "the amplitude of a centrifugal force is negative" if factor < 0.0 else "a body turns about two axes"
            raise InputError(f"frequencies: coriolis: {what}; give each body one speed, with an amplitude >= 0")
        known |= own.keys()
        speeds.append(abs(load.speed) * float(np.sqrt(factor)))
        total = total + 2.0 * np.sqrt(factor) * mass(model.mesh, own, load.velocity(model.dim))
    if not max(speeds):
        at = model.solve.time(time)
        raise InputError(f"frequencies: coriolis: nothing turns at time {at:g}; give a load of kind centrifugal")
    return total.tocsr(), max(speeds)


def _turning(model: Model, time: float) -> Iterator[tuple[Centrifugal, float, Mapping[str, float]]]:
    """Centrifugal forces that act at a time, their factors, and densities of the bodies that they act on."""
    factors = dict(zip(model.histories, weights(model.histories, time)))
    densities = {solid.body: float(solid.material.density) for solid in model.solids}
    for load in model.loads:
        if isinstance(load, Centrifugal) and factors[load.amplitude]:
            own = densities if load.on is None else {load.on: densities[load.on]}
            yield load, float(factors[load.amplitude]), own
