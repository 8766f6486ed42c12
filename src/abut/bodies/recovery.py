"""Stresses at the nodes by superconvergent patch recovery (Zienkiewicz and Zhu 1992); theory (Z1), (Z2), (Z5)."""

from __future__ import annotations

import numpy as np

from abut._core import shape_functions, stress_errors
from abut.bodies.compliance import compliances
from abut.bodies.evaluation import History
from abut.bodies.interpolated_samples import straight, without_interpolation
from abut.bodies.patch_fits import Equations, Fits, Sampling, carried, fitted, no_equations, used
from abut.bodies.solids import UNHEATED, Array, Solids, TemperatureChange
from abut.bodies.stress import PointStress, point_stress
from abut.cells import CELLS
from abut.mesh.patches import Patches
from abut.mesh.quadrature import error_rule


def recovered(
    solids: Solids, points: Array, stress: PointStress, known: Equations | None = None, plain: Fits | None = None,
    interpolated: TemperatureChange | None = None,
) -> Array:  # fmt: skip
    """Stresses xx yy zz xy yz zx of each body at its points, (n_values, 6) in the order of ``solids.patches``, fitted to
    those at the integration points. points: (n_points, dim) where they are now; plain: fits of ``stress`` without what is
    known, where they have been made; interpolated: the change of temperature, where stresses are those of displacements that
    cells interpolate, whose samples then are mended, theory (Z13)."""
    of = solids.patches
    if known is None:
        known = no_equations(of, points.shape[1])
    if plain is not None and plain.stress is stress and plain.sampling.serves(points, known):
        fits = fitted(plain.sampling, stress, known, plain)
    else:
        fits = fitted(Sampling.of(solids, points, known), stress, known)
    if interpolated is not None and straight(solids).any():
        fits = fitted(fits.sampling, without_interpolation(fits, interpolated), known)
    result = fits.at(points[of.point], of.blend)
    value = np.zeros(len(points), dtype=np.int64)
    value[of.point] = np.arange(len(of.point))
    result[value[known.node][:, None], used(points.shape[1])] = known.given
    return result


def in_cells(fits: Fits) -> list[Array | None]:
    """Of each block of the mesh the mean of the polynomials of its cells' corners at the cells' nodes, (n, n_nodes, 6); None
    for cells with other nodes than corners, or without a material."""
    solids = fits.sampling.solids
    of = solids.patches
    patch = np.full(len(of.point), -1, dtype=np.int32)
    patch[of.corner] = np.arange(len(of.corner))
    result: list[Array | None] = []
    for block, nodes in zip(solids.mesh.blocks, of.nodes):
        if CELLS[block.kind].degree > 1 or not len(nodes) or (nodes < 0).all():
            result.append(None)
            continue
        deforms = nodes[:, 0] >= 0
        if deforms.all():
            result.append(fits.at_corners(patch[nodes]))
            continue
        values = np.zeros((*nodes.shape, 6))
        values[deforms] = fits.at_corners(patch[nodes[deforms]])
        result.append(values)
    return result


def at_points(of: Patches, values: Array, n_points: int) -> Array:
    """Values (n_values, 6) at the mesh's points, (n_points, 6): the mean of those of the bodies that share one, 0 where
    there are none."""
    total = np.zeros((n_points, values.shape[1]))
    if not of.shared:
        total[of.point] = values
        return total
    for column in range(values.shape[1]):
        total[:, column] = np.bincount(of.point, values[:, column], n_points)
    return np.asarray(total / np.maximum(np.bincount(of.point, minlength=n_points), 1)[:, None])


def of_shells(solids: Solids, values: Array) -> dict[str, Array]:
    """Values (n, 6) that each shell has at its own points, in their order, where bodies share some: layers of one shell
    differ there. values: (n_values, 6)."""
    if not solids.patches.shared:
        return {}
    bodies = list(solids.materials)
    return {
        body: values[solids.patches.body == bodies.index(body)]
        for body in solids.mesh.shells
        if body in solids.materials
    }


def nodal_stress(
    solids: Solids, displacement: Array, temperature: TemperatureChange = UNHEATED, history: History | None = None
) -> Array:
    """Stresses at the points (n_points, 6) under a displacement (n_points, dim), of which nothing is known at the surface:
    ``point_stress`` recovered."""
    stress = point_stress(solids, displacement, temperature, history)
    points = solids.points + displacement if solids.kinematics == "finite" else solids.points
    return at_points(solids.patches, recovered(solids, np.ascontiguousarray(points), stress), len(points))


def energies(solids: Solids, points: Array, stress: PointStress, values: Array) -> Array:
    """Of each cell (n_cells, 3) int e C^-1 e of the recovered less the element's stress, the same of the recovered one, and
    the volume; theory (Z6). values: (n_values, 6)."""
    of, result = solids.patches, np.zeros((solids.mesh.n_cells, 3))
    compliance, which = compliances(solids)
    for group, at in zip(solids.groups(), stress):
        rule = error_rule(group.kind)
        shapes, derivatives = shape_functions(CELLS[group.kind].code, np.ascontiguousarray(rule[0]))
        at = np.ascontiguousarray(carried(group.kind, group.rule, rule[0]) @ at).reshape(-1, 6)
        result[group.cells] = stress_errors(
            points, group.nodes, (shapes, derivatives, rule[1]), solids.mesh.axisymmetric, at,
            (of.of_cells(group.cells, solids.mesh.starts), values), (compliance, which[group.cells]),
        )  # fmt: skip
    return result
