"""Centrifugal forces that grow with the distance from the axis: spin softening."""

from __future__ import annotations

from abut.model import Centrifugal, Model
from abut.model.conditions import weights
from abut.problem.backend import Backend
from abut.problem.constraints import Constraints
from abut.types import Operator


def spin_softening(model: Model, bodies: Backend, constraints: Constraints, time: float) -> Operator | None:
    """Stiffness (n_free, n_free) that centrifugal forces at a time add, theory (J8); None without."""
    total = None
    factors = dict(zip(model.histories, weights(model.histories, time)))
    densities = {solid.body: float(solid.material.density) for solid in model.solids}
    for load in model.loads:
        if isinstance(load, Centrifugal) and factors[load.amplitude]:
            own = densities if load.on is None else {load.on: densities[load.on]}
            mass = bodies.mass(own, load.slope(model.dim, model.mesh.axisymmetric)).reduce(constraints)
            part = -float(factors[load.amplitude]) * mass
            total = part if total is None else total + part
    return total
