"""Stability of the pressures of mixed cells: the numerical inf-sup test."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import scipy.linalg
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.bodies.corner_pressures import KIND, CornerPressures, linear_functions, numbered
from abut.bodies.solids import Solids
from abut.cells import CELLS
from abut.dofs import dofs_at
from abut.mesh.mesh import Mesh
from abut.mesh.quadrature import PRESSURES, stiffness_rule
from abut.types import Sparse
from abut.verify.norms import h1_matrix

Array = NDArray[np.float64]


def cell_inf_sup(mesh: Mesh, free: NDArray[np.bool_], pressures: int, length: float = 1.0) -> float:
    """Smallest beta of beta^2 (q, q) = sup_v (q, div v)^2 / |v|^2 over the pressures of all cells, theory (E7).

    pressures: of each cell, 1, or 1 and one for each coordinate; |v|: the H1 norm with ``length``; free: (n_points,), v is
    zero at the other points.

    A constant that falls as the mesh is refined means pressures that no displacement feels (Chapelle and Bathe 1993)."""
    divergence = _divergence(mesh, ((block.kind, block.nodes, pressures) for block in mesh.blocks))
    return _smallest(mesh, divergence, np.eye(divergence.shape[0]), free, length)


def continuous_inf_sup(mesh: Mesh, free: NDArray[np.bool_], length: float = 1.0) -> float:
    """The same over pressures that are linear in tet10 cells and continuous, theory (E8), of a mesh that is one body."""
    block = next(block for block in mesh.blocks if block.kind == KIND)
    corner, body = numbered(block.nodes, np.zeros(len(block.nodes), dtype=np.int64))
    of = CornerPressures(np.ascontiguousarray(mesh.points), block.nodes, np.arange(len(corner)), corner, (), body)
    divergence, mass = continuous_products(of)
    return _smallest(mesh, divergence, mass, free, length)


def continuous_products(of: CornerPressures) -> tuple[Sparse, Array]:
    """int q div v (n_corners, dim n_points) and int q q (n_corners, n_corners), the q linear between corners."""
    linear = linear_functions(of.rule[0])
    products = np.einsum("cq,qv,qw->cvw", of.point_volumes, linear, linear)
    mass = np.zeros((of.count,) * 2)
    np.add.at(mass, (of.corner[:, :, None], of.corner[:, None, :]), products)
    return sp.diags(of.volume) @ of.at_rest.rows.tocsr(), mass


def _smallest(mesh: Mesh, divergence: sp.spmatrix, mass: Array, free: NDArray[np.bool_], length: float) -> float:
    """Root of the smallest eigenvalue; mass: of the pressures."""
    norm = sp.kron(h1_matrix(mesh, length), sp.eye(mesh.dim), format="csc")
    kept = np.flatnonzero(np.repeat(free, mesh.dim))
    divergence = divergence.tocsc()[:, kept]
    lifted = spla.splu(norm[kept][:, kept].tocsc()).solve(divergence.T.toarray())
    smallest = scipy.linalg.eigvalsh(divergence @ lifted, mass, subset_by_index=[0, 0])[0]
    return float(np.sqrt(max(smallest, 0.0)))


def mixed_products(solids: Solids, most: int) -> tuple[Sparse, Array] | None:
    """int q div v (pressures, dim n_points) and int q q (pressures, pressures) of all mixed cells, be their pressures their
    own (``cell_inf_sup``) or continuous (``continuous_inf_sup``). None without such cells, where pressures are more than
    ``most``, and of axisymmetric bodies: their hoop strains are neither in these products nor in the H1 norm."""
    own = [
        (group.kind, group.nodes, PRESSURES[group.kind])
        for group in solids.groups()
        if group.integration == "mixed" and group.kind in PRESSURES
    ]
    shared = solids.pressures
    count = sum(len(nodes) * pressures for _, nodes, pressures in own) + (shared.count if shared else 0)
    if not 0 < count <= most or solids.mesh.axisymmetric:
        return None
    parts = [continuous_products(shared)] if shared else []
    if own:
        divergence = _divergence(solids.mesh, own)
        parts.append((divergence, np.eye(divergence.shape[0])))
    divergences, masses = zip(*parts)
    return sp.vstack(divergences, format="csr"), scipy.linalg.block_diag(*masses)


def _divergence(mesh: Mesh, cells: Iterable[tuple[str, NDArray[np.int32], int]]) -> sp.csc_matrix:
    """(pressures of all cells, dim n_points): int q div v, the q of a cell orthonormal. cells: kind, nodes, pressures of
    each."""
    rows, columns, values, done = [], [], [], 0
    for kind, nodes, pressures in cells:
        xi, weights = stiffness_rule(kind)
        shapes, slopes = shape_functions(CELLS[kind].code, np.ascontiguousarray(xi))
        x = mesh.points[nodes]
        jacobian = np.einsum("qna,cnb->cqab", slopes, x)
        volume = np.abs(np.linalg.det(jacobian)) * weights
        gradient = np.einsum("cqab,qnb->cqna", np.linalg.inv(jacobian), slopes)
        places = np.einsum("qn,cna->cqa", shapes, x)
        places -= (np.einsum("cq,cqa->ca", volume, places) / volume.sum(axis=1)[:, None])[:, None]
        functions = np.concatenate([np.ones((*volume.shape, 1)), places], axis=2)[:, :, :pressures]
        root = np.linalg.cholesky(np.einsum("cqm,cq,cqk->cmk", functions, volume, functions))
        functions = np.swapaxes(np.linalg.solve(root, np.swapaxes(functions, 1, 2)), 1, 2)
        own = np.einsum("cqm,cq,cqna->cmna", functions, volume, gradient)
        dofs = dofs_at(nodes, mesh.dim)
        n = own.shape[0] * own.shape[1]
        rows.append(np.repeat(done + np.arange(n), dofs[0].size))
        columns.append(np.repeat(dofs.reshape(len(own), -1), pressures, axis=0).ravel())
        values.append(own.ravel())
        done += n
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    return sp.csc_matrix(entries, shape=(done, mesh.points.size))
