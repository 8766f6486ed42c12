"""Stiffness, body loads and stresses of the solids; dof of component a at point i: dim i + a."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut._core import add_stresses, assemble_stiffness, block_pattern, node_pattern, shape_functions
from abut.cells import CELLS
from abut.fields import Field, evaluate
from abut.materials.elastic import LinearElastic
from abut.mesh.integrals import body_chunks, gradients, group_chunks, groups
from abut.mesh.mesh import Mesh
from abut.mesh.quadrature import cell_rule, field_rule, stiffness_rule, stress_rule
from abut.mesh.surface import around

FULL: Mapping[str, str] = {}  # integration by body: "full" for bodies that are not named


def lame(material: LinearElastic, plane: str | None) -> tuple[float, float]:
    """Lame's constants; in plane stress lambda is the reduced one."""
    young, poisson = material.young, material.poisson
    mu = young / (2.0 * (1.0 + poisson))
    if plane == "stress":
        return young * poisson / (1.0 - poisson**2), mu
    return young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), mu


def _by_cell(mesh: Mesh, values: Mapping[str, tuple[float, ...]]) -> NDArray[np.float64]:
    """A row of values for every cell, from those of its body."""
    table = np.zeros((mesh.n_cells, len(next(iter(values.values())))))
    for body, row in values.items():
        table[mesh.bodies[body]] = row
    return table


def stiffness(
    mesh: Mesh,
    materials: Mapping[str, LinearElastic],
    plane: str | None = None,
    integration: Mapping[str, str] = FULL,
) -> Any:
    """Stiffness matrix of all bodies, theory (F4), (dim n_points, dim n_points) CSR with sorted rows; force per
    length (2D: per unit thickness; axisymmetric: all round). ``integration`` by body as in ``Solid``,
    theory (E1), (E2), (E3)."""
    points = np.ascontiguousarray(mesh.points)
    dim = points.shape[1]
    counts = np.concatenate([np.full(len(b.nodes), b.nodes.shape[1]) for b in mesh.blocks])
    start = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
    flat = np.concatenate([b.nodes.ravel() for b in mesh.blocks]).astype(np.int32)
    node_start, node_columns = node_pattern(len(points), start, flat)
    constants = _by_cell(mesh, {body: lame(material, plane) for body, material in materials.items()})
    values = np.zeros(len(node_columns) * dim * dim)
    for kind, nodes, cells, rule in groups(mesh, integration):
        xi, weights = cell_rule(kind, rule)
        shapes, derivatives = shape_functions(CELLS[kind].code, np.ascontiguousarray(xi))
        assemble_stiffness(
            points, np.ascontiguousarray(nodes, dtype=np.int32), shapes, derivatives, weights,
            np.ascontiguousarray(constants[cells]), mesh.axisymmetric, rule == "b-bar", node_start, node_columns, values,
        )  # fmt: skip
    indptr, indices = block_pattern(node_start, node_columns, dim)
    if len(values) < 2**31:
        indptr = indptr.astype(np.int32)
    matrix = sp.csr_matrix((values, indices, indptr), shape=(points.size, points.size))
    matrix.has_sorted_indices = True
    return matrix


def thermal_load(
    mesh: Mesh,
    materials: Mapping[str, LinearElastic],
    temperatures: Mapping[str, float],
    plane: str | None = None,
    nodal: NDArray[np.float64] | None = None,
    integration: Mapping[str, str] = FULL,
) -> NDArray[np.float64]:
    """int B^T D eps_thermal, theory (F10), (dim n_points,), for a uniform temperature change of each body and another,
    ``nodal`` (n_points,), that the shape functions interpolate. Integrated like the stiffness, so that a temperature whose
    strain the elements can follow leaves no stress; "b-bar" takes the mean over each cell, as for the dilatation."""
    load = np.zeros(mesh.points.shape)
    nodal = np.zeros(len(mesh.points)) if nodal is None else nodal
    table = _by_cell(
        mesh, {body: (_thermal_pressure(m, plane), temperatures.get(body, 0.0)) for body, m in materials.items()}
    )
    if not (table[:, 0].any() and (table[:, 1].any() or nodal.any())):
        return load.ravel()
    for kind, nodes, cells, rule in group_chunks(mesh, integration):
        xi, weights = cell_rule(kind, rule)
        shapes, derivatives = shape_functions(CELLS[kind].code, np.ascontiguousarray(xi))
        slopes, det = gradients(mesh.points, nodes, derivatives)
        at = np.einsum("qn,cnd->cqd", shapes, mesh.points[nodes])
        if mesh.axisymmetric:
            slopes[..., 0] += shapes / at[..., :1]  # of the hoop strain u_r / r
        det = det * around(at, mesh.axisymmetric)
        change = table[cells, 1][:, None] + nodal[nodes] @ shapes.T
        change = np.broadcast_to(change, det.shape)
        if rule == "b-bar":
            change = np.broadcast_to(((change * det) @ weights / (det @ weights))[:, None], det.shape)
        blocked = table[cells, :1] * change * det * weights
        np.add.at(load, nodes, np.einsum("cq,cqna->cna", blocked, slopes))
    return load.ravel()


def _thermal_pressure(material: LinearElastic, plane: str | None) -> float:
    """Stress per degree that a blocked expansion would cause in the plane (all directions in 3D)."""
    young, poisson = material.young, material.poisson
    return young * material.expansion / (1.0 - poisson if plane == "stress" else 1.0 - 2.0 * poisson)


