"""Forces that straight triangles and tetrahedra leave of bent displacements, theory (Z11), with arrays: beside the compiled
ones."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.bodies.compliance import compliances
from abut.bodies.solids import Solids
from abut.mesh.quadrature import gauss_rule
from abut.types import Array

ROWS = ((0, 3, 5), (3, 1, 4), (5, 4, 2))  # of a tensor, in xx yy zz xy yz zx


def forces_by_arrays(solids: Solids, kind: str, nodes: NDArray[np.int32], stress: Array, thermal: Array) -> Array:
    """(n_points, dim). nodes: (n, k) of all cells, which have one kind and materials the same everywhere in a body; stress:
    (n, k, 6) and thermal strain (n, k) at them."""
    dim, x = solids.mesh.dim, solids.points[nodes]
    compliance, which = compliances(solids)
    strain = np.einsum("cab,ckb->cka", compliance[which], stress)
    strain[..., 3:] *= 0.5
    strain[..., :3] += thermal[..., None]
    edges = x[:, 1:] - x[:, :1]
    inverse = np.swapaxes(np.linalg.inv(edges), 1, 2)
    slope = np.concatenate([-inverse.sum(axis=1, keepdims=True), inverse], axis=1)
    volume = np.abs(np.linalg.det(edges)) / (2.0 if dim == 2 else 6.0)
    change = np.einsum("ckab,ckd->cabd", strain[..., np.array(ROWS)[:dim, :dim]], slope)
    bend = np.swapaxes(change, 2, 3) + change - np.einsum("zbca->zabc", change)
    ones, n, k = np.ones(len(nodes)), len(nodes), nodes.shape[1]
    around = solids.mesh.axisymmetric
    at, weights = gauss_rule(kind, 3 if around else 1)
    force = np.zeros((n, k, dim))
    for xi, weight in zip(at, weights / weights.sum()):
        shape = np.concatenate([[1.0 - xi.sum()], xi])
        turned, moved = np.zeros((n, dim, dim)), np.zeros((n, dim))
        for i in range(k):
            for j in range(i + 1, k):
                step = x[:, i] - x[:, j]
                left = -0.5 * np.einsum("cb,cabd,cd->ca", step, bend, step)
                turned += left[:, :, None] * (shape[i] * slope[:, j] + shape[j] * slope[:, i])[:, None]
                moved += shape[i] * shape[j] * left
        radius = x[..., 0] @ shape if around else ones
        both = np.zeros((n, 3, 3))
        both[:, :dim, :dim] = turned + np.swapaxes(turned, 1, 2)
        both[:, range(3), range(3)] /= 2.0
        if around:
            both[:, 2, 2] = moved[:, 0] / radius
        strains = np.stack([both[:, a, b] for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))], axis=1)
        sigma = np.linalg.solve(compliance[which], strains[..., None])[..., 0]
        area = weight * volume * (2.0 * np.pi * radius if around else 1.0)
        force += area[:, None, None] * np.einsum("cab,ckb->cka", sigma[:, np.array(ROWS)[:dim, :dim]], slope)
        if around:
            force[..., 0] += (area * sigma[:, 2] / radius)[:, None] * shape
    result = np.zeros(solids.points.shape)
    np.add.at(result, nodes, force)
    return result
