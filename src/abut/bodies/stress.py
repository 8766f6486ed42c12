"""Stresses at the integration points of cells."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from abut._core import integrate_hyperelastic, integrate_isotropic
from abut.bodies.assemble import moduli
from abut.bodies.evaluation import History, evaluate
from abut.bodies.inverted import require_sound
from abut.bodies.solids import UNHEATED, Array, Group, Solids, TemperatureChange
from abut.materials.hyperelastic import law

PointStress = Sequence[Array]  # of each of ``Solids.groups()``: (cells, points of its rule, 6) xx yy zz xy yz zx


def point_stress(
    solids: Solids, displacement: Array, temperature: TemperatureChange = UNHEATED, history: History | None = None
) -> PointStress:
    """Stresses at the integration points under a displacement (n_points, dim); under finite strains Cauchy's, in the fixed
    axes. Axisymmetric: xx radial, yy axial, zz hoop. Integration "b-bar": with the mean dilatation of (E3). history: of
    materials that are not linear elastic, before the displacement.

    Raises Inverted, under finite strains, and InputError for materials that return arrays of other shapes."""
    moved = np.ascontiguousarray(displacement, dtype=float)
    return tuple(_of_group(solids, group, moved, temperature, history) for group in solids.groups())


def _of_group(
    solids: Solids, group: Group, moved: Array, temperature: TemperatureChange, history: History | None
) -> Array:
    shape = len(group.cells), len(group.rule[1]), 6
    if group.body:
        parts = [stress for _, (stress, _, _) in evaluate(solids, group, group.rule, moved, temperature, history)]
        return np.concatenate(parts).reshape(shape)
    stress = np.empty((shape[0] * shape[1], 6))
    cells, heat, plane = group.arrays(solids, group.rule), temperature.strain(solids, group), solids.plane == "stress"
    if solids.kinematics == "small":
        integrate_isotropic(cells, moduli(solids, group), plane, moved, heat, stress=stress)
    else:
        constants = solids.by_cell(
            group, {body: (law(m) or (0, (0.0, 0.0)))[1] for body, m in solids.materials.items()}
        )
        require_sound(
            solids, group, integrate_hyperelastic(cells, constants, group.law, plane, moved, heat, stress=stress)
        )
    return stress.reshape(shape)
