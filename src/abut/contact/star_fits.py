"""Polynomials along a surface at its corner points, fitted to the averages or the values at the neighbours."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.cells import CELLS
from abut.contact.geometry import by_kind, facet_measure, pressure_kind
from abut.mesh.quadrature import gauss_rule
from abut.mesh.surface import Surface

ORDER = 5  # of the rule: area element times corner function times a square
FLAT = 1e-6  # eigenvalue over the largest below which a star of points does not determine a coefficient

Array = NDArray[np.float64]
Ids = NDArray[np.int64]


@dataclass(frozen=True)
class Polynomials:
    """f(x) = value + gradient . d + d . curvature d / 2 with d = x - x_i, at points i of a surface in the planes of their
    tangents. value: (n,), gradient: (n, dim), curvature: (n, dim, dim)."""

    value: Array
    gradient: Array
    curvature: Array

    def at(self, points: Array, origin: Array) -> Array:
        """Values (n, q) at points (n, q, dim); origin: (n, dim)."""
        away = points - origin[:, None]
        slope = self.gradient[:, None] + 0.5 * np.einsum("nab,nqb->nqa", self.curvature, away)
        return np.asarray(self.value[:, None] + (slope * away).sum(axis=-1))

    def some(self, which: Ids) -> Polynomials:
        """Those of some of the points, in order."""
        return Polynomials(self.value[which], self.gradient[which], self.curvature[which])

    def slope(self, points: Array, origin: Array) -> Array:
        """Gradients (n, dim) at points (n, dim)."""
        return np.asarray(self.gradient + np.einsum("nab,nb->na", self.curvature, points - origin))


@dataclass(frozen=True)
class Supports:
    """The corner functions' averages of polynomials. mean: (n_points, dim) int N_i (x - x_i) / int N_i; square:
    (n_points, dim, dim) the same of (x - x_i) (x - x_i)^T; over the whole of each facet."""

    mean: Array
    square: Array


def supports(surface: Surface, across: Array | None = None) -> Supports:
    """Of a surface's corner points, zero at others. across: (n_points, 2, dim) unit normals of planes of symmetry through
    points, zero where there are none: their functions go on beyond these."""
    n, dim = surface.points.shape
    weight, mean, square = np.zeros(n), np.zeros((n, dim)), np.zeros((n, dim, dim))
    for kind, facets in by_kind(surface):
        x, force = corner_weights(surface, kind, facets)
        for k in range(force.shape[-1]):
            i = surface.nodes[facets, k].astype(np.int64)
            away = x - surface.points[i][:, None]
            lever = force[..., k, None] * away
            weight += np.bincount(i, force[..., k].sum(axis=1), n)
            mean += summed(i, lever.sum(axis=1), n)
            square += summed(i, np.matmul(lever.transpose(0, 2, 1), away), n)
    weight = np.where(weight > 0.0, weight, 1.0)
    mean, square = mean / weight[:, None], square / weight[:, None, None]
    for normal in () if across is None else np.moveaxis(across, 1, 0):
        at = np.flatnonzero(normal.any(axis=1))
        mirror = np.eye(dim) - 2.0 * normal[at][:, :, None] * normal[at][:, None]
        mean[at] = 0.5 * (mean[at] + (mirror @ mean[at][..., None])[..., 0])
        square[at] = 0.5 * (square[at] + mirror @ square[at] @ mirror)
    return Supports(mean, square)


def summed(here: Ids, values: Array, n: int) -> Array:
    """Values (m, ...) added up by number ``here`` (m,), (n, ...)."""
    width = int(np.prod(values.shape[1:]))
    columns = [np.bincount(here, column, n) for column in values.reshape(-1, width).T]
    return np.stack(columns, axis=-1, dtype=float).reshape(n, *values.shape[1:])


def corner_weights(surface: Surface, kind: str, facets: Ids) -> tuple[Array, Array]:
    """Integration points (m, q, dim) of facets of one type, and the corners' functions there times area, (m, q, corners)."""
    xi, weights = gauss_rule(kind, ORDER)
    x, _, area = facet_measure(surface, kind, facets, xi)
    functions, _ = shape_functions(CELLS[pressure_kind(kind, 1)].code, np.ascontiguousarray(xi))
    return x, (area * weights)[..., None] * functions


