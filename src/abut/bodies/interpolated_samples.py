"""Stresses of cells of first order without what their interpolation misses of displacements that bend; theory (Z13)."""

from __future__ import annotations

from functools import cache
from itertools import combinations_with_replacement, product

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.bodies.compliance import compliances
from abut.bodies.interpolation import stiffnesses, thermal
from abut.bodies.patch_fits import Fits
from abut.bodies.solids import Array, Solids, TemperatureChange
from abut.bodies.stress import PointStress
from abut.cells import CELLS
from abut.mesh.reference import reference_nodes
from abut.types import Sparse

TENSOR = ((0, 3, 5), (3, 1, 4), (5, 4, 2))  # components of a tensor's rows in xx yy zz xy yz zx
PAIRS = {dim: list(combinations_with_replacement(range(dim), 2)) for dim in (2, 3)}
TRIPLES = {dim: list(combinations_with_replacement(range(dim), 3)) for dim in (2, 3)}


def straight(solids: Solids) -> NDArray[np.bool_]:
    """Cells (n_cells,) whose stresses are linear in strains that the shape functions of first order give point by point."""
    result = np.zeros(solids.mesh.n_cells, dtype=bool)
    if solids.kinematics != "small":
        return result
    constant = np.array([material.constant for material in solids.materials.values()], dtype=bool)
    for group in solids.groups():
        if group.integration == "full" and CELLS[group.kind].degree == 1:
            result[group.cells] = constant[solids.body_of[group.cells]]
    return result


def without_interpolation(fits: Fits, temperature: TemperatureChange) -> PointStress:
    """The stresses ``fits.stress`` less C (e(I u) - e(u)) in the middle of each of the ``straight`` cells, with I u the
    interpolate between the nodes of a displacement u whose strains bend as the polynomials do; other cells as they are."""
    solids, chosen = fits.sampling.solids, straight(fits.sampling.solids)
    of, dim = solids.patches, solids.mesh.dim
    origin = fits.sampling.centre.mean(axis=0)
    slope, second = _derivatives(fits, origin)
    bends = np.any(second != 0.0, axis=(1, 2)).astype(float)  # polynomials at free ends are linear: they do not tell
    patch = np.full(len(of.point), -1, dtype=np.int64)
    patch[of.corner] = np.arange(len(of.corner))
    compliance, which = compliances(solids)
    stiffness = stiffnesses(compliance, solids.plane, dim)
    result = []
    for group, stress in zip(solids.groups(), fits.stress):
        rows = np.flatnonzero(chosen[group.cells])
        if not len(rows):
            result.append(stress)
            continue
        cells, x = group.cells[rows], solids.points[group.nodes[rows]]
        number, middle = which[cells], x.mean(axis=1)
        slopes = slopes_in_middle(group.kind, x)
        around = _means(patch[of.of_cells(cells, solids.mesh.starts)], len(bends))
        curve = _weighted(around, second)
        steep = _weighted(around, slope)
        for row, (a, b) in enumerate(PAIRS[dim]):
            steep[:, a] += curve[:, row] * (middle - origin)[:, b, None]
            if a != b:
                steep[:, b] += curve[:, row] * (middle - origin)[:, a, None]
        curve /= np.maximum(around @ bends, 0.5 / x.shape[1])[:, None, None]
        first, further = (_strains(compliance[number], of_stress) for of_stress in (steep, curve))
        swelling = thermal(solids, temperature, group.nodes[rows], cells)
        if swelling is not None:
            first[..., :3] += np.einsum("ck,cka->ca", swelling, slopes)[..., None]
        radius = middle[:, 0] if solids.mesh.axisymmetric else None
        error = missed_strains(slopes, x - middle[:, None], first, further, radius)
        mended = stress.copy()
        mended[rows, :, : error.shape[1]] -= (stiffness[number] @ error[..., None])[:, None, :, 0]
        result.append(mended)
    return tuple(result)


def _means(corners: NDArray[np.int64], n_patches: int) -> Sparse:
    """(n_cells, n_patches) CSR of the mean over the corners of each cell."""
    count, each = corners.shape
    starts = np.arange(0, count * each + 1, each)
    return sp.csr_matrix((np.full(count * each, 1.0 / each), corners.ravel(), starts), shape=(count, n_patches))


def _weighted(of: Sparse, values: Array) -> Array:
    return np.asarray(of @ values.reshape(len(values), -1)).reshape(of.shape[0], *values.shape[1:])


