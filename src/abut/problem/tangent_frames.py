"""Tangents at the functions of a contactor that moves, with their derivatives by its points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.cells import CELLS, MAX_FACET_NODES
from abut.contact.coupling_tangent import normal_derivative
from abut.contact.geometry import Smoothing, by_kind, nodal_normals, node_coordinates, split_at_creases
from abut.contact.pressure_space import PressureSpace
from abut.mesh.surface import Surface
from abut.types import Sparse

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Anchors:
    """Where the n functions of a space sit on a contactor.

    facet: (n,); shapes: (n, 9) shape functions of that facet there; slopes: (n, 9, dim - 1) their slopes."""

    facet: NDArray[np.int64]
    shapes: Array
    slopes: Array

    def normals(self, contactor: Surface, across: Smoothing) -> Array:
        """Unit normals (n, dim) from the target to the contactor."""
        total = -np.einsum("nj,njd->nd", self.shapes, nodal_normals(contactor, across)[self.facet])
        return np.asarray(total / np.linalg.norm(total, axis=1, keepdims=True))

    def normal_change(self, contactor: Surface, across: Smoothing) -> Sparse:
        """Derivative of ``normals`` in 3D, (3 n, 3 n_points)."""
        n = len(self.facet)
        total = -np.einsum("nj,njd->nd", self.shapes, nodal_normals(contactor, across)[self.facet])
        length = np.linalg.norm(total, axis=1)[:, None, None]
        normal = total / length[:, 0]
        level = (np.eye(3) - normal[:, :, None] * normal[:, None]) / length
        column = MAX_FACET_NODES * self.facet[:, None] + np.arange(MAX_FACET_NODES)
        where = np.repeat(np.arange(n), MAX_FACET_NODES), column.ravel()
        mean = sp.csr_matrix((self.shapes.ravel(), where), shape=(n, MAX_FACET_NODES * len(contactor)))
        by_nodal = sp.kron(mean, sp.identity(3), format="csr") @ normal_derivative(contactor, across)
        return (-_blocks(level) @ by_nodal).tocsr()


@dataclass(frozen=True)
class Frames:
    """The tangents of n functions in 3D. anchors: where they sit; slopes: (n, 9) what makes of the positions of the anchor
    facet's nodes a direction that goes with the surface, along the first tangent at the outset; handed: (n,) sign of the
    second."""

    anchors: Anchors
    slopes: Array
    handed: Array

    @classmethod
    def of(cls, contactor: Surface, at: Anchors, tangents: Array) -> Frames:
        """tangents: (n, 2, 3) at the outset."""
        x = contactor.points[np.maximum(contactor.nodes[at.facet], 0)]
        along = np.einsum("nja,njd->nad", at.slopes, x)
        gram = np.einsum("nad,nbd->nab", along, along)
        share = np.linalg.solve(gram, np.einsum("nad,nd->na", along, tangents[:, 0])[..., None])[..., 0]
        normal = np.cross(along[:, 0], along[:, 1])
        handed = -np.sign(np.einsum("nd,nd->n", np.cross(normal, tangents[:, 0]), tangents[:, 1]))
        return cls(at, np.einsum("nja,na->nj", at.slopes, share), handed)

    def at(self, contactor: Surface, across: Smoothing) -> tuple[Array, tuple[Sparse, Sparse]]:
        """Tangents (n, 2, 3) square to each other and to the normal now, theory (G5), and their derivatives, (3 n, 3
        n_points) each."""
        x, n = contactor.points, len(self.handed)
        nodes = np.maximum(contactor.nodes[self.anchors.facet], 0)
        normal = self.anchors.normals(contactor, across)
        along = np.einsum("nj,njd->nd", self.slopes, x[nodes])
        row = np.repeat(np.arange(n), MAX_FACET_NODES)
        by_along = sp.kron(
            sp.csr_matrix((self.slopes.ravel(), (row, nodes.ravel())), shape=(n, len(x))), sp.identity(3), format="csr"
        )
        by_normal = self.anchors.normal_change(contactor, across)
        up = np.einsum("nd,nd->n", normal, along)
        flat = along - up[:, None] * normal
        length = np.linalg.norm(flat, axis=1)[:, None, None]
        first = flat / length[:, 0]
        square = (np.eye(3) - first[:, :, None] * first[:, None]) / length
        level = np.eye(3) - normal[:, :, None] * normal[:, None]
        turn = up[:, None, None] * np.eye(3) + normal[:, :, None] * along[:, None]
        by_first = _blocks(square @ level) @ by_along - _blocks(square @ turn) @ by_normal
        second = self.handed[:, None] * np.cross(normal, first)
        sign = self.handed[:, None, None]
        by_second = _blocks(sign * _crossing(normal)) @ by_first - _blocks(sign * _crossing(first)) @ by_normal
        return np.stack([first, second], axis=1), (by_first.tocsr(), by_second.tocsr())


def anchors(contactor: Surface, space: PressureSpace) -> Anchors:
    """Functions of points sit there, on any facet of their side of a crease; those of a facet alone at the mean of the nodes
    at which they are not zero, weighted by their values there."""
    split, _ = split_at_creases(contactor)
    facets, locals_ = np.nonzero(split.nodes >= 0)
    node, first = np.unique(split.nodes[facets, locals_], return_index=True)
    of_points = space.node >= 0
    at = first[np.searchsorted(node, space.side[of_points])]
    facet, share = np.zeros(len(space), dtype=np.int64), np.zeros((len(space), MAX_FACET_NODES))
    facet[of_points], share[of_points, locals_[at]] = facets[at], 1.0
    alone = np.flatnonzero(~of_points)
    entries = abs(space.plain.tocsc()[:, alone]).tocoo()
    facet[alone[entries.col]] = entries.row // MAX_FACET_NODES
    share[alone[entries.col], entries.row % MAX_FACET_NODES] = entries.data
    share /= share.sum(axis=1, keepdims=True)
    shapes, slopes = np.zeros_like(share), np.zeros((*share.shape, contactor.dim - 1))
    for kind, of_kind in by_kind(contactor):
        here, n = np.flatnonzero(np.isin(facet, of_kind)), CELLS[kind].nodes
        place = share[here, :n] @ node_coordinates(kind)
        shapes[here, :n], slopes[here, :n] = shape_functions(CELLS[kind].code, np.ascontiguousarray(place))
    return Anchors(facet, shapes, slopes)


def _blocks(values: Array) -> Sparse:
    """(3 n, 3 n) from blocks (n, 3, 3) on the diagonal."""
    n = np.arange(len(values) + 1)
    return sp.bsr_matrix((np.ascontiguousarray(values), n[:-1], n), shape=(3 * len(values),) * 2).tocsr()


def _crossing(v: Array) -> Array:
    """The matrices (n, 3, 3) of w -> v x w."""
    result = np.zeros((*v.shape, 3))
    for a, b, c in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        result[:, a, c], result[:, c, a] = v[:, b], -v[:, b]
    return result
