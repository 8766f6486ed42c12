"""Stresses of cells of first order without what their interpolation misses of displacements that bend; theory (Z13)."""

from __future__ import annotations

from functools import cache
from itertools import combinations_with_replacement, product

import numpy as np
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.bodies.compliance import compliances
from abut.bodies.interpolation import stiffnesses, thermal
from abut.bodies.patch_fits import Fits
from abut.bodies.solids import Array, Solids, TemperatureChange
from abut.bodies.stress import PointStress
from abut.cells import CELLS
from abut.mesh.reference import reference_nodes

TENSOR = ((0, 3, 5), (3, 1, 4), (5, 4, 2))  # components of a tensor's rows in xx yy zz xy yz zx
AT_ONCE = 1000  # cells, of which what is in work stays in the cache
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


def without_interpolation(
    fits: Fits, temperature: TemperatureChange, some: NDArray[np.bool_] | None = None
) -> PointStress:  # fmt: skip
    """The stresses ``fits.stress`` less C (e(I u) - e(u)) in the middle of each of the ``straight`` cells, with I u the
    interpolate between the nodes of a displacement u whose strains bend as the polynomials do; other cells as they are.
    some: (n_cells,) only these, all where left out."""
    solids = fits.sampling.solids
    chosen, of = straight(solids), solids.patches
    chosen = chosen if some is None else chosen & some
    origin = fits.sampling.centre.mean(axis=0)
    patch, asked = _around(solids, chosen)
    slope, second = _derivatives(fits, origin, asked)
    bends = np.any(second != 0.0, axis=(1, 2)).astype(float)
    compliance, which = compliances(solids)
    stiffness = stiffnesses(compliance, solids.plane, solids.mesh.dim)
    result = []
    for group, stress in zip(solids.groups(), fits.stress):
        every = np.flatnonzero(chosen[group.cells])
        mended = stress.copy() if len(every) else stress
        for rows in np.split(every, range(AT_ONCE, len(every), AT_ONCE)) if len(every) else ():
            cells, nodes = group.cells[rows], group.nodes[rows]
            at = solids.points[nodes] - origin
            corners = patch[of.of_cells(cells, solids.mesh.starts)]
            steep, curve = (
                _strains(compliance[which[cells]], d) for d in _in_middles(corners, at, slope, second, bends)
            )
            shapes = slopes_in_middle(group.kind, at)
            swelling = thermal(solids, temperature, nodes, cells)
            if swelling is not None:
                steep[..., :3] += np.einsum("ck,cka->ca", swelling, shapes)[..., None]
            middle = at.mean(axis=1)
            radius = middle[:, 0] + origin[0] if solids.mesh.axisymmetric else None
            error = missed_strains(shapes, at - middle[:, None], steep, curve, radius)
            mended[rows, :, : error.shape[1]] -= (stiffness[which[cells]] @ error[..., None])[:, None, :, 0]
        result.append(mended)
    return tuple(result)


def _in_middles(
    corners: NDArray[np.int64], at: Array, slope: Array, second: Array, bends: Array
) -> tuple[Array, Array]:
    """Slopes (cells, dim, C) and second derivatives (cells, pairs, C) in the middles of cells: the means of those of the
    polynomials round their corners, the second ones of those that are not linear, as they are where bodies end.

    corners: (cells, k) patches; at: (cells, k, dim) from where the slopes of the polynomials are taken;
    bends: (n_patches,) 1 for those that are not linear."""
    dim, middle = at.shape[2], at.mean(axis=1)
    curve, steep = (sum(of[corner] for corner in corners.T) / corners.shape[1] for of in (second, slope))
    for row, (a, b) in enumerate(PAIRS[dim]):
        steep[:, a] += curve[:, row] * middle[:, b, None]
        if a != b:
            steep[:, b] += curve[:, row] * middle[:, a, None]
    told = bends[corners].mean(axis=1)
    return steep, curve / np.where(told > 0.0, told, 1.0)[:, None, None]


def _around(solids: Solids, chosen: NDArray[np.bool_]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The patches (n,) around the corners of chosen cells (n_cells,), and of each value of the bodies' points which of
    these it is, -1 for none."""
    of, needed = solids.patches, np.zeros(len(solids.patches.point), dtype=bool)
    for group in solids.groups():
        cells = group.cells[chosen[group.cells]]
        if len(cells):
            needed[of.of_cells(cells, solids.mesh.starts)] = True
    asked = np.flatnonzero(needed[of.corner])
    patch = np.full(len(of.point), -1, dtype=np.int64)
    patch[of.corner[asked]] = np.arange(len(asked))
    return patch, asked


def _derivatives(fits: Fits, origin: Array, asked: NDArray[np.int64]) -> tuple[Array, Array]:
    """Of n polynomials that are asked for: slopes at ``origin`` (n, dim, C), and second derivatives (n, pairs, C)."""
    dim, coefficients = len(origin), fits.coefficients[asked]
    own = np.linalg.inv(np.tril(fits.metrics[asked]))
    slope = np.swapaxes(own, 1, 2) @ coefficients[:, 1 : 1 + dim]
    share = np.zeros((len(own), len(PAIRS[dim]), len(PAIRS[dim])))
    for row, (a, b) in enumerate(PAIRS[dim]):
        for term, (c, d) in enumerate(PAIRS[dim]):
            if c >= a and d >= b:  # of a lower triangle; d >= c and b >= a
                share[:, row, term] = own[:, c, a] * own[:, d, b] + own[:, c, b] * own[:, d, a]
    second = share @ coefficients[:, 1 + dim :]
    away = origin - fits.sampling.centre[asked]
    for row, (a, b) in enumerate(PAIRS[dim]):
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
