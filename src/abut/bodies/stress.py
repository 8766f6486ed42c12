"""Stresses at the integration points of cells."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from abut.bodies.continuous import add_pressures
from abut.bodies.evaluation import History
from abut.bodies.integrate import integrate
from abut.bodies.solids import UNHEATED, Array, Solids, TemperatureChange
from abut.materials.kernel import Wanted

PointStress = Sequence[Array]  # of each of ``Solids.groups()``: (cells, points of its rule, 6) xx yy zz xy yz zx


def point_stress(
    solids: Solids, displacement: Array, temperature: TemperatureChange = UNHEATED, history: History | None = None
) -> PointStress:
    """Stresses at the integration points under a displacement (n_points, dim); under finite strains Cauchy's, in the fixed
    axes. Axisymmetric: xx radial, yy axial, zz hoop. Integration "b-bar": with the mean dilatation of (E3). history: of
    materials that have one, before the displacement.

    Raises Inverted, under finite strains, and InputError for materials that return arrays of other shapes."""
    moved = np.ascontiguousarray(displacement, dtype=float)
    result: list[Array] = []
    for group in solids.groups():
        cells, points = len(group.cells), len(group.rule[1])
        stress = np.empty((cells * points, 6))
        integrate(solids, group, group.rule, moved, temperature, history, Wanted(stress=stress))
        result.append(stress.reshape(cells, points, 6))
    add_pressures(solids, moved, temperature, result)
    return tuple(result)
