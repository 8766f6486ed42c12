"""What integrals over cells share: cells in manageable pieces, gradients and volumes at integration points."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from abut.mesh.mesh import Mesh

CHUNK = 4096  # cells treated at once where NumPy does the work


def chunks(mesh: Mesh) -> Iterator[tuple[str, NDArray[np.int32], slice]]:
    """All cells in manageable pieces: type, connectivity (n, n_nodes), cell numbers."""
    for block, first in zip(mesh.blocks, mesh.starts.tolist()):
        for i in range(0, len(block.nodes), CHUNK):
            part = block.nodes[i : i + CHUNK]
            yield block.kind, part, slice(first + i, first + i + len(part))


def body_chunks(mesh: Mesh, body: str) -> Iterator[tuple[str, NDArray[np.int32]]]:
    """Cells of a body in manageable pieces: type, connectivity (n, n_nodes)."""
    for kind, nodes, _ in mesh.cells_of(body):
        for i in range(0, len(nodes), CHUNK):
            yield kind, nodes[i : i + CHUNK]


def gradients(
    points: NDArray[np.float64], nodes: NDArray[np.int32], derivatives: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Gradients of the shape functions (cells, q, n, dim) and Jacobian determinants (cells, q), from connectivity (cells, n)
    and the reference derivatives (q, n, dim) of one cell type."""
    n, (q, k, dim) = len(nodes), derivatives.shape
    # Matrix products and cofactors: several times faster than einsum and linalg.inv on stacks of small matrices.
    jacobian = (
        points[nodes].transpose(0, 2, 1).reshape(-1, k) @ derivatives.transpose(1, 0, 2).reshape(k, -1)
    ).reshape(n, dim, q, dim)
    columns = [jacobian[..., b].transpose(0, 2, 1) for b in range(dim)]  # (cells, q, dim) each
    if dim == 2:
        (a, c), (b, d) = (np.moveaxis(column, -1, 0) for column in columns)
        det = a * d - b * c
        inverse = np.stack([np.stack([d, -b], -1), np.stack([-c, a], -1)], -2) / det[..., None, None]
    else:
        rows = [np.cross(columns[(a + 1) % 3], columns[(a + 2) % 3]) for a in range(3)]
        det = (columns[0] * rows[0]).sum(axis=-1)
        inverse = np.stack(rows, axis=-2) / det[..., None, None]
    return np.matmul(derivatives[None], inverse), det


def determinants(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of stacks (..., dim, dim) of small matrices, written out: several times faster than linalg.det."""
    if matrices.shape[-1] == 1:
        return matrices[..., 0, 0]
    if matrices.shape[-1] == 2:
        return np.asarray(matrices[..., 0, 0] * matrices[..., 1, 1] - matrices[..., 0, 1] * matrices[..., 1, 0])
    (a, b, c), (d, e, f), (g, h, i) = (np.moveaxis(matrices[..., row, :], -1, 0) for row in range(3))
    return np.asarray(a * (e * i - f * h) + b * (f * g - d * i) + c * (d * h - e * g))
