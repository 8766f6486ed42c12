"""Consistent mass of bodies, all cell types."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import scipy.sparse as sp

from abut._core import shape_functions
from abut.cells import CELLS
from abut.mesh.integrals import body_chunks, gradients
from abut.mesh.mesh import Mesh
from abut.mesh.quadrature import product_rule
from abut.mesh.surface import around
from abut.types import Array, Sparse


def mass(mesh: Mesh, densities: Mapping[str, float], along: Array | None = None) -> Sparse:
    """int rho N N^T, alike in all directions, theory (J1): (dim n_points, dim n_points) CSR. Per unit thickness in 2D, all
    round if axisymmetric. densities: of bodies [force time^2 / length^4], those not named have none; along: (dim, dim) in
    place of the unit matrix."""
    n, dim = mesh.points.shape
    rows, columns, values = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)], [np.zeros(0)]
    for body, density in densities.items():
        for kind, nodes in body_chunks(mesh, body) if density else ():
            xi, weights = product_rule(kind)
            shapes, derivatives = shape_functions(CELLS[kind].code, np.ascontiguousarray(xi))
            _, det = gradients(mesh.points, nodes, derivatives)
            at = np.einsum("qn,cnd->cqd", shapes, mesh.points[nodes])
            each = density * weights * det * around(at, mesh.axisymmetric)
            products = (shapes[:, :, None] * shapes[:, None, :]).reshape(len(weights), -1)
            add_cells(nodes, (each @ products).ravel(), rows, columns, values)
    return sp.kron(at_nodes(n, rows, columns, values), np.eye(dim) if along is None else along, format="csr")


def add_cells(nodes: Array, entries: Array, rows: list[Array], columns: list[Array], values: list[Array]) -> None:
    """Add the matrices (cells, k, k), flat, of cells with nodes (cells, k) to lists of entries."""
    k = nodes.shape[1]
    rows.append(np.repeat(nodes, k, axis=1).ravel())
    columns.append(np.tile(nodes, (1, k)).ravel())
    values.append(entries)


def at_nodes(n: int, rows: list[Array], columns: list[Array], values: list[Array]) -> Sparse:
    """The matrix (n, n) CSR of entries by node, added up."""
    entries = (np.concatenate(rows), np.concatenate(columns))
    return sp.coo_matrix((np.concatenate(values), entries), shape=(n, n)).tocsr()
