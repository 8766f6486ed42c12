"""Norms of displacement and pressure for the inf-sup test: H1 of the bodies, H^-1/2 of the contactor."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.cells import CELLS
from abut.linear.fractional import inverse_root
from abut.mesh.integrals import chunks, gradients
from abut.mesh.mesh import Mesh
from abut.mesh.quadrature import product_rule
from abut.mesh.surface import Surface, around
from abut.types import Sparse
from abut.verify.trace import TraceSpace


def h1_matrix(mesh: Mesh, length: float = 1.0) -> Sparse:
    """int u v / length^2 + grad u . grad v of scalar functions over all cells, (n_points, n_points) CSR."""
    n = len(mesh.points)
    total = sp.csr_matrix((n, n))
    for kind, nodes, _ in chunks(mesh):
        xi, weights = product_rule(kind)
        shapes, derivatives = shape_functions(CELLS[kind].code, np.ascontiguousarray(xi))
        slopes, det = gradients(mesh.points, nodes, derivatives)
        measure = det * weights * around(np.einsum("qn,cnd->cqd", shapes, mesh.points[nodes]), mesh.axisymmetric)
        values = np.einsum("cq,qn,qm->cnm", measure / length**2, shapes, shapes)
        values += np.einsum("cqna,cqma->cnm", slopes * measure[..., None, None], slopes, optimize=True)
        rows = np.repeat(nodes, nodes.shape[1], axis=1).ravel()
        columns = np.tile(nodes, (1, nodes.shape[1])).ravel()
        total = total + sp.csr_matrix((values.ravel(), (rows, columns)), shape=(n, n))
    return total


@dataclass(frozen=True)
class TraceNorm:
    """q^T T q = c^T V Lambda^-1/2 V^T c with c = C q and (M / length^2 + L) V = M V Lambda on a fine continuous space of the
    surface: the norm of H^-1/2, dual to the trace space between L2 and H1. The power is a sum of resolvents (Hale, Higham
    and Trefethen 2008, method 3), so that nothing dense is needed."""

    moments: Sparse  # C (n_trace, n), sparse
    solves: tuple[Callable[[NDArray[np.float64]], NDArray[np.float64]], ...]
    weights: NDArray[np.float64]

    def __call__(self, q: NDArray[np.float64]) -> NDArray[np.float64]:
        """T q for one column or several."""
        c = np.asarray(self.moments @ q)
        return np.asarray(self.moments.T @ sum(w * solve(c) for w, solve in zip(self.weights, self.solves)))


def trace_norm(space: TraceSpace, transfer: Sparse, length: float = 1.0, accuracy: float = 1e-5) -> TraceNorm:
    """The H^-1/2 norm of pressures ``transfer @ q`` (facet-wise nodal values) on the contactor, squared to ``accuracy``;
    ``length``: that of the space."""
    largest = _largest(space.full, space.mass)
    shifts, weights = inverse_root(length**-2, largest, accuracy)
    solves = tuple(spla.splu((space.full + s * space.mass).tocsc()).solve for s in shifts)
    return TraceNorm((space.moments @ transfer).tocsr(), solves, weights)


def _largest(full: Sparse, mass: Sparse) -> float:
    """An upper bound of the eigenvalues of (full, mass): row sums over the lumped mass, with the consistent mass no
    smaller than a tenth of it on quadratic facets."""
    lumped = np.asarray(abs(mass).sum(axis=1)).ravel()
    return float(10.0 * (np.asarray(abs(full).sum(axis=1)).ravel() / lumped).max())


def facet_scale(surface: Surface, areas: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mesh size h of each facet: its length in 2D, the root of its area in 3D."""
    if surface.dim == 3:
        return np.sqrt(areas)
    x = surface.points[surface.nodes[:, :2]]
    return np.asarray(np.linalg.norm(x[:, 1] - x[:, 0], axis=1))
