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
from abut.contact.tangential import turned
from abut.mesh.surface import Surface
from abut.types import Sparse

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Frames:
    """Where the n functions of a space sit on a contactor in 3D, and what their first tangent follows.

    facet, local: (n,) a facet and the number of its node; slopes: (n, 9) what makes of the positions of that facet's nodes a
    direction that goes with the surface, along the first tangent at the outset; handed: (n,) sign of the second."""

    facet: NDArray[np.int64]
    local: NDArray[np.int64]
    slopes: Array
    handed: Array

    @classmethod
    def of(cls, contactor: Surface, space: PressureSpace, tangents: Array) -> Frames:
        """tangents: (n, 2, 3) at the outset."""
        facet, local = anchors(contactor, space)
        both = np.zeros((len(facet), MAX_FACET_NODES, 2))
        for kind, facets in by_kind(contactor):
            here = np.flatnonzero(np.isin(facet, facets))
            _, slopes = shape_functions(CELLS[kind].code, np.ascontiguousarray(node_coordinates(kind)))
            both[here, : CELLS[kind].nodes] = slopes[local[here]]
        x = contactor.points[np.maximum(contactor.nodes[facet], 0)]
        along = np.einsum("nja,njd->nad", both, x)
        gram = np.einsum("nad,nbd->nab", along, along)
        share = np.linalg.solve(gram, np.einsum("nad,nd->na", along, tangents[:, 0])[..., None])[..., 0]
        normal = np.cross(along[:, 0], along[:, 1])
        handed = -np.sign(np.einsum("nd,nd->n", np.cross(normal, tangents[:, 0]), tangents[:, 1]))
        return cls(facet, local, np.einsum("nja,na->nj", both, share), handed)

    def at(self, contactor: Surface, across: Smoothing) -> tuple[Array, tuple[Sparse, Sparse]]:
        """Tangents (n, 2, 3) square to each other and to the normal now, theory (G5), and their derivatives, (3 n, 3
        n_points) each."""
        x, n = contactor.points, len(self.facet)
        nodes = np.maximum(contactor.nodes[self.facet], 0)
        normal = -nodal_normals(contactor, across)[self.facet, self.local]
        along = np.einsum("nj,njd->nd", self.slopes, x[nodes])
        row = np.repeat(np.arange(n), MAX_FACET_NODES)
        by_along = sp.kron(
            sp.csr_matrix((self.slopes.ravel(), (row, nodes.ravel())), shape=(n, len(x))), sp.identity(3), format="csr"
        )
        place = 3 * (MAX_FACET_NODES * self.facet + self.local)[:, None] + np.arange(3)
        by_normal = -normal_derivative(contactor, across)[place.ravel()]
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


def anchors(contactor: Surface, space: PressureSpace) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """A facet and the number of its node where each function of a continuous space sits, (n,) each."""
    split, _ = split_at_creases(contactor)
    facet, local = np.nonzero(split.nodes >= 0)
    node, first = np.unique(split.nodes[facet, local], return_index=True)
    at = first[np.searchsorted(node, space.side)]
    return facet[at], local[at]


def tangents_2d(contactor: Surface, across: Smoothing, facet: NDArray[np.int64], local: NDArray[np.int64]) -> Array:
    """(n, 1, 2): the normal from target to contactor turned by a right angle."""
    return turned(-nodal_normals(contactor, across)[facet, local])[:, None]


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