def neighbours(surface: Surface) -> tuple[Ids, Ids]:
    """Pairs of corner points that share a facet, each in both orders."""
    pairs = []
    for kind, facets in by_kind(surface):
        corners = surface.nodes[facets, : CELLS[kind].corners].astype(np.int64)
        for shift in range(1, CELLS[kind].corners):
            pairs.append(np.stack([corners, np.roll(corners, shift, axis=1)], axis=-1).reshape(-1, 2))
    one, other = np.unique(np.concatenate(pairs), axis=0).T
    return one, other


def of_second_order(surface: Surface, exact: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Points (n_points,) that no facet of first order belongs to, but for those that are ``exact``, (n_facets,)."""
    result = np.ones(len(surface.points), dtype=bool)
    for kind, facets in by_kind(surface):
        if CELLS[kind].degree == 1:
            result[surface.nodes[facets[~exact[facets]], : CELLS[kind].corners]] = False
    return result


def tangents(normals: Array) -> Array:
    """Orthonormal tangents (n, dim - 1, dim) to unit normals (n, dim)."""
    if normals.shape[1] == 2:
        return np.stack([normals[:, 1], -normals[:, 0]], axis=1)[:, None]
    axis = np.eye(3)[np.argmin(np.abs(normals), axis=1)]
    first = np.cross(normals, axis)
    first /= np.maximum(np.linalg.norm(first, axis=1, keepdims=True), 1e-300)
    return np.stack([first, np.cross(normals, first)], axis=1)


@dataclass(frozen=True)
class StarFits:
    """Fits at some points i of a surface, by least squares over their neighbours and the mirror images of these.

    points: (m,) which; here: (r,) of which of them each row is; other: (r,) its neighbour; of_averages, of_values:
    (r, c) what a unit of each coefficient adds to the difference of averages, or values, between neighbour and point;
    scale: (m,) length of a star; frame: (m, dim - 1, dim) tangents; mean: (m, dim), square: (m, dim, dim) moments of the
    point's own function as in ``Supports``, continued beyond planes of symmetry."""

    points: Ids
    here: Ids
    other: Ids
    of_averages: Array
    of_values: Array
    scale: Array
    frame: Array
    mean: Array
    square: Array

    def to_averages(self, average: Array) -> Polynomials:
        """k-exact (Barth and Frederickson 1990): the average of each polynomial over the point's own function is the given
        one, those over the neighbours' functions as near as can be. average: (n_points,)."""
        found = self._solved(self.of_averages, self._from_averages, average)
        away = (found.gradient * self.mean).sum(axis=1)
        bent = 0.5 * (found.curvature * self.square).sum(axis=(1, 2))
        return Polynomials(average[self.points] - away - bent, found.gradient, found.curvature)

    def to_values(self, value: Array) -> Polynomials:
        """Through the values (n_points,) at the points and near those at the neighbours."""
        return self._solved(self.of_values, self._from_values, value)

    @cached_property
    def _from_averages(self) -> Array:
        return self._inverse(self.of_averages)

    @cached_property
    def _from_values(self) -> Array:
        return self._inverse(self.of_values)

    def _inverse(self, rows: Array) -> Array:
        """Of the normal equations, (m, c, c)."""
        metric = self._weights(rows)[:, None, None] * rows[:, :, None] * rows[:, None]
        return np.asarray(np.linalg.pinv(summed(self.here, metric, len(self.points)), rcond=FLAT, hermitian=True))

    def _weights(self, rows: Array) -> Array:
        """The inverse square of the distance, over the scale, (r,)."""
        return np.asarray(1.0 / np.maximum((rows[:, : self.frame.shape[1]] ** 2).sum(axis=1), 1e-300))

    def _solved(self, rows: Array, inverse: Array, value: Array) -> Polynomials:
        m, k = len(self.points), self.frame.shape[1]
        rise = value[self.other] - value[self.points[self.here]]
        rate = summed(self.here, (self._weights(rows) * rise)[:, None] * rows, m)
        found = np.einsum("mab,mb->ma", inverse, rate)
        slope, bend = found[:, :k] / self.scale[:, None], np.zeros((m, k, k))
        bend[(slice(None), *np.triu_indices(k))] = found[:, k:] / self.scale[:, None] ** 2
        bend = bend + np.triu(bend, 1).transpose(0, 2, 1)
        return Polynomials(
            value[self.points],
            np.einsum("mk,mkd->md", slope, self.frame),
            np.einsum("mka,mkl,mlb->mab", self.frame, bend, self.frame),
        )


def star_fits(surface: Surface, points: Ids, normals: Array, across: Array, of: Supports) -> StarFits:
    """points: (m,) at which to fit; normals: (n_points, dim) of the surface; across: (n_points, 2, dim) unit normals of
    planes of symmetry through points, zero where there are none: beyond them neighbours are mirror images."""
    number = np.full(len(surface.points), -1)
    number[points] = np.arange(len(points))
    one, other = neighbours(surface)
    one, other = one[number[one] >= 0], other[number[one] >= 0]
    mirrors, there = _mirrors(across[points])
    same = np.abs(np.einsum("rka,rla->rkl", across[one], across[other])).max(axis=2) > 0.5
    twice = np.stack([np.zeros(len(one), dtype=bool), same[:, 0], same[:, 1], same.any(axis=1)], axis=1)
    row, which = np.nonzero(there[number[one]] & ~twice)  # what lies on a plane is its own image
    at, beside = number[one[row]], other[row]
    frame = tangents(normals[points])
    along = np.einsum("rka,rab->rkb", frame[at], mirrors[at, which])
    step = surface.points[beside] - surface.points[points[at]]
    away, mean = (np.einsum("rka,ra->rk", along, v) for v in (step, step + of.mean[beside]))
    central = of.square[beside] - of.mean[beside][:, :, None] * of.mean[beside][:, None]
    square = np.einsum("rka,rab,rlb->rkl", along, central, along) + mean[:, :, None] * mean[:, None]
    own_mean, own_square = own_support(frame, mirrors, there, points, of)
    count = np.bincount(at, minlength=len(points))
    scale = np.sqrt(np.bincount(at, (away**2).sum(axis=1), len(points)) / np.maximum(count, 1))
    scale = np.where(scale > 0.0, scale, 1.0)
    of_averages = _row(mean - own_mean[at], square - own_square[at], scale[at])
    of_values = _row(away, away[:, :, None] * away[:, None], scale[at])
    own = np.einsum("mk,mkd->md", own_mean, frame), np.einsum("mka,mkl,mlb->mab", frame, own_square, frame)
    return StarFits(points, at, beside, of_averages, of_values, scale, frame, *own)


def own_support(
    frame: Array, mirrors: Array, there: NDArray[np.bool_], points: Ids, of: Supports
) -> tuple[Array, Array]:
    """Moments (m, k), (m, k, k) of the points' own functions along the tangents, continued beyond planes of symmetry."""
    share = there / there.sum(axis=1, keepdims=True)
    along = np.einsum("mka,mgab->mgkb", frame, mirrors)
    mean = np.einsum("mg,mgka,ma->mk", share, along, of.mean[points])
    return mean, np.einsum("mg,mgka,mab,mglb->mkl", share, along, of.square[points], along, optimize=True)


def _mirrors(across: Array) -> tuple[Array, NDArray[np.bool_]]:
    """The identity and reflections across a point's planes, first, second, both: (m, 4, dim, dim); which exist, (m, 4)."""
    one, two = (np.eye(across.shape[2]) - 2.0 * n[:, :, None] * n[:, None] for n in np.moveaxis(across, 1, 0))
    first, second = (n.any(axis=1) for n in np.moveaxis(across, 1, 0))
    every = np.ones(len(across), dtype=bool)
    same = np.broadcast_to(np.eye(across.shape[2]), one.shape)
    return np.stack([same, one, two, one @ two], axis=1), np.stack([every, first, second, first & second], axis=1)


def _row(mean: Array, square: Array, scale: Array) -> Array:
    """What a unit of each coefficient adds: slopes, then the upper triangle of second derivatives, both by ``scale``."""
    a, b = np.triu_indices(mean.shape[1])
    bent = np.where(a == b, 0.5, 1.0) * square[:, a, b]
    return np.concatenate([mean / scale[:, None], bent / scale[:, None] ** 2], axis=1)
