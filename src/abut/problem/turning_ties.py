"""Ties across a gap at large displacements: what lies between the surfaces turns with the contactor, theory (G19)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.cells import MAX_FACET_NODES
from abut.contact.coupling import CouplingOptions
from abut.contact.moving_normals import MovingNormals, NormalPattern, normal_pattern
from abut.contact.slip_points import SlipPoints
from abut.mesh.surface import Surface
from abut.problem.frame import PairFrame
from abut.problem.kinematics import ContactNow, Placed
from abut.problem.pair import Pair
from abut.problem.reference import Reference
from abut.types import Sparse

CLOSED = 1e-9  # gap over the facet size from which down a tie is as good as closed
Array = NDArray[np.float64]


@dataclass(frozen=True)
class TurningTie(Reference):
    """Of a tie across a gap: it holds surfaces together as they were at the outset. pattern: of the
    contactor's m nodal normals; across: (n, dim m), weighted gaps along them; at_rest: (dim m,) normals at the outset."""

    pattern: NormalPattern
    across: Sparse
    at_rest: Array

    def at(self, frame: PairFrame, now: Placed, before: Array) -> ContactNow:
        """Gaps, slips and forces at a state, as in ``Kinematics``: jumps less what turns with the contactor."""
        pair, found = self.pair, super().at(frame, now, before)
        normals = self.pattern.at(_moved(pair.contactor, now.displacement))
        rows = (pair.rows - self.across @ normals.turning(len(pair.contactor.points))).tocsr()
        gap = found.gap - self.across @ (_each(self.pattern, normals) - self.at_rest)
        return replace(found, pair=replace(pair, rows=rows), gap=gap, by_position=rows)


def current_tie(pair: Pair, reach: float) -> Reference:
    """Of a tie where bodies are: it turns where there are gaps between its surfaces at the outset. reach: a length."""
    contactor, target, rule = pair.contactor, pair.target, pair.contact.integration
    options = CouplingOptions(rule.rule, rule.points, reach)
    across = None if pair.moving is None else pair.moving.contactor
    points = SlipPoints.of(contactor, target, pair.coupling.degree, options, across)
    apart = _positions(contactor, points.facet, points.own) - _positions(target, points.target_facet, points.other)
    if not len(apart) or np.linalg.norm(apart, axis=1).max() <= CLOSED * pair.size:
        return Reference(pair)
    pattern = normal_pattern(contactor, across)
    normals = pattern.at(contactor)
    mean = np.einsum("qi,qid->qd", points.own, normals.values[points.facet])
    length = np.einsum("qd,qd->q", apart, mean) / np.einsum("qd,qd->q", mean, mean)
    along = _along(points, length, normals.numbers[points.facet], len(contactor), len(normals.blocks[2]) - 1)
    dim = contactor.dim
    axes = [sp.kron(part.transfer.T @ along, np.eye(dim)[[a]]) for a, part in enumerate(pair.components)]
    return TurningTie(pair, pattern, sp.vstack(axes).tocsr(), _each(pattern, normals))


def _along(points: SlipPoints, length: Array, numbers: NDArray[np.int32], facets: int, m: int) -> Sparse:
    """int H_k l N_i da, (9 n_facets, m), l (n_points,) being a length at each point and N_i the functions of the nodes that
    normals belong to, by number (n_points, 9)."""
    value = (points.weight * length)[:, None, None] * points.pressure[:, :, None] * points.own[:, None, :]
    row = MAX_FACET_NODES * points.facet[:, None, None].astype(np.int64) + np.arange(MAX_FACET_NODES)[:, None]
    column = numbers[:, None, :]
    there = (value != 0.0) & (column >= 0)
    row, column = np.broadcast_to(row, value.shape)[there], np.broadcast_to(column, value.shape)[there]
    return sp.csr_matrix((value[there], (row, column)), shape=(MAX_FACET_NODES * facets, m))


def _each(pattern: NormalPattern, normals: MovingNormals) -> Array:
    """The normals that differ, (dim m,)."""
    used = pattern.numbers >= 0
    result = np.zeros((pattern.sums.shape[0], normals.values.shape[2]))
    result[pattern.numbers[used]] = normals.values[used]
    return result.ravel()


def _moved(surface: Surface, displacement: Array) -> Surface:
    return replace(surface, points=surface.points + displacement.reshape(-1, surface.dim))


def _positions(surface: Surface, facet: NDArray[np.int32], shapes: Array) -> Array:
    """Of points on facets, (n, dim)."""
    return np.asarray(np.einsum("qi,qid->qd", shapes, surface.points[np.maximum(surface.nodes[facet], 0)]))
