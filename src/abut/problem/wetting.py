"""How far the fluid of pressure penetration has got into a contact: what is fixed of it in a step, and what belongs to
its end; theory (F19)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from abut.cells import BY_CODE
from abut.mesh.surface import Surface
from abut.model import Model
from abut.model.penetration import Penetration, corners, source_nodes
from abut.probing.closest_points import feet
from abut.problem.pair import Pair
from abut.problem.wet import Wet
from abut.types import Array, Sparse

TERM = "penetrations"  # name of the term, and of its history
SAME = 1e-9  # of the fluid's pressure, by which contact may fall short of it


@dataclass(frozen=True)
class Wetting:
    """A penetration in a problem. source: points from which it comes; links: (n_points, n_points) corners of one facet;
    pair: number of its contact's; middles: (n_points, n_points) mean of corners for points between them, one for corners
    themselves."""

    penetration: Penetration
    pair: int
    source: NDArray[np.int64]
    links: Sparse
    middles: Sparse

    @classmethod
    def of(cls, model: Model, penetration: Penetration, pairs: Sequence[Pair]) -> Wetting:
        """Raises InputError where the source touches neither side."""
        number = next(k for k, pair in enumerate(pairs) if pair.contact.name == penetration.contact)
        both = pairs[number].contactor, pairs[number].target
        surface, count = both[0], len(model.mesh.points)
        return cls(
            penetration, number, source_nodes(model.mesh, penetration, both), _links(surface, count),
            _middles(surface, count),
        )  # fmt: skip

    def reached(
        self, pair: Pair, was: Wet, multipliers: Array, closed: NDArray[np.bool_], time: float
    ) -> NDArray[np.bool_]:
        """(n_points,) corners of the contactor that the fluid reaches from its source, through what is open, or pressed by
        less than its own pressure; ``was``: how far it has got where multipliers and status are these, of all the pair's."""
        pressure = self.penetration.pressure(time)
        if pressure <= 0.0:
            return np.zeros_like(was.nodes)
        nodes, size, touching = pair.space.node, len(was.nodes), closed[pair.normal]
        most = np.full(size, -np.inf)
        np.maximum.at(most, nodes, np.where(touching, multipliers[pair.normal], 0.0))
        shut = np.zeros(size, dtype=bool)
        shut[nodes[touching]] = True
        total = most + pressure * was.nodes
        enters = ~shut | (total < pressure * (1.0 - SAME)) | (was.nodes & was.left)
        some = np.zeros(size, dtype=bool)
        some[corners(pair.contactor)] = True
        enters &= some
        graph = sp.diags(enters.astype(float)) @ self.links @ sp.diags(enters.astype(float))
        _, label = connected_components(graph, directed=False)
        begins = self.source[enters[self.source]]
        return enters & np.isin(label, label[begins])

    def at(self, pair: Pair, nodes: NDArray[np.bool_], left: NDArray[np.bool_], points: Array) -> Wet:
        """What acts where the fluid reaches corners of the contactor; points: (n_points, dim) where they are."""
        on_contactor = self.middles @ nodes.astype(float)
        shares = np.column_stack([on_contactor, np.zeros(len(nodes))])
        if nodes.any():
            contactor, others = replace(pair.contactor, points=points), pair.target.node_ids
            found = feet(contactor, points[others])
            ids = contactor.node_ids
            values = on_contactor[ids[cKDTree(points[ids]).query(points[others])[1]]]  # beside the contactor
            seen, first = np.unique(found.point, return_index=True)
            on_facets = np.where(contactor.nodes >= 0, on_contactor[np.maximum(contactor.nodes, 0)], 0.0)
            values[seen] = np.einsum("kn,kn->k", found.weights[first], on_facets[found.facet[first]])
            shares[others, 1] = np.clip(values, 0.0, 1.0)
        return Wet(nodes, left, shares)


def settled(
    wetting: Wetting, pair: Pair, was: Wet, multipliers: Array, closed: NDArray[np.bool_], time: float, points: Array
) -> Wet:
    """How far the fluid gets at the end of a step that was solved with ``was``; the same object where that is as far."""
    nodes = wetting.reached(pair, was, multipliers, closed, time)
    if np.array_equal(nodes, was.nodes):
        return was
    return wetting.at(pair, nodes, was.left | (was.nodes & ~nodes), points)


def at_corners(surface: Surface, nodal: Array, dual: bool = False) -> Array:
    """Values (n_facets, 9) at the corners of facets of what is ``nodal`` (n_points,), linear between; dual: by the functions
    that are dual to those of the corners, which push at the corner alone that each belongs to, as dual pressures do."""
    result = np.zeros(surface.nodes.shape)
    for code in np.unique(surface.kinds):
        count, here = BY_CODE[code].corners, surface.kinds == code
        values = nodal[surface.nodes[here, :count]]
        result[here, :count] = values @ _dual(count) if dual else values
    return result


def _dual(count: int) -> Array:
    """(count, count) corner values of the dual functions of an edge, triangle or quadrilateral, a row for each."""
    line = np.array([[2.0, -1.0], [-1.0, 2.0]])
    if count == 2:
        return line
    if count == 3:
        return 4.0 * np.eye(3) - 1.0
    around = [0, 1, 3, 2]  # corners go round, products of two edges row by row
    return np.kron(line, line)[np.ix_(around, around)]


def _links(surface: Surface, count: int) -> Sparse:
    """(count, count) ones between corners of one facet."""
    rows, columns = [], []
    for code in np.unique(surface.kinds):
        n = BY_CODE[code].corners
        nodes = surface.nodes[surface.kinds == code, :n]
        rows.append(np.repeat(nodes, n, axis=1).ravel())
        columns.append(np.tile(nodes, (1, n)).ravel())
    at = np.concatenate(rows), np.concatenate(columns)
    return sp.csr_matrix((np.ones(len(at[0])), at), shape=(count, count))


def _middles(surface: Surface, count: int) -> Sparse:
    """(count, count): of each point of the surface the corners whose mean it is."""
    at_corners = corners(surface)
    rows: list[Array] = [at_corners]
    columns: list[Array] = [at_corners]
    for code in np.unique(surface.kinds):
        cell = BY_CODE[code]
        nodes = surface.nodes[surface.kinds == code, : cell.nodes]
        for middle in range(cell.corners, cell.nodes):
            of = _between(cell.corners, middle)
            rows.append(np.repeat(nodes[:, middle], len(of)))
            columns.append(nodes[:, of].ravel())
    at = np.concatenate(rows), np.concatenate(columns)
    ones = sp.csr_matrix((np.ones(len(at[0])), at), shape=(count, count))
    ones.data[:] = 1.0
    total = np.asarray(ones.sum(axis=1)).ravel()
    return sp.diags(1.0 / np.maximum(total, 1.0)) @ ones


def _between(count: int, middle: int) -> list[int]:
    """Corners around a point between them: both ends of an edge; of the middle of a facet all."""
    edges = 1 if count == 2 else count
    if middle >= count + edges:
        return list(range(count))
    if count == 2:
        return [0, 1]
    edge = middle - count
    return [edge, (edge + 1) % count]
