"""Stresses at the nodes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut._core import integrate_given, integrate_isotropic
from abut.bodies.assemble import moduli
from abut.bodies.evaluation import History, evaluate
from abut.bodies.solids import UNHEATED, Array, Solids, TemperatureChange
from abut.mesh.quadrature import cell_rule, stress_rule
from abut.mesh.reference import reference_nodes


def nodal_stress(
    solids: Solids, displacement: Array, temperature: TemperatureChange = UNHEATED, history: History | None = None
) -> Array:
    """Stress xx yy zz xy yz zx at the points, (n_points, 6), under a displacement (n_points, dim): taken at the reduced
    integration points (of materials that are not linear elastic: at their integration points), carried linearly to each
    cell's nodes and averaged over the cells of a point (bodies that share nodes share the average). Axisymmetric: xx radial,
    yy axial, zz hoop. Integration "b-bar": with the mean dilatation of (E3). history: before the displacement."""
    return averaged(*stress_sums(solids, displacement, temperature, history))


def averaged(total: Array, count: Array) -> Array:
    """Sums of stresses (n_points, 6) over how many cells each holds (n_points,); zero where there are none."""
    return np.asarray(total / np.maximum(count, 1.0)[:, None])


def stress_sums(
    solids: Solids, displacement: Array, temperature: TemperatureChange = UNHEATED, history: History | None = None
) -> tuple[Array, Array]:
    """What ``nodal_stress`` averages: the sum of the cells' stresses at the points (n_points, 6), and of how many cells that
    deform (n_points,). Sums of parts of a mesh add up."""
    total, count = np.zeros((len(solids.points), 6)), np.zeros(len(solids.points))
    moved = np.ascontiguousarray(displacement, dtype=float)
    for group in solids.groups():
        if not group.body:
            rule = stress_rule(group.kind)
            integrate_isotropic(
                group.arrays(solids, rule), moduli(solids, group), solids.plane == "stress", moved,
                temperature.strain(solids, group), nodal=(to_nodes(group.kind, rule[0]), total, count),
            )  # fmt: skip
            continue
        rule = cell_rule(group.kind, group.integration)
        nodal = to_nodes(group.kind, rule[0]), total, count
        for cells, (stress, _, _) in evaluate(solids, group, rule, moved, temperature, history):
            integrate_given(cells, stress, nodal=nodal)
    return total, count


def to_nodes(kind: str, xi: NDArray[np.float64]) -> Array:
    """Least-squares linear extrapolation from points xi to the nodes, (nodes, q)."""
    where = reference_nodes(kind)
    terms = np.concatenate([np.ones((len(xi), 1)), xi], axis=1) if len(xi) > 2 else np.ones((len(xi), 1))
    at = np.concatenate([np.ones((len(where), 1)), where], axis=1)[:, : terms.shape[1]]
    return np.ascontiguousarray(at @ np.linalg.pinv(terms))
