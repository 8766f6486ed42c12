"""Pressures that are continuous within a body, one at each corner of its cells: theory (E8), (E9), (E10), (E11), (D25).

Mixed tet10 cells. What of the material the change of volume alone decides acts on its mean about each corner, weighted by
the linear function of that corner; the pressure is linear between corners. The mass matrix of the pressures is lumped, so
that each follows from the displacements of all cells about its corner; the stiffness has them as a border.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut._core import Cells, finite_strains, integrate_given_finite, shape_functions
from abut.bordered import Bordered
from abut.cells import CELLS
from abut.materials.evaluated import Array
from abut.materials.volume_split import VolumeLaw
from abut.mesh.integrals import CHUNK, gradients
from abut.mesh.quadrature import Rule, gauss_rule
from abut.types import Sparse

KIND, CORNERS = "tet10", 4
Ints = NDArray[np.integer[Any]]
Pattern = tuple[Ints, Ints]  # CSR (indptr, indices)


@dataclass(frozen=True)
class Turned:
    """Row of a cell among those of the pressures, and the determinant of its deformation gradient, which is not positive."""

    row: int
    determinant: float


@dataclass(frozen=True)
class Volumes:
    """Means about the corners. growth: (n_corners,) of the change of volume; rows: (n_corners, dim n_points) BSR, their
    derivative by displacements."""

    growth: Array
    rows: Sparse


@dataclass(frozen=True)
class CornerPressures:
    """points: (n_points, 3) of the mesh; nodes: (n, 10) of the cells; cells: (n,) their numbers in the mesh; corner: (n, 4)
    numbers of their corners among all that have a pressure; laws: by body, and number of each corner's body (n_corners,)."""

    points: Array
    nodes: NDArray[np.int32]
    cells: NDArray[np.int64]
    corner: NDArray[np.int64]
    laws: Sequence[VolumeLaw]
    body: NDArray[np.int64]

    @property
    def count(self) -> int:
        """How many corners have a pressure."""
        return len(self.body)

    @cached_property
    def shares(self) -> Array:
        """Volume of each cell by corner, (n, 4)."""
        return np.asarray(self.point_volumes @ linear_functions(self.rule[0]))

    @cached_property
    def point_volumes(self) -> Array:
        """What each point of the rule stands for, (n, q)."""
        return np.concatenate([volume for _, _, volume in self._pieces()])

    @cached_property
    def volume(self) -> Array:
        """About each corner, (n_corners,)."""
        return self._added(self.shares)

    @property
    def rule(self) -> Rule:
        """Exact for a constant pressure on curved cells, too."""
        return gauss_rule(KIND, 2)

    @cached_property
    def at_rest(self) -> Volumes:
        """Of small strains: what displacements add to no change of volume."""
        linear, values = linear_functions(self.rule[0]), []
        for _, slopes, volume in self._pieces():
            values.append(np.einsum("cq,qv,cqna->cvna", volume, linear, slopes, optimize=True))
        return Volumes(np.zeros(self.count), self._rows(np.concatenate(values)))

    def at(self, displacement: Array) -> Volumes | Turned:
        """Of finite strains, under displacements (n_points, 3)."""
        linear, values, growth, done = linear_functions(self.rule[0]), [], [], 0
        for nodes, slopes, volume in self._pieces():
            slope = np.einsum("cna,cqnb->cqab", displacement[nodes], slopes, optimize=True)
            turned, grown = _cofactors(slope)
            if not (1.0 + grown > 0.0).all():
                row = int(np.flatnonzero(~(1.0 + grown > 0.0).all(axis=1))[0])
                return Turned(done + row, float(1.0 + grown[row].min()))
            pushed = np.matmul(slopes, np.swapaxes(turned, -1, -2))
            values.append(np.einsum("cq,qv,cqna->cvna", volume, linear, pushed, optimize=True))
            growth.append((volume * grown) @ linear)
            done += len(nodes)
        return Volumes(self._added(np.concatenate(growth)) / self.volume, self._rows(np.concatenate(values)))

    def by_corner(self, thermal: Array) -> Array:
        """Thermal strains of the cells at their nodes (n, 10) as the pressures see them, (n_corners,)."""
        xi, _ = self.rule
        shapes, linear = shape_functions(CELLS[KIND].code, xi)[0], linear_functions(xi)
        return self._added((self.point_volumes * (thermal @ shapes.T)) @ linear) / self.volume

    def evaluate(self, growth: Array, swelling: Array | None, finite: bool) -> tuple[Array, Array, Array]:
        """Energy per volume, pressure (the mean stress, > 0 in tension) and its slope at each corner, (n_corners,), at a
        change of volume growth, of which heat makes a part freely; swelling: thermal strains."""
        parts = [np.empty(self.count) for _ in range(3)]
        grown, stretch = growth, np.ones(self.count)
        if swelling is not None and not finite:
            grown = growth - 3.0 * swelling
        elif swelling is not None:
            stretch = (1.0 + swelling) ** 3
            grown = (growth - (stretch - 1.0)) / stretch
        for number, law in enumerate(self.laws):
            own = self.body == number
            for part, values in zip(parts, law.evaluate(grown[own])):
                part[own] = values
        return parts[0] * stretch, parts[1], parts[2] / stretch

    def stiffness(self, rows: Sparse, bend: Array, beside: Sparse | None = None) -> Bordered:
        """(dim n_points, dim n_points), the pressures kept as unknowns; bend: their slopes; beside: what is added."""
        rest = sp.csr_matrix((self.points.size,) * 2) if beside is None else beside
        return Bordered(rest, rows.tocsr(), self.volume * bend)

    def bending(self, displacement: Array, pressure: Array, pattern: Pattern, rows: Pattern) -> Sparse:
        """What pressures (n_corners,) add as volumes bend with displacements, (dim n_points, dim n_points) CSR; pattern: CSR
        (indptr, indices) of which nodes share a cell, rows: the same of displacements."""
        xi, weights = self.rule
        shapes, derivatives = shape_functions(CELLS[KIND].code, xi)
        linear = linear_functions(xi)
        dim = self.points.shape[1]
        values = np.zeros(len(pattern[1]) * dim**2)
        for first in range(0, len(self.nodes), CHUNK):
            part = slice(first, first + CHUNK)
            cells = Cells(self.points, self.nodes[part], shapes, derivatives, weights, False, False, 0)
            strain, _ = finite_strains(cells, displacement, None)
            stress, tangent = _hydrostatic(strain, (pressure[self.corner[part]] @ linear.T).ravel())
            integrate_given_finite(
                cells, displacement, None, strain, stress, tangent, False, None, (*pattern, values), None
            )
        indptr, indices = rows
        matrix = sp.csr_matrix((values, indices, indptr), shape=(self.points.size,) * 2)
        matrix.has_sorted_indices = True
        return matrix

    @cached_property
    def _pattern(self) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
        """Which nodes are about each corner, CSR, and where each corner and node of a cell is among them, (n 4 10,)."""
        key = (self.corner[:, :, None] * len(self.points) + self.nodes[:, None, :]).ravel()
        known, place = np.unique(key, return_inverse=True)
        counts = np.bincount(known // len(self.points), minlength=self.count)
        return np.concatenate([[0], np.cumsum(counts)]), known % len(self.points), place.ravel()

    def _rows(self, values: Array) -> Sparse:
        """BSR over the mean about each corner, of sums by cell, corner, node and direction (n, 4, 10, 3)."""
        indptr, indices, place = self._pattern
        dim = self.points.shape[1]
        columns = values.reshape(-1, dim).T
        sums = np.stack([np.bincount(place, column, len(indices)) for column in columns], axis=1)
        data = sums / np.repeat(self.volume, np.diff(indptr))[:, None]
        return sp.bsr_matrix((data[:, None, :], indices, indptr), shape=(self.count, self.points.size))

    def _added(self, by_cell: Array) -> Array:
        """At each corner, of values (n, 4)."""
        return np.asarray(np.bincount(self.corner.ravel(), by_cell.ravel(), self.count), dtype=float)

    def _pieces(self) -> Iterator[tuple[NDArray[np.int32], Array, Array]]:
        """Some cells after the other: nodes, gradients (n, q, 10, 3) of shape functions, volumes (n, q)."""
        xi, weights = self.rule
        _, derivatives = shape_functions(CELLS[KIND].code, xi)
        for first in range(0, len(self.nodes), CHUNK):
            nodes = self.nodes[first : first + CHUNK]
            slopes, det = gradients(self.points, nodes, derivatives)
            yield nodes, slopes, det * weights


def linear_functions(xi: Array) -> Array:
    """Of the corners at points of the reference cell (q, 3), (q, 4)."""
    return np.column_stack([1.0 - xi.sum(axis=1), xi])


def numbered(nodes: Ints, body: Ints) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Corners of cells with nodes (n, 10) numbered within each body (n,): (n, 4), and the body of each."""
    corner = nodes[:, :CORNERS].astype(np.int64)
    most = int(corner.max()) + 1
    known, place = np.unique(body[:, None] * most + corner, return_inverse=True)
    return place.reshape(corner.shape).astype(np.int64), (known // most).astype(np.int64)


def _cofactors(slope: Array) -> tuple[Array, Array]:
    """Of 1 + slope (..., 3, 3), and its determinant less 1, which keeps its digits where slopes are small."""
    f = slope + np.eye(3)
    cofactor = np.stack([np.cross(f[..., (a + 1) % 3, :], f[..., (a + 2) % 3, :]) for a in range(3)], axis=-2)
    trace = np.trace(slope, axis1=-2, axis2=-1)
    second = 0.5 * (trace**2 - np.einsum("...ab,...ba->...", slope, slope))
    third = (slope[..., 0, :] * np.cross(slope[..., 1, :], slope[..., 2, :])).sum(axis=-1)
    return cofactor, trace + second + third


def _hydrostatic(strain: Array, pressure: Array) -> tuple[Array, Array]:
    """Second stresses of Piola and Kirchhoff (n, 6) of Cauchy's mean stress alone, and their slope (n, 6, 6) by strains of
    Green and Lagrange (n, 6) as that stays."""
    c = np.empty((len(strain), 3, 3))
    for s, (a, b) in enumerate(_PLACES):
        c[:, a, b] = c[:, b, a] = strain[:, s] if s > 2 else 1.0 + 2.0 * strain[:, s]
    inverse = np.linalg.inv(c)
    size = pressure / np.sqrt(np.linalg.det(inverse))
    rows, columns = np.array(_PLACES).T
    flat = inverse[:, rows, columns]
    square = inverse[:, rows[:, None], rows] * inverse[:, columns[:, None], columns]
    square += inverse[:, rows[:, None], columns] * inverse[:, columns[:, None], rows]
    tangent = flat[:, :, None] * flat[:, None, :] - square
    return np.ascontiguousarray(size[:, None] * flat), np.ascontiguousarray(size[:, None, None] * tangent)


_PLACES = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))  # xx yy zz xy yz zx
