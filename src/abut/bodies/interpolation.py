"""What straight cells leave of forces: those by which the stresses of interpolated displacements differ from the stresses of
the displacements themselves, in triangles and tetrahedra of first order; theory (Z11)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.bodies.recovery import compliances
from abut.bodies.solids import Array, Solids, TemperatureChange
from abut.cells import CELLS
from abut.materials.places import uniform_expansion
from abut.mesh.quadrature import gauss_rule

Ids = NDArray[np.int32]
SIMPLEX = ("tri3", "tet4")
ROWS = ((0, 3, 5), (3, 1, 4), (5, 4, 2))  # of a tensor, in xx yy zz xy yz zx
ORDER = 3  # of the rule round an axis; elsewhere the middle will do, in which slopes are those in the mean


def interpolation_forces(solids: Solids, stress: Sequence[Array | None], temperature: TemperatureChange) -> Array:
    """int B^T sigma(u - I u), (n_points, dim), with I u linear in the cells between the nodes, and second derivatives of the
    displacement u from the strains that stresses at the cells' nodes tell.

    stress: by block of the mesh, (n, n_nodes, 6) of smooth fields at the nodes of its cells, None where a block is left
    out; at small strains and of linear materials."""
    mesh, dim = solids.mesh, solids.mesh.dim
    result = np.zeros(mesh.points.shape)
    compliance, which = compliances(solids)
    stiffness = _stiffness(compliance, solids.plane, dim)
    for block, first, values in zip(mesh.blocks, mesh.starts.tolist(), stress):
        if values is None or block.kind not in SIMPLEX:
            continue
        cells = np.flatnonzero(solids.body_of[first : first + len(block.nodes)] >= 0)
        if not len(cells):
            continue
        nodes, number = block.nodes[cells], which[first + cells]
        strain = np.einsum("cab,ckb->cka", compliance[number], values[cells])
        strain[..., 3:] *= 0.5
        strain[..., :3] += _thermal(solids, temperature, nodes, first + cells)[..., None]
        slope, volume = _slopes(solids.points[nodes])
        gradient = np.einsum("ckab,ckd->cabd", strain[..., np.array(ROWS)[:dim, :dim]], slope)
        # u_a,bc = e_ac,b + e_ab,c - e_bc,a
        bend = np.swapaxes(gradient, 2, 3) + gradient - np.einsum("zbca->zabc", gradient)
        force = _forces(solids, block.kind, (nodes, slope, volume), bend, stiffness[number])
        for a in range(dim):
            result[:, a] += np.bincount(nodes.ravel(), force[..., a].ravel(), len(result))
    return result


def _thermal(solids: Solids, temperature: TemperatureChange, nodes: Ids, cells: NDArray[np.int64]) -> Array:
    """Strain by nodal temperatures at the cells' nodes; what a body has all over has no gradient."""
    if temperature.nodes is None:
        return np.zeros(nodes.shape)
    expansion = np.array([uniform_expansion(material) or 0.0 for material in solids.materials.values()])
    return np.asarray(expansion[solids.body_of[cells]][:, None] * temperature.nodes[nodes])


def _slopes(x: Array) -> tuple[Array, Array]:
    """Gradients of the corners' functions (n, k, dim) and volumes (n,) of simplices x (n, k, dim)."""
    dim = x.shape[2]
    edges = x[:, 1:] - x[:, :1]
    inverse = np.swapaxes(np.linalg.inv(edges), 1, 2)
    volume = np.abs(np.linalg.det(edges)) / (2.0 if dim == 2 else 6.0)
    return np.concatenate([-inverse.sum(axis=1, keepdims=True), inverse], axis=1), volume


def _forces(solids: Solids, kind: str, cells: tuple[Ids, Array, Array], bend: Array, stiffness: Array) -> Array:
    """Of each cell at its nodes, (n, k, dim). cells: nodes, slopes, volumes; bend: (n, dim, dim, dim) second derivatives."""
    nodes, slope, volume = cells
    x, (n, k, dim) = solids.points[nodes], slope.shape
    around = solids.mesh.axisymmetric
    rule = gauss_rule(kind, ORDER if around else 1)
    shapes, _ = shape_functions(CELLS[kind].code, np.ascontiguousarray(rule[0]))
    left = {}  # of u less its interpolate: - 1/2 sum over edges of d . bend d times both functions
    for i in range(k):
        for j in range(i + 1, k):
            step = x[:, i] - x[:, j]
            left[i, j] = -0.5 * np.einsum("cb,cabd,cd->ca", step, bend, step)
    result = np.zeros((n, k, dim))
    for shape, weight in zip(shapes, rule[1] / rule[1].sum()):
        turned, moved = np.zeros((n, dim, dim)), np.zeros((n, dim))
        for (i, j), part in left.items():
            turned += part[:, :, None] * (shape[i] * slope[:, j] + shape[j] * slope[:, i])[:, None]
            moved += shape[i] * shape[j] * part
        radius = x[..., 0] @ shape if around else np.ones(n)
        hoop = moved[:, 0] / radius if around else np.zeros(n)
        sigma = (stiffness @ _voigt(turned, hoop)[..., None])[..., 0]
        area = weight * volume * (2.0 * np.pi * radius if around else 1.0)
        tensor = sigma[:, np.array(ROWS)[:dim, :dim]]
        result += area[:, None, None] * np.einsum("cab,ckb->cka", tensor, slope)
        if around:
            result[..., 0] += (area * sigma[:, 2] / radius)[:, None] * shape
    return result


def _voigt(gradient: Array, hoop: Array) -> Array:
    """Strains xx yy zz xy (yz zx), shear doubled, of slopes (n, dim, dim)."""
    both = gradient + np.swapaxes(gradient, 1, 2)
    normal = [gradient[:, a, a] for a in range(gradient.shape[1])]
    if len(normal) == 2:
        return np.stack([*normal, hoop, both[:, 0, 1]], axis=1)
    return np.stack([*normal, both[:, 0, 1], both[:, 1, 2], both[:, 2, 0]], axis=1)


def _stiffness(compliance: Array, plane: str | None, dim: int) -> Array:
    """(n, c, c) of (n, 6, 6): of bodies in plane stress without what resists across."""
    if dim == 3:
        return np.asarray(np.linalg.pinv(compliance, hermitian=True))
    if plane == "stress":
        flat = np.zeros((len(compliance), 4, 4))
        own = np.ix_(range(len(compliance)), [0, 1, 3], [0, 1, 3])
        flat[own] = np.linalg.pinv(compliance[own], hermitian=True)
        return flat
    return np.asarray(np.linalg.pinv(compliance, hermitian=True)[:, :4, :4])
