"""How far the fluid of pressure penetration has got into a contact: what is fixed of it in a step, and what belongs to
its end; theory (F19)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import spsolve
from scipy.spatial import cKDTree

from abut.cells import BY_CODE
from abut.contact.coupling import CouplingOptions
from abut.contact.geometry import facet_products
from abut.contact.slip_points import SlipPoints
from abut.mesh.surface import Surface
from abut.model import Model
from abut.model.penetration import Penetration, corners, source_nodes
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
            shares[:, 1] = _carried(pair, on_contactor, points)
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


def _carried(pair: Pair, shares: Array, points: Array) -> Array:
    """Shares (n_points,) on the target, linear between its corners, of those on the contactor, theory (F24): what acts on
    both sides is equal and opposite where they face each other. Beside that, those of the nearest point of the contactor."""
    contactor, target = replace(pair.contactor, points=points), replace(pair.target, points=points)
    rule, moving = pair.contact.integration, pair.moving
    across = (None, None) if moving is None else (moving.contactor, moving.target)
    options = CouplingOptions(rule.rule, rule.points, target_across=across[1])
    cut = SlipPoints.of(contactor, target, 1, options, across[0])
    of_contactor = at_corners(contactor, shares, not pair.space.ordinary)
    pushing = np.einsum("qk,qk->q", cut.pressure, of_contactor[cut.facet])
    between = _middles(target, len(points))
    own, ids, used = corners(target), target.node_ids, contactor.node_ids
    beside = np.zeros(len(points))
    beside[own] = shares[used[cKDTree(points[used]).query(points[own])[1]]]
    seen = (_at_points(target, cut) @ between).tocsr()
    lacks = seen.T @ (cut.weight * (pushing - seen @ beside))
    beside[own] += spsolve(_mass(target)[own][:, own].tocsc(), lacks[own])
    result = np.zeros(len(points))
    result[ids] = (between @ beside)[ids]
    return result


def _at_points(target: Surface, cut: SlipPoints) -> Sparse:
    """(n, n_points): values of the target's shape functions at the integration points."""
    nodes = target.nodes[cut.target_facet]
    there = nodes >= 0
    rows = np.broadcast_to(np.arange(len(nodes))[:, None], nodes.shape)[there]
    return sp.csr_matrix((cut.other[there], (rows, nodes[there])), shape=(len(nodes), len(target.points)))


def _mass(surface: Surface) -> Sparse:
    """(n_points, n_points): integrals of products of the functions of corners."""
    products, count = facet_products(surface, 1), len(surface.points)
    total = sp.csr_matrix((count, count))
    for code in np.unique(surface.kinds):
        n, here = BY_CODE[code].corners, surface.kinds == code
        nodes = surface.nodes[here, :n]
        at = np.repeat(nodes, n, axis=1).ravel(), np.tile(nodes, (1, n)).ravel()
        total = total + sp.csr_matrix((products[here, :n, :n].ravel(), at), shape=(count, count))
    return total


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
