"""Forces, tangent stiffness and strain energy of solids under finite strains; theory (D1), (D2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from abut._core import integrate_hyperelastic
from abut.bodies.assemble import matrix_of, no_values
from abut.bodies.inverted import require_sound
from abut.bodies.solids import UNHEATED, Array, Solids, TemperatureChange
from abut.materials.hyperelastic import law
from abut.types import Operator


@dataclass(frozen=True)
class FiniteResponse:
    """force: (dim n_points,) of the stresses; tangent: its derivative, (dim n_points, dim n_points) CSR with sorted rows, or
    None; energy: (n_cells,) elastic energy of each cell, per unit thickness in 2D, all round if axisymmetric."""

    force: Array
    tangent: Operator
    energy: Array


def respond_finite(
    solids: Solids, displacement: Array, temperature: TemperatureChange = UNHEATED, tangent: bool = True
) -> FiniteResponse:
    """Internal force at a displacement (n_points, dim), tangent (unless not wanted), and energy. Raises Inverted."""
    force, energy = np.zeros(solids.points.shape), np.zeros(solids.mesh.n_cells)
    values = no_values(solids) if tangent else None
    moved = np.ascontiguousarray(displacement, dtype=float)
    for group in solids.groups():
        energies = np.zeros(len(group.cells))
        constants = solids.by_cell(
            group, {body: (law(m) or (0, (0.0, 0.0)))[1] for body, m in solids.materials.items()}
        )
        unsound = integrate_hyperelastic(
            group.arrays(solids, group.rule), constants, group.law, solids.plane == "stress", moved,
            temperature.strain(solids, group), force=force,
            tangent=None if values is None else (*solids.pattern, values), energy=energies,
        )  # fmt: skip
        require_sound(solids, group, unsound)
        energy[group.cells] = energies
    return FiniteResponse(force.ravel(), None if values is None else matrix_of(solids, values), energy)


def is_symmetric(solids: Solids) -> bool:
    """Whether the tangent is symmetric: F-bar's is not."""
    return "b-bar" not in {solids.integration.get(body, "full") for body in solids.materials}