def _derivatives(fits: Fits, origin: Array) -> tuple[Array, Array]:
    """Of all polynomials: slopes at ``origin`` (n_patches, dim, C), and second derivatives (n_patches, pairs, C)."""
    dim, coefficients = len(origin), fits.coefficients
    own = np.linalg.inv(np.tril(fits.metrics))
    slope = np.swapaxes(own, 1, 2) @ coefficients[:, 1 : 1 + dim]
    second = np.zeros((len(own), len(PAIRS[dim]), coefficients.shape[2]))
    away = origin - fits.sampling.centre
    for row, (a, b) in enumerate(PAIRS[dim]):
        for term, (c, d) in enumerate(PAIRS[dim], start=1 + dim):  # d >= c, and of a lower triangle d >= b and c >= a
            if d < b or c < a:
                continue
            share = own[:, c, a] * own[:, d, b] + own[:, c, b] * own[:, d, a]
            second[:, row] += share[:, None] * coefficients[:, term]
        slope[:, a] += second[:, row] * away[:, b, None]
        if a != b:
            slope[:, b] += second[:, row] * away[:, a, None]
    return slope, second


def _strains(compliance: Array, stress: Array) -> Array:
    """Components of tensors (n, m, 6) of stresses (n, m, 4 or 6)."""
    result = stress @ np.swapaxes(compliance[:, :, : stress.shape[-1]], 1, 2)
    result[..., 3:] *= 0.5
    return np.asarray(result)


def slopes_in_middle(kind: str, x: Array) -> Array:
    """Of the shape functions of cells, (cells, k, dim); x: (cells, k, dim)."""
    _, derivatives = shape_functions(CELLS[kind].code, reference_nodes(kind).mean(axis=0, keepdims=True))
    return np.asarray(derivatives[0] @ np.linalg.inv(np.swapaxes(x, 1, 2) @ derivatives[0]))


@cache
def _series(dim: int) -> tuple[Array, Array]:
    """Of slopes (dim, 6) and second derivatives (pairs, 6) of the strain the terms of the displacement, (dim of it, pairs or
    triples of coordinates): u_a,bc = e_ab,c + e_ac,b - e_bc,a, and its slopes."""
    pairs, triples = PAIRS[dim], TRIPLES[dim]
    second, third = np.zeros((dim, 6, dim, len(pairs))), np.zeros((len(pairs), 6, dim, len(triples)))
    for a, b, c in product(range(dim), repeat=3):
        at = pairs.index((min(b, c), max(b, c)))
        second[c, TENSOR[a][b], a, at] += 1.0
        second[a, TENSOR[b][c], a, at] -= 0.5
        for d in range(dim):
            low, middle, high = sorted((b, c, d))
            at = triples.index((low, middle, high))
            third[pairs.index((min(c, d), max(c, d))), TENSOR[a][b], a, at] += 1.0 / 3.0
            third[pairs.index((min(a, d), max(a, d))), TENSOR[b][c], a, at] -= 1.0 / 6.0
    return second.reshape(dim * 6, -1), third.reshape(len(pairs) * 6, -1)


def missed_strains(slopes: Array, x: Array, steep: Array, curve: Array, radius: Array | None) -> Array:
    """Strains (cells, 4 or 6), shear doubled, of the interpolate less those of the displacement itself, in the middles.
    slopes: of the shape functions there; x: (cells, k, dim) nodes from there; steep: (cells, dim, 6) slopes of the strain,
    curve: (cells, pairs, 6) second derivatives; radius: (cells,) in bodies of revolution."""
    n, k, dim = x.shape
    second, third = _series(dim)
    terms = np.empty((n, k, len(PAIRS[dim]) + len(TRIPLES[dim])))
    for row, (a, b) in enumerate(PAIRS[dim]):
        terms[..., row] = x[..., a] * x[..., b]
    for row, (a, b, c) in enumerate(TRIPLES[dim], start=len(PAIRS[dim])):
        terms[..., row] = terms[..., PAIRS[dim].index((a, b))] * x[..., c]
    parts = ((steep.reshape(n, -1) @ second), (curve.reshape(n, -1) @ third))
    nodal = terms @ np.swapaxes(np.concatenate([part.reshape(n, dim, -1) for part in parts], axis=2), 1, 2)
    turned = np.swapaxes(nodal, 1, 2) @ slopes
    result = np.zeros((n, 4 if dim == 2 else 6))
    for a, b in PAIRS[dim]:
        result[:, TENSOR[a][b]] = turned[:, a, b] if a == b else turned[:, a, b] + turned[:, b, a]
    if radius is not None:
        result[:, 2] = nodal[..., 0].mean(axis=1) / radius
    return result
