"""Whether the reported pressure alternates from node to node: the certificate's line "oscillation"."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.cells import CELLS, MAX_FACET_NODES
from abut.contact.geometry import by_kind, split_at_creases
from abut.contact.pressure_space import DUAL, DUAL_P1
from abut.mesh.surface import Surface
from abut.problem.pair import WHOLE, Pair

CLOSED = 1e-3  # pressure over the largest from which on a node counts as in contact


def oscillation(
    pair: Pair, values: NDArray[np.float64], pressure: NDArray[np.float64], share: NDArray[np.float64], largest: float
) -> float:
    """Largest alternating part of the pressure inside the contact over the largest pressure, theory (P11).

    values: (9 n_facets,) facet-wise coefficients of the multiplier; pressure: (n_points,) as reported; share: (n_points,)
    covered share of each point's support; largest: of the pressure.
    Of discontinuous spaces, whose average may hide what alternates, also that of the facets' means and jumps."""
    surface, _ = split_at_creases(pair.contactor)
    nodes = Graph.of_nodes(surface)
    inside = _inside(nodes, pressure > CLOSED * largest)
    if pair.space.continuous and pair.space.name not in (DUAL, DUAL_P1):  # of those coefficients are reported
        inside &= _inside(nodes, _inside(nodes, _carrying(nodes, surface, values, largest)))
    worst = _alternating(nodes, pressure, inside, excluded(nodes, share), largest)
    if not pair.space.continuous:
        facets = Graph.of_facets(surface)
        total = pair.coupling.weight.reshape(-1, MAX_FACET_NODES).sum(axis=1)
        load = (pair.coupling.weight * values).reshape(-1, MAX_FACET_NODES).sum(axis=1)
        mean = np.where(total > 0.0, load / np.where(total > 0.0, total, 1.0), 0.0)
        worst = max(
            worst,
            _alternating(facets, mean, _inside(facets, mean > CLOSED * largest), total <= 0.0, largest),
            _jumps(pair, surface, values, pressure, largest),
        )
    return worst


