"""The load vector of a model."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.model import Force, Gravity, Model, Pressure, Traction
from abut.solids.elements import body_load, thermal_load
from abut.solids.loads import force_load, pressure_load, traction_load


def applied_load(model: Model) -> NDArray[np.float64]:
    """Nodal forces of all loads at full size, (dim n_points,). Raises InputError for functions of position that do not
    return a finite vector for each point."""
    mesh = model.mesh
    total = np.zeros(mesh.points.size)
    for load in model.loads:
        if isinstance(load, Pressure):
            total += pressure_load(mesh.surface(load.on), load.value)
        elif isinstance(load, Traction):
            total += traction_load(mesh.surface(load.on), load.value, f"traction on '{load.on}': value")
        elif isinstance(load, Force):
            total += force_load(mesh.surface(load.on), np.array(load.value))
        elif isinstance(load, Gravity):
            weights = {s.body: s.material.density * np.array(load.value) for s in model.solids}
            total += body_load(mesh, weights if load.on is None else {load.on: weights[load.on]})
        else:
            total += body_load(mesh, dict.fromkeys(mesh.bodies if load.on is None else [load.on], load.value))
    return total


def strain_load(model: Model) -> NDArray[np.float64]:
    """Nodal forces of thermal strains, (dim n_points,)."""
    materials = {solid.body: solid.material for solid in model.solids}
    temperatures = {solid.body: solid.temperature for solid in model.solids}
    return thermal_load(model.mesh, materials, temperatures, model.plane, model.integration)
