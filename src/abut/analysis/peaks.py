"""Peaks and holes of the reported pressure that are narrower than a facet of the coarser side: theory (P24)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from abut.analysis.oscillation import CLOSED, Graph, excluded
from abut.analysis.statistics import SUPPORTED
from abut.contact.geometry import facet_sizes
from abut.mesh.surface import Surface
from abut.problem.pair import Pair

FARTHEST = 12  # facets of the contactor to one of the target beyond which nobody counts
LEAST = 0.05  # of the largest pressure: what is carried by peaks alone counts as this much

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Peaks:
    """carried: the largest pressure that more than a peak carries, which errors are compared with, so that none is small
    beside itself; hole: how far the pressure falls in the deepest hole; out: share by which the largest one stands out of
    what lies beside it; at_edge: whether it lies at an edge of the contactor or of the target."""

    carried: float
    hole: float
    out: float
    at_edge: bool


def peaks_of(pair: Pair, surface: Surface, loaded: Flags, pressure: Array, share: Array, gives: float) -> Peaks:
    """Of a pair's pressure (n_points,) at the corners of its contactor split at creases. loaded: (n_facets,) bool; share:
    (n_points,) covered share of their supports; gives: the target's share of what both sides give way."""
    graph = Graph.of_nodes(surface)
    there = (graph.degree > 0) & (share >= SUPPORTED)
    there = there if (there & (pressure > 0.0)).any() else (graph.degree > 0) & (share > 0.0)
    largest = float(pressure[there].max(initial=0.0))
    if not largest > 0.0:
        return Peaks(np.inf, 0.0, 0.0, False)
    hops = reach(pair, loaded, gives)
    apart = excluded(graph, share)
    low = opened(graph, pressure, there, hops)
    scale = max(float(low[there].max()), LEAST * largest)
    place = int(np.argmax(np.where(there, pressure, -np.inf)))
    hole = _deepest_hole(_Where(pair, surface, graph, there, hops, scale), pressure, apart)
    return Peaks(scale, hole, float(1.0 - max(low[place], 0.0) / pressure[place]), bool(apart[place]))


def reach(pair: Pair, loaded: Flags, share: float) -> int:
    """How many of the contactor's facets lie on one of the target's where it is loaded, (n_facets,) bool, as far as the
    target gives way: ``share`` of what both sides do. At least 1."""
    at = pair.coupling.gap_samples
    if at is None or not len(at.gap):
        return 1
    seen = loaded[at.facet]
    if not seen.any():
        return 1
    ratio = facet_sizes(pair.target)[at.target_facet[seen]] / facet_sizes(pair.contactor)[at.facet[seen]]
    return int(np.clip(np.rint(share * np.median(ratio)), 1, FARTHEST))


def opened(graph: Graph, values: Array, there: Flags, hops: int) -> Array:
    """Values (n_points,) without their peaks: at each point the largest value that all points of some neighbourhood of
    ``hops`` around it have at least. there: (n_points,) which have a value."""
    return _most(graph, _least(graph, values, there, hops), there, hops)


def closed_up(graph: Graph, values: Array, there: Flags, hops: int) -> Array:
    """The same without holes."""
    return -opened(graph, -values, there, hops)


def _most(graph: Graph, values: Array, there: Flags, hops: int) -> Array:
    result = np.where(there, values, -np.inf)
    for _ in range(hops):
        result = np.where(there, np.maximum(result, graph.largest(result)), -np.inf)
    return result


def _least(graph: Graph, values: Array, there: Flags, hops: int) -> Array:
    return -_most(graph, -values, there, hops)


@dataclass(frozen=True)
class _Where:
    """A pair, its surface split at creases with its graph, which points have a value, (n_points,), how many facets of the
    contactor lie on one of the target, and the pressure that counts."""

    pair: Pair
    surface: Surface
    graph: Graph
    there: Flags
    hops: int
    scale: float


def _deepest_hole(at: _Where, pressure: Array, apart: Flags) -> float:
    """How far the pressure falls in a hole narrower than two facets of the coarser side; of closed nodes only where the
    target's facets are larger. apart: (n_points,) where it may be singular."""
    around = _going_on(at.graph, pressure) if at.hops == 1 else pressure
    depth = np.where(at.there, closed_up(at.graph, around, at.there, at.hops) - pressure, 0.0)
    empty = at.there & (pressure <= CLOSED * at.scale)
    depth[apart | _outside(at.graph, empty, ~at.there | at.graph.rim)] = 0.0
    if at.hops == 1:
        depth[~empty] = 0.0
    if not (depth > 0.0).any():
        return 0.0
    depth[_relieved(at)] = 0.0
    return float(depth.max(initial=0.0))


def _going_on(graph: Graph, pressure: Array) -> Array:
    """What is left of a pressure one point further if it falls there as it did from its highest neighbour, at least 0: a
    valley between two contacts is no hole."""
    rise = np.maximum(graph.largest(pressure) - pressure, 0.0)
    return np.asarray(np.maximum(pressure - rise, 0.0))


def _outside(graph: Graph, open_: Flags, border: Flags) -> Flags:
    """Open points that are connected with the border by open points."""
    at = np.flatnonzero(open_)
    if not len(at):
        return open_
    _, part = connected_components(graph.matrix[at][:, at], directed=False)
    reaches = np.bincount(part, (border | graph.any_of(border & (graph.degree > 0)))[at]) > 0.0
    result = np.zeros_like(open_)
    result[at] = reaches[part]
    return result


def _relieved(of: _Where) -> Flags:
    """Points where the sides stand off each other by more, beyond what is so around, than the pressure presses in over a
    facet of the coarser side: a recess, no hole in the pressure."""
    at, there = of.pair.coupling.gap_samples, of.there
    if at is None or not len(at.gap):
        return np.zeros(len(there), dtype=bool)
    weight, gap = np.zeros((2, len(there)))
    nodes = of.surface.nodes[at.facet]
    for a in range(nodes.shape[1]):
        used = nodes[:, a] >= 0
        share = np.maximum(at.contactor_shapes[used, a], 0.0)
        weight += np.bincount(nodes[used, a], share, len(weight))
        gap += np.bincount(nodes[used, a], share * at.gap[used], len(weight))
    known = there & (weight > 0.0)
    gap = np.where(known, gap / np.where(weight > 0.0, weight, 1.0), 0.0)
    depth = np.where(known, gap - opened(of.graph, gap, known, of.hops), 0.0)
    return np.asarray(depth > of.pair.compliance * of.scale * of.hops * of.pair.size / np.pi)
