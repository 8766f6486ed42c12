"""Centrifugal forces that grow with the distance from the axis: spin softening."""

from __future__ import annotations

import scipy.sparse as sp

from abut.bodies.mass import mass
from abut.model import Centrifugal, Model
from abut.model.conditions import weights
from abut.types import Sparse


def spin_softening(model: Model, time: float) -> Sparse:
    """Stiffness (dim n_points, dim n_points) CSR that centrifugal forces at a time add, theory (J8); none of bodies without
    a density."""
    total = sp.csr_matrix((model.mesh.points.size,) * 2)
    factors = dict(zip(model.histories, weights(model.histories, time)))
    densities = {solid.body: float(solid.material.density) for solid in model.solids}
    for load in model.loads:
        if isinstance(load, Centrifugal) and factors[load.amplitude]:
            own = densities if load.on is None else {load.on: densities[load.on]}
            slope = load.slope(model.dim, model.mesh.axisymmetric)
            total = total - factors[load.amplitude] * mass(model.mesh, own, slope)
    return total.tocsr()
