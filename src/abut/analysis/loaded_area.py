"""How much of the contactor is loaded: the edge of contact lies within facets, theory (P30)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.analysis.oscillation import Graph
from abut.contact.geometry import split_at_creases
from abut.contact.nodal_recovery import Averages
from abut.problem.pair import Pair

Array = NDArray[np.float64]

LOADED = 1e-3  # pressure over the largest from which on it counts: the constraint function is never quite zero
REACH = np.linspace(
    -0.5, 0.5, 101
)  # edge of contact from a node, in spacings of nodes: from none of its part to all of it


def edge_average(reach: Array) -> Array:
    """Average of sqrt(d) over the hat function of a node, d the distance to the edge of contact, 0 beyond it; times
    the root of the spacing, theory (P30). reach: how far the edge lies beyond the node, in spacings."""
    powers = np.maximum(reach[..., None] + np.array([1.0, 0.0, -1.0]), 0.0) ** 2.5
    return np.asarray(4.0 / 15.0 * (powers @ np.array([1.0, -2.0, 1.0])))


RATIO = edge_average(REACH) / edge_average(REACH + 1.0)  # average at a node over that at its inner neighbour


def loaded_shares(at: Averages, pressure: Array) -> Array:
    """How much of the part of the surface that each point stands for is loaded, (n_points,), from averages of the pressure
    (n_points,), theory (P30). Points beside the edge of contact are those with a covered neighbour that carries, beside
    them, less than one whose part the edge just reaches; all others are loaded all over, or not at all."""
    graph, covered = Graph.of_nodes(at.surface), at.weight > 0.0
    counts = np.where(pressure > LOADED * pressure.max(initial=0.0), pressure, 0.0)
    inner = graph.largest(counts)
    outer = -graph.largest(np.where(covered, -counts, -np.inf))
    ratio = counts / np.where(inner > 0.0, inner, 1.0)
    beside = (outer < RATIO[0] * counts) & (inner > 0.0)
    return np.where(beside, np.interp(ratio, RATIO, REACH + 0.5), (counts > 0.0).astype(float))


def loaded_parts(pair: Pair, at: Averages | None, pressure: Array, active: NDArray[np.bool_], shown: Array) -> Array:
    """How much of int H_k of each of the pair's functions is loaded, (n_functions,). pressure, active: (n_functions,) the
    multipliers and whether they are in contact; shown: (9 n_facets,) facet-wise coefficients of the pressure that results
    show; at: None where they are not averages: all or nothing then, as for functions at no corner."""
    whole = (active & (pressure > LOADED * pressure.max(initial=0.0))).astype(float)
    if at is None or not whole.any():
        return whole
    owner, n = split_at_creases(pair.contactor)[1], len(pair.contactor.points)
    share = loaded_shares(at, at.of(shown))
    area, loaded = (np.bincount(owner, values, minlength=n) for values in (at.weight, at.weight * share))
    of_points = np.divide(loaded, area, out=np.full(n, np.nan), where=area > 0.0)
    found = of_points[np.maximum(pair.space.node, 0)]
    return np.where((pair.space.node >= 0) & ~np.isnan(found), found, whole)
