"""What straight cells leave of forces: those by which the stresses of interpolated displacements differ from the stresses of
the displacements themselves, in triangles and tetrahedra of first order; theory (Z11)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from abut._core import interpolation_forces as compiled_forces
from abut._core import shape_functions
from abut.bodies.compliance import compliances
from abut.bodies.solids import Array, Solids, TemperatureChange
from abut.cells import CELLS
from abut.materials.places import uniform_expansion
from abut.mesh.quadrature import gauss_rule

Ids = NDArray[np.int32]
SIMPLEX = ("tri3", "tet4")
ORDER = 3  # of the rule round an axis; elsewhere the middle will do, in which slopes are those in the mean


def interpolation_forces(solids: Solids, stress: Sequence[Array | None], temperature: TemperatureChange) -> Array:
    """int B^T sigma(u - I u), (n_points, dim), with I u linear in the cells between the nodes, and second derivatives of the
    displacement u from the strains that stresses at the cells' nodes tell.

    stress: by block of the mesh, (n, n_nodes, 6) of smooth fields at the nodes of its cells, None where a block is left
    out; at small strains and of linear materials."""
    mesh, dim = solids.mesh, solids.mesh.dim
    result = np.zeros(mesh.points.shape)
    compliance, which = compliances(solids)
    stiffness = stiffnesses(compliance, solids.plane, dim)
    for block, first, values in zip(mesh.blocks, mesh.starts.tolist(), stress):
        if values is None or block.kind not in SIMPLEX:
            continue
        cells = np.flatnonzero(solids.body_of[first : first + len(block.nodes)] >= 0)
        if not len(cells):
            continue
        nodes = np.ascontiguousarray(block.nodes[cells], dtype=np.int32)
        at = values if len(cells) == len(block.nodes) else values[cells]
        code, rule = CELLS[block.kind].code, gauss_rule(block.kind, ORDER if mesh.axisymmetric else 1)
        shapes, derivatives = shape_functions(code, np.ascontiguousarray(rule[0]))
        result += compiled_forces(
            solids.points, nodes, np.ascontiguousarray(at), thermal(solids, temperature, nodes, first + cells),
            (which[first + cells], compliance, stiffness),
            (shapes, np.ascontiguousarray(derivatives[0]), rule[1] / rule[1].sum()), mesh.axisymmetric,
        )  # fmt: skip
    return result


def thermal(solids: Solids, temperature: TemperatureChange, nodes: Ids, cells: NDArray[np.int64]) -> Array | None:
    """Strain by nodal temperatures at the cells' nodes; what a body has all over has no gradient."""
    if temperature.nodes is None:
        return None
    expansion = np.array([uniform_expansion(material) or 0.0 for material in solids.materials.values()])
    return np.asarray(expansion[solids.body_of[cells]][:, None] * temperature.nodes[nodes])


def stiffnesses(compliance: Array, plane: str | None, dim: int) -> Array:
    """(n, c, c) of (n, 6, 6): of bodies in plane stress without what resists across."""
    if dim == 3:
        return np.asarray(np.linalg.pinv(compliance, hermitian=True))
    if plane == "stress":
        flat = np.zeros((len(compliance), 4, 4))
        own = np.ix_(range(len(compliance)), [0, 1, 3], [0, 1, 3])
        flat[own] = np.linalg.pinv(compliance[own], hermitian=True)
        return flat
    return np.asarray(np.linalg.pinv(compliance, hermitian=True)[:, :4, :4])