def body_load(
    mesh: Mesh, forces: Mapping[str, Sequence[float] | NDArray[np.float64] | Field], name: str = "body force: value"
) -> NDArray[np.float64]:
    """int f N of a force per volume in each of the bodies named, a vector or a function of position, points (n, dim) ->
    (n, dim); (dim n_points,).

    Raises InputError, beginning with ``name``, for a function that does not return a finite vector for each point."""
    load = np.zeros(mesh.points.shape)
    dim = mesh.dim
    for body, value in forces.items():
        for kind, nodes in body_chunks(mesh, body):
            xi, weights = field_rule(kind) if callable(value) else stiffness_rule(kind)
            shapes, derivatives = shape_functions(CELLS[kind].code, np.ascontiguousarray(xi))
            at = np.einsum("qn,cnd->cqd", shapes, mesh.points[nodes])
            _, det = gradients(mesh.points, nodes, derivatives)
            density = evaluate(value, at, name, (dim,)) * (weights * det * around(at, mesh.axisymmetric))[..., None]
            np.add.at(load, nodes, np.einsum("qn,cqa->cna", shapes, density))
    return load.ravel()


def nodal_stress(
    mesh: Mesh,
    materials: Mapping[str, LinearElastic],
    temperatures: Mapping[str, float],
    displacement: NDArray[np.float64],
    plane: str | None = None,
    nodal: NDArray[np.float64] | None = None,
    integration: Mapping[str, str] = FULL,
) -> NDArray[np.float64]:
    """Stress xx yy zz xy yz zx at the points, (n_points, 6): taken at the reduced integration points, carried linearly
    to each cell's nodes and averaged over the cells of a point (bodies that share nodes share the average).
    Axisymmetric: xx radial, yy axial, zz hoop. ``temperatures`` of bodies and ``nodal`` ones as in ``thermal_load``.
    Integration "b-bar": with the mean dilatation of (E3)."""
    total, count = stress_sums(mesh, materials, temperatures, displacement, plane, nodal, integration)
    return averaged(total, count)


def averaged(total: NDArray[np.float64], count: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sums of stresses (n_points, 6) over how many cells each holds (n_points,); zero where there are none."""
    return np.asarray(total / np.maximum(count, 1.0)[:, None])


def stress_sums(
    mesh: Mesh,
    materials: Mapping[str, LinearElastic],
    temperatures: Mapping[str, float],
    displacement: NDArray[np.float64],
    plane: str | None = None,
    nodal: NDArray[np.float64] | None = None,
    integration: Mapping[str, str] = FULL,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """What ``nodal_stress`` averages: the sum of the cells' stresses at the points (n_points, 6), and of how many cells that
    deform (n_points,). Sums of parts of a mesh add up."""
    total, count = np.zeros((len(mesh.points), 6)), np.zeros(len(mesh.points))
    points, moved = np.ascontiguousarray(mesh.points), np.ascontiguousarray(displacement)
    heat = np.zeros(len(points)) if nodal is None else np.ascontiguousarray(nodal)
    constants = _by_cell(
        mesh,
        {
            body: (*lame(m, None), m.poisson, m.expansion, temperatures.get(body, 0.0), 1.0)
            for body, m in materials.items()
        },
    )
    for kind, nodes, cells, rule in groups(mesh, integration):
        xi, weights = stress_rule(kind)
        shapes, derivatives = shape_functions(CELLS[kind].code, np.ascontiguousarray(xi))
        add_stresses(
            points, moved, heat, np.ascontiguousarray(nodes, dtype=np.int32), np.ascontiguousarray(constants[cells]),
            shapes, derivatives, weights, _to_nodes(kind, xi), plane == "axisymmetric", plane == "stress",
            rule == "b-bar", total, count,
        )  # fmt: skip
    return total, count


def _to_nodes(kind: str, xi: NDArray[np.float64]) -> NDArray[np.float64]:
    """Least-squares linear extrapolation from points xi to the nodes, (nodes, q)."""
    where = reference_nodes(kind)
    terms = np.concatenate([np.ones((len(xi), 1)), xi], axis=1) if len(xi) > 2 else np.ones((len(xi), 1))
    at = np.concatenate([np.ones((len(where), 1)), where], axis=1)[:, : terms.shape[1]]
    return np.ascontiguousarray(at @ np.linalg.pinv(terms))


def reference_nodes(kind: str) -> NDArray[np.float64]:
    """Reference coordinates of a cell's nodes, (nodes, dim)."""
    cell = CELLS[kind]
    if cell.dim == 2:
        corners = np.array([[0, 0], [1, 0], [0, 1]]) if cell.corners == 3 else _square()
        middles = 0.5 * (corners + np.roll(corners, -1, axis=0))
        return np.vstack([corners, middles, [[0.0, 0.0]]])[: cell.nodes].astype(float)
    if cell.corners == 4:
        corners = np.vstack([np.zeros(3), np.eye(3)])
        edges = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
    elif cell.corners == 6:
        tri = np.array([[0.0, 0], [1, 0], [0, 1]])
        corners = np.vstack([np.column_stack([tri, np.full(3, z)]) for z in (-1.0, 1.0)])
        edges = [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)]
    else:
        corners = np.vstack([np.column_stack([_square(), np.full(4, z)]) for z in (-1.0, 1.0)])
        edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
    middles = np.array([0.5 * (corners[a] + corners[b]) for a, b in edges])
    faces = np.array([[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1], [0, 0, 0]], dtype=float)
    return np.vstack([corners, middles, faces])[: cell.nodes]


def _square() -> NDArray[np.float64]:
    return np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])
