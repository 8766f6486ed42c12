"""Stiffness that stresses add to bodies at small displacements (geometric or initial-stress stiffness)."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from abut._core import shape_functions
from abut.bodies.mass import add_cells, at_nodes
from abut.bodies.solids import Solids
from abut.bodies.stress import PointStress
from abut.cells import CELLS
from abut.mesh.integrals import CHUNK, gradients
from abut.mesh.surface import around
from abut.types import Array, Sparse

PLANE = np.array([[0, 3], [3, 1]])  # places of a tensor's components in xx yy zz xy yz zx
SPACE = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
HOOP = 2  # number of the stress round the axis


def stress_stiffness(solids: Solids, stress: PointStress) -> Sparse:
    """int (grad N)^T sigma (grad N), alike in all directions, theory (J5): (dim n_points, dim n_points) CSR, symmetric; with
    the hoop stress where axisymmetric. stress: as of ``point_stress``."""
    n, dim = solids.points.shape
    every: tuple[list[Array], ...] = ([np.zeros(0, np.int64)], [np.zeros(0, np.int64)], [np.zeros(0)])
    radial: tuple[list[Array], ...] = ([np.zeros(0, np.int64)], [np.zeros(0, np.int64)], [np.zeros(0)])
    axisymmetric = solids.mesh.axisymmetric
    for group, values in zip(solids.groups(), stress):
        xi, weights = group.rule
        shapes, derivatives = shape_functions(CELLS[group.kind].code, np.ascontiguousarray(xi))
        for first in range(0, len(group.nodes), CHUNK):
            nodes, sigma = group.nodes[first : first + CHUNK], values[first : first + CHUNK]
            slopes, det = gradients(solids.points, nodes, derivatives)
            at = np.einsum("qn,cnd->cqd", shapes, solids.points[nodes])
            volume = weights * det * around(at, axisymmetric)
            tensor = sigma[..., PLANE if dim == 2 else SPACE] * volume[..., None, None]
            pulled = np.matmul(slopes, tensor)
            add_cells(nodes, np.einsum("cqia,cqja->cij", pulled, slopes, optimize=True).ravel(), *every)
            if axisymmetric:
                hoop = volume * sigma[..., HOOP] / at[..., 0] ** 2
                add_cells(nodes, np.einsum("cq,qi,qj->cij", hoop, shapes, shapes, optimize=True).ravel(), *radial)
    result = sp.kron(at_nodes(n, *every), sp.identity(dim), format="csr")
    if axisymmetric:
        result = result + sp.kron(at_nodes(n, *radial), sp.diags([1.0, 0.0]), format="csr")
    return result
