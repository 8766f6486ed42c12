"""Pressure that follows the deformed surface: nodal forces and their derivative by the positions; theory (D9), (D10)."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from abut._core import shape_functions
from abut.cells import BY_CODE, CELLS
from abut.dofs import dofs_at
from abut.fields import Given, evaluate
from abut.mesh.quadrature import facet_rule
from abut.mesh.surface import Surface
from abut.types import Array, Sparse

OF_CORNERS = {2: "line2", 3: "tri3", 4: "quad4"}
TURN = np.array([[0.0, 1.0], [-1.0, 0.0]])  # from a tangent to the normal outwards, in the plane
PERMUTATION = np.array([[[(i - j) * (j - k) * (k - i) / 2.0 for k in range(3)] for j in range(3)] for i in range(3)])


def follower_pressure(
    surface: Surface,
    value: Given,
    undeformed: Array | None = None,
    name: str = "pressure: value",
    share: Array | None = None,
) -> tuple[Array, Sparse]:
    """Nodal forces (dim n_points,) of a pressure (force per area, positive into the body) on a surface at its present
    positions, and their derivative by these (dim n_points, dim n_points) CSR.

    value: a number, or a function of the positions ``undeformed``, (n_points, dim), points (n, dim) -> (n,); share:
    (n_facets, 9) factors of it at the corners of the facets, linear between. Raises InputError, beginning with ``name``,
    for a function that does not return finite numbers."""
    dim, n = surface.dim, surface.points.size
    load, slopes = np.zeros(surface.points.shape), sp.csr_matrix((n, n))
    for code in np.unique(surface.kinds):
        cell = CELLS[BY_CODE[code].name]
        nodes = surface.nodes[surface.kinds == code, : cell.nodes]
        xi, weights = facet_rule(cell.name)
        values, derivatives = shape_functions(cell.code, np.ascontiguousarray(xi))
        at = surface.points[nodes]
        tangents = np.einsum("qna,fnd->fqad", derivatives, at)
        if dim == 2:
            normal, by = tangents[..., 0, :] @ TURN.T, np.einsum("qk,ab->qkab", derivatives[..., 0], TURN)[None]
        else:
            first, second = tangents[..., 0, :], tangents[..., 1, :]
            normal = np.cross(first, second)
            by = np.einsum("abc,qk,fqc->fqkab", PERMUTATION, derivatives[..., 0], second)
            by -= np.einsum("abc,qk,fqc->fqkab", PERMUTATION, derivatives[..., 1], first)
        around = surface.around(np.einsum("qn,fnd->fqd", values, at))
        by = by * around[..., None, None, None]
        if surface.axisymmetric:
            by[..., 0] += 2.0 * np.pi * np.einsum("qk,fqa->fqka", values, normal)
        first_at = at if undeformed is None else undeformed[nodes]
        pressure = evaluate(value, np.einsum("qn,fnd->fqd", values, first_at), name)
        if share is not None:
            between, _ = shape_functions(CELLS[OF_CORNERS[cell.corners]].code, np.ascontiguousarray(xi))
            pressure = pressure * (share[surface.kinds == code, : cell.corners] @ between.T)
        np.add.at(load, nodes, -np.einsum("q,qn,fqa,fq,fq->fna", weights, values, normal, around, pressure))
        slopes = slopes - _assembled(nodes, np.einsum("q,qi,fqkab,fq->fiakb", weights, values, by, pressure), n)
    return load.ravel(), slopes


def _assembled(nodes: Array, blocks: Array, size: int) -> Sparse:
    """blocks: (f, n, dim, n, dim) of the facets' nodes (f, n)."""
    dofs = dofs_at(nodes, blocks.shape[2]).reshape(len(blocks), -1)
    rows = np.repeat(dofs, dofs.shape[1], axis=1).ravel()
    columns = np.tile(dofs, (1, dofs.shape[1])).ravel()
    return sp.csr_matrix((blocks.ravel(), (rows, columns)), shape=(size, size))