class Graph:
    """Who neighbours whom. matrix: (n, n) symmetric, ones; degree: (n,) number of neighbours; rim: (n,) on the surface's
    border."""

    def __init__(self, ends: NDArray[np.int64], n: int, rim: NDArray[np.bool_]) -> None:
        i, j = np.r_[ends[:, 0], ends[:, 1]], np.r_[ends[:, 1], ends[:, 0]]
        matrix = sp.csr_matrix((np.ones(len(i)), (i, j)), shape=(n, n))
        matrix.data[:] = 1.0
        self.matrix, self.rim = matrix, rim
        self.degree = np.asarray(matrix.sum(axis=1)).ravel()

    def mean(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Mean of the neighbours' values, 0 for none."""
        return np.asarray(self.matrix @ values) / np.maximum(self.degree, 1.0)

    def largest(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Largest of the neighbours' values, -inf for none."""
        result, some = np.full(len(values), -np.inf), self.degree > 0
        if some.any():
            result[some] = np.maximum.reduceat(values[self.matrix.indices], self.matrix.indptr[:-1][some])
        return result

    def all_of(self, flags: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Whether all neighbours have the flag; no for none."""
        return np.asarray((self.matrix @ flags.astype(float) == self.degree) & (self.degree > 0))

    def any_of(self, flags: NDArray[np.bool_]) -> NDArray[np.bool_]:
        return np.asarray(self.matrix @ flags.astype(float) > 0.0)

    @staticmethod
    def of_nodes(surface: Surface, seams: NDArray[np.int64] | None = None) -> Graph:
        """Corner points along facet edges; the rim belongs to one facet only. seams: as of the pressure space: what
        neighbours a point that follows neighbours those that it follows in its place, and seams are no rim."""
        n = len(surface.points)
        ends = []
        for kind, facets in by_kind(surface):
            corners, nodes = CELLS[kind].corners, surface.nodes[facets].astype(np.int64)
            pairs = [(0, 1)] if CELLS[kind].dim == 1 else [(i, (i + 1) % corners) for i in range(corners)]
            ends += [np.sort(nodes[:, list(ends_of_edge)], axis=1) for ends_of_edge in pairs]
        joined = np.concatenate(ends)
        if seams is not None:
            joined = _over_seams(joined, seams, n)
        edges, count = np.unique(joined, axis=0, return_counts=True)
        rim = np.zeros(n, dtype=bool)
        if surface.dim == 2:
            rim[np.bincount(edges.ravel(), minlength=n) == 1] = True
        else:
            rim[edges[count == 1]] = True
        return Graph(edges, n, rim)

    @staticmethod
    def of_facets(surface: Surface) -> Graph:
        """Facets that share an edge (2D: a point)."""
        facet, local = np.nonzero(surface.nodes >= 0)
        shape = (len(surface), len(surface.points))
        has = sp.csr_matrix((np.ones(len(facet)), (facet, surface.nodes[facet, local])), shape=shape)
        common = sp.triu(has @ has.T, 1).tocoo()
        edges = np.stack([common.row, common.col], axis=1)[common.data >= surface.dim - 1]
        return Graph(edges.astype(np.int64), len(surface), np.zeros(len(surface), dtype=bool))


def _over_seams(edges: NDArray[np.int64], seams: NDArray[np.int64], n: int) -> NDArray[np.int64]:
    """Edges (m, 2) of all facets, one at a seam as often as within a side; of ``n`` points."""
    follows, leads = np.zeros((2, n), dtype=bool)
    follows[seams[:, 0]], leads[seams[:, 1]] = True, True
    number = follows[edges].sum(axis=1)
    own, across = edges[number == 0], edges[number == 1]
    swapped = follows[across[:, 1]]
    across[swapped] = across[swapped, ::-1]
    leaders = sp.csr_matrix((np.ones(len(seams)), seams.T), shape=(n, n))[across[:, 0]].tocoo()
    instead = np.sort(np.stack([leaders.col, across[leaders.row, 1]], axis=1), axis=1)
    return np.concatenate([own, own[leads[own].all(axis=1)], instead])


def excluded(graph: Graph, share: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Points at the contactor's rim or of partly covered facets, and their neighbours: the pressure of a body with corners
    is singular there, and no mesh shows that without a swing."""
    near = graph.rim.copy()
    near[(share > 0.0) & (np.abs(share - 1.0) > WHOLE)] = True
    return near | graph.any_of(near)


def _inside(graph: Graph, closed: NDArray[np.bool_]) -> NDArray[np.bool_]:
    return np.asarray(closed & graph.all_of(closed))


def _carrying(graph: Graph, surface: Surface, values: NDArray[np.float64], largest: float) -> NDArray[np.bool_]:
    """Corner points (n_points,) whose multiplier carries pressure, and those between such points. Averages reach one facet
    further: the kink at the edge of contact is in those of the outermost."""
    corner = surface.nodes >= 0
    facet, local = np.nonzero(corner)
    most = np.zeros(len(surface.points))
    np.maximum.at(most, surface.nodes[facet, local], values.reshape(-1, MAX_FACET_NODES)[facet, local])
    closed = (most > CLOSED * largest) & (graph.degree > 0)
    near = closed | graph.any_of(closed)
    return np.asarray(near & graph.all_of(near))


def _edges(graph: Graph, pressure: NDArray[np.float64], inside: NDArray[np.bool_], largest: float) -> float:
    """Over edges with both ends inside: root of -r_i r_j, r = p - mean of the neighbours."""
    ripple = np.where(inside & (graph.degree > 1), pressure - graph.mean(pressure), 0.0)
    edges = sp.triu(graph.matrix, 1).tocoo()
    product = ripple[edges.row] * ripple[edges.col]
    return float(np.sqrt(np.maximum(-product, 0.0).max(initial=0.0))) / largest


def _alternating(
    graph: Graph, pressure: NDArray[np.float64], inside: NDArray[np.bool_], excluded: NDArray[np.bool_], largest: float
) -> float:
    closed = pressure > CLOSED * largest
    used = graph.degree > 0
    ripple = _edges(graph, pressure, inside & ~excluded, largest)
    single = used & closed & ~graph.any_of(closed) & ~excluded
    hole = used & ~closed & graph.all_of(closed) & ~excluded
    alone = float(pressure[single].max(initial=0.0)) / largest
    missing = float(graph.mean(pressure)[hole].max(initial=0.0)) / largest
    return max(ripple, alone, missing)


def _jumps(
    pair: Pair, surface: Surface, values: NDArray[np.float64], pressure: NDArray[np.float64], largest: float
) -> float:
    """Largest distance of a facet's own value at a corner from the reported one, where all facets there are closed."""
    if pair.space.name == "P0":
        return 0.0
    facet, local, node = [], [], []
    for kind, facets in by_kind(surface):
        n = CELLS[kind].corners
        facet.append(np.repeat(facets, n))
        local.append(np.tile(np.arange(n), len(facets)))
        node.append(surface.nodes[facets, :n].ravel())
    i, k, at = np.concatenate(facet), np.concatenate(local), np.concatenate(node)
    at_edge = values.reshape(-1, MAX_FACET_NODES)[i, k]
    opened = np.bincount(at, at_edge <= CLOSED * largest, minlength=len(pressure))
    inside = (opened == 0)[at]
    return float(np.abs(at_edge - pressure[at])[inside].max(initial=0.0)) / largest
