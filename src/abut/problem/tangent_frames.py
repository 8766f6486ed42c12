"""Tangents at the functions of a contactor that moves, with their derivatives by its points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.cells import CELLS, MAX_FACET_NODES
from abut.contact.block_rows import block_rows
from abut.contact.geometry import by_kind, node_coordinates, split_at_creases
from abut.contact.moving_normals import MovingNormals, crossing
from abut.contact.pressure_space import PressureSpace
from abut.contact.tangential import turned
from abut.mesh.surface import Surface
from abut.types import Sparse

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Frames:
    """Where the n functions of a space sit on a contactor in 3D, and what their tangents follow.

    facet, local: (n,) a facet and the number of its node; slopes: (n, 9, 2) what makes of the positions of that facet's
    nodes two directions that go with the surface, the tangents at the outset; handed: (n,) sign of the second."""

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
        share = np.linalg.solve(gram, np.einsum("nad,nbd->nab", along, tangents))
        normal = np.cross(along[:, 0], along[:, 1])
        handed = -np.sign(np.einsum("nd,nd->n", np.cross(normal, tangents[:, 0]), tangents[:, 1]))
        return cls(facet, local, both @ share, handed)

    def at(self, contactor: Surface, normals: MovingNormals) -> FramesNow:
        """Tangents square to each other and to the normal now, theory (G5)."""
        x, nodes = contactor.points, np.maximum(contactor.nodes[self.facet], 0)
        normal, sign = -normals.values[self.facet, self.local], self.handed[:, None, None]
        along, aside = np.einsum("nja,njd->and", self.slopes, x[nodes])
        up = np.einsum("nd,nd->n", normal, along)
        flat = along - up[:, None] * normal + self.handed[:, None] * np.cross(aside, normal)
        length = np.linalg.norm(flat, axis=1)[:, None, None]
        first = flat / length[:, 0]
        square = (np.eye(3) - first[:, :, None] * first[:, None]) / length
        level = np.eye(3) - normal[:, :, None] * normal[:, None]
        turn = up[:, None, None] * np.eye(3) + normal[:, :, None] * along[:, None]
        by_along = square @ np.concatenate([level, -sign * crossing(normal)], axis=2)
        by_outward = square @ (turn - sign * crossing(aside))
        second = self.handed[:, None] * np.cross(normal, first)
        by_first, by_normal = sign * crossing(normal), sign * crossing(first)
        return FramesNow(
            np.stack([first, second], axis=1),
            np.stack([by_along, by_first @ by_along], axis=1),
            np.stack([by_outward, by_first @ by_outward + by_normal], axis=1),
            normals.numbers[self.facet, self.local],
        )

    def spread(self, contactor: Surface, values: Array) -> Sparse:
        """What blocks (n, r, 6) of derivatives by the two directions are by the points, (r n, 3 n_points)."""
        used = (contactor.nodes[self.facet] >= 0) & (self.slopes != 0.0).any(axis=2)
        row, local = np.nonzero(used)
        node = contactor.nodes[self.facet][row, local]
        order = np.lexsort((node, row))
        row, local, node = row[order], local[order], node[order]
        start = np.searchsorted(row, np.arange(len(values) + 1))
        by_node = np.einsum("ma,mrad->mrd", self.slopes[row, local], values.reshape(len(values), -1, 2, 3)[row])
        return block_rows((by_node, node, start), len(contactor.points))


@dataclass(frozen=True)
class FramesNow:
    """Tangents (n, 2, 3), and their derivatives by the two directions that they follow, (n, 2, 3, 6), ``Frames.spread``, and
    by the nodal normal, out of the contactor, of number ``number`` (n,), (n, 2, 3, 3)."""

    tangents: Array
    by_along: Array
    by_normal: Array
    number: NDArray[np.int32]


def anchors(contactor: Surface, space: PressureSpace) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """A facet and the number of its node where each function sits, (n,) each; of a facet alone, where it is largest."""
    split, _ = split_at_creases(contactor)
    facet, local = np.nonzero(split.nodes >= 0)
    node, first = np.unique(split.nodes[facet, local], return_index=True)
    at = first[np.searchsorted(node, np.maximum(space.side, node[0]))]
    largest = np.asarray(sp.csc_matrix(abs(space.plain)).argmax(axis=0)).ravel()
    alone = space.node < 0
    facet, local = facet[at], local[at]
    return np.where(alone, largest // MAX_FACET_NODES, facet), np.where(alone, largest % MAX_FACET_NODES, local)


def tangents_2d(normals: MovingNormals, facet: NDArray[np.int64], local: NDArray[np.int64]) -> Array:
    """(n, 1, 2): the normal from target to contactor turned by a right angle."""
    return turned(-normals.values[facet, local])[:, None]
