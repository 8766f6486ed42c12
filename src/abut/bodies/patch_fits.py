"""Polynomials fitted to the stresses around each corner of the bodies; theory (Z1), (Z2), (Z4)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut._core import corner_stresses, evaluate_patches, fit_patches, shape_functions
from abut.bodies.image_cells import ImageCells, image_cells, planes_of
from abut.bodies.solids import Array, Solids
from abut.bodies.stress import PointStress
from abut.cells import CELLS
from abut.mesh.patches import Patches
from abut.mesh.quadrature import Rule, superconvergent_rule
from abut.types import Sparse

HEAVY = 1.0  # weight of all equations at a patch's surface over that of its samples
PLANE = (0, 1, 2, 3)  # components in 2D


@dataclass(frozen=True)
class Equations:
    """What is known of the stress at the surface. x: (n, dim); coefficients: (n, 4 or 6) of xx yy zz xy (yz zx), shear
    doubled, whose sum with the stress is value (n,); of: (n_patches, n) CSR, nonzero where an equation takes part in a
    patch; planes: (n_patches, 3) planes through its corner that mirror a patch, -1 for none; normals: (n_planes, dim); bare:
    (n_patches,) patches that end at a surface which no plane continues; node: (m,) points of the mesh, of one body each, at
    which the whole stress is known, given: (m, 4 or 6)."""

    x: Array
    coefficients: Array
    value: Array
    of: Sparse
    planes: NDArray[np.int32]
    normals: Array
    bare: NDArray[np.bool_]
    node: NDArray[np.int64]
    given: Array


def no_equations(of: Patches, dim: int) -> Equations:
    """Nothing is known."""
    n, none = len(of.corner), np.zeros((0, 4 if dim == 2 else 6))
    return Equations(
        np.zeros((0, dim)), none, np.zeros(0), sp.csr_matrix((n, 0)),
        np.full((n, 3), -1, dtype=np.int32), np.zeros((0, dim)), np.diff(of.skin.indptr) > 0,
        np.zeros(0, dtype=np.int64), none,
    )  # fmt: skip


@dataclass(frozen=True)
class Sampling:
    """Where patches take their samples, the same for all stresses of bodies that stay where they are. points: (n_points,
    dim); planes, bare: as in ``Equations``; centre: (n_patches, dim); images: of cells; x: (m, dim) positions, cell after
    cell, images last, the first of each in ``first`` (n_cells + n_images + 1,); spread: (n_cells + n_images, dim + 1, dim)
    mean and second moments of each cell's corners."""

    solids: Solids
    points: Array
    planes: NDArray[np.int32]
    bare: NDArray[np.bool_]
    centre: Array
    images: ImageCells
    x: Array
    first: NDArray[np.int64]
    spread: Array

    @classmethod
    def of(cls, solids: Solids, points: Array, known: Equations) -> Sampling:
        """points: (n_points, dim) where they are now."""
        patches, mesh = solids.patches, solids.mesh
        centre = np.ascontiguousarray(points[patches.point[patches.corner]])
        images = image_cells(patches.around, planes_of(known.planes, centre), mesh.dim)
        count = np.zeros(mesh.n_cells, dtype=np.int64)
        rules = [(group, superconvergent_rule(group.kind)) for group in solids.groups()]
        for group, rule in rules:
            count[group.cells] = len(rule[1])
        first = np.concatenate([[0], np.cumsum(count)])
        x = np.empty((first[-1], mesh.dim))
        for group, rule in rules:
            shapes, _ = shape_functions(CELLS[group.kind].code, np.ascontiguousarray(rule[0]))
            x[_rows(first, group.cells, len(rule[1]))] = shapes @ points[group.nodes]
        own = cls(solids, points, known.planes, known.bare, centre, images, x, first, spread(solids, points))
        return own._with_images(count)

    def serves(self, points: Array, known: Equations) -> bool:
        """Whether samples are taken so with what is known now."""
        same = points is self.points or np.array_equal(points, self.points)
        return same and np.array_equal(known.planes, self.planes) and np.array_equal(known.bare, self.bare)

    def values(self, stress: PointStress) -> Array:
        """Stresses at ``x``, (m, 4 or 6), of those at the integration points."""
        n_own, images = self.first[self.solids.mesh.n_cells], self.images
        values = np.empty((n_own, 6))
        for group, at in zip(self.solids.groups(), stress):
            rule = superconvergent_rule(group.kind)
            values[_rows(self.first, group.cells, len(rule[1]))] = carried(group.kind, group.rule, rule[0]) @ at
        values = np.ascontiguousarray(values[:, used(self.points.shape[1])])
        if not len(images.cell):
            return values
        which, rows = self._of_images()
        return np.concatenate([values, images.tensors(values[rows], which)])

    def _of_images(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Of each sample of an image the image, and the sample that it is one of."""
        n_cells, cell = self.solids.mesh.n_cells, self.images.cell
        count = np.diff(self.first[: n_cells + 1])[cell]
        which = np.repeat(np.arange(len(count)), count)
        return which, self.first[cell][which] + np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)

    def _with_images(self, count: NDArray[np.int64]) -> Sampling:
        """The same with those of image cells after the cells' own, of which there are ``count`` (n_cells,)."""
        images, dim = self.images, self.points.shape[1]
        if not len(images.cell):
            return self
        which, rows = self._of_images()
        mean, moments = self.spread[images.cell, 0], self.spread[images.cell, 1:]
        sign = np.where(images.turned, -1.0, 1.0)
        middle = images.places(mean, np.arange(len(mean)))[:, None]
        more = np.concatenate([middle, sign[:, :, None] * moments * sign[:, None]], axis=1)
        return replace(
            self, x=np.concatenate([self.x, images.places(self.x[rows], which)]),
            first=np.concatenate([self.first, self.first[-1] + np.cumsum(count[images.cell])]),
            spread=np.concatenate([self.spread, more.reshape(-1, dim + 1, dim)]),
        )  # fmt: skip


@dataclass(frozen=True)
class Fits:
    """The polynomials of all patches, of ``stress`` at the integration points. coefficients: (n_patches, terms, 4 or 6),
    metrics: (n_patches, dim, dim), as ``evaluate_patches`` takes them; alone: no equation takes part."""

    sampling: Sampling
    stress: PointStress
    coefficients: Array
    metrics: Array
    alone: bool

    def at(self, x: Array, shares: Sparse) -> Array:
        """Stresses xx yy zz xy yz zx (n, 6) at positions x (n, dim): patches' polynomials times ``shares`` (n, n_patches),
        CSR."""
        found = evaluate_patches(
            np.ascontiguousarray(x), *_lists(shares), shares.data, self.sampling.centre, self.coefficients, self.metrics
        )
        if found.shape[1] == 6:
            return np.asarray(found)
        result = np.zeros((len(x), 6))
        result[:, used(x.shape[1])] = found
        return result

    def at_corners(self, patches: NDArray[np.int32]) -> Array:
        """Of cells with corners alone, patches (n, k) round these, the mean of the polynomials at each, (n, k, 6)."""
        return np.asarray(corner_stresses(patches, self.sampling.centre, self.coefficients, self.metrics))


def fitted(sampling: Sampling, stress: PointStress, known: Equations, plain: Fits | None = None) -> Fits:
    """plain: fits of the same stresses without equations, to which those of ``known`` come."""
    patches = sampling.solids.patches
    touched = np.arange(len(patches.corner))
    if plain is not None and plain.stress is stress and plain.sampling is sampling and plain.alone:
        touched = np.flatnonzero(np.diff(known.of.indptr))
    coefficients, metrics = fit_patches(
        (sampling.x, sampling.values(stress), sampling.first, sampling.spread),
        *_cover(sampling), (sampling.planes, known.normals),
        (_lists(known.of), known.x, known.coefficients, known.value), HEAVY, touched,
    )  # fmt: skip
    if plain is not None and len(touched) < len(patches.corner):
        every = plain.coefficients.copy(), plain.metrics.copy()
        every[0][touched], every[1][touched] = coefficients, metrics
        coefficients, metrics = every
    return Fits(sampling, stress, coefficients, metrics, known.of.nnz == 0)


def used(dim: int) -> list[int]:
    """Components that bodies have."""
    return list(PLANE) if dim == 2 else list(range(6))


def _cover(sampling: Sampling) -> tuple[object, object]:
    """The cells and images that patches take. Those of first order whose body goes on, and those that end, take the cells
    around the corners of their cells too."""
    patches, images = sampling.solids.patches, sampling.images
    inner = (patches.degree == 1) & ~sampling.bare
    degree, wide = np.where(inner, 2, patches.degree), inner | sampling.bare
    of_cells = patches.around.T.tocsr()
    return (
        (sampling.centre, _lists(patches.around), _lists(of_cells), degree.astype(np.int32), wide.astype(np.int32)),
        (_lists(images.around), images.on, images.by),
    )


def _lists(matrix: Sparse) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    return matrix.indptr.astype(np.int64), matrix.indices.astype(np.int64)


def _rows(first: NDArray[np.int64], cells: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    return np.asarray(first[cells][:, None] + np.arange(count))


def spread(solids: Solids, points: Array) -> Array:
    """Mean of the corners of each cell and their second moments about it, (n_cells, dim + 1, dim)."""
    dim = points.shape[1]
    result = np.zeros((solids.mesh.n_cells, dim + 1, dim))
    for block, first in zip(solids.mesh.blocks, solids.mesh.starts.tolist()):
        x = points[block.nodes[:, : CELLS[block.kind].corners]]
        mean = x.mean(axis=1)
        apart = x - mean[:, None]
        rows = slice(first, first + len(x))
        result[rows, 0] = mean
        result[rows, 1:] = np.swapaxes(apart, 1, 2) @ apart / x.shape[1]
    return result


def carried(kind: str, rule: Rule, xi: Array) -> Array:
    """Linear (on quadrilaterals and hexahedra linear along each axis) fit over a cell to values at the points of a rule, at
    points xi: (len(xi), points)."""
    if len(rule[0]) == len(xi) and np.allclose(rule[0], xi, rtol=0.0, atol=1e-14):
        return np.eye(len(xi))
    root = np.sqrt(np.abs(rule[1]))[:, None]
    terms = _monomials(kind, rule[0])
    rank = np.linalg.matrix_rank(root * terms)
    while terms.shape[1] > rank:  # fewer points: constant
        terms = terms[:, :1]
        rank = 1
    return np.asarray(_monomials(kind, xi)[:, : terms.shape[1]] @ np.linalg.pinv(root * terms) * root.T)


def _monomials(kind: str, xi: Array) -> Array:
    """Of degree 1, for cubes and along wedges times each other."""
    columns = [np.ones(len(xi))]
    if kind.startswith(("quad", "hex")):
        for a in range(xi.shape[1]):
            columns += [column * xi[:, a] for column in columns]
    else:
        columns += [xi[:, a] for a in range(xi.shape[1])]
        if kind.startswith("wedge"):
            columns += [xi[:, 0] * xi[:, 2], xi[:, 1] * xi[:, 2]]
    return np.stack(columns, axis=1)
