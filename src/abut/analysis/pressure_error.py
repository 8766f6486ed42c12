"""How far the reported pressure is off inside contact, by estimate: the certificate's line "pressure error"."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.analysis.oscillation import CLOSED, WHOLE, Graph
from abut.contact.geometry import side_normals
from abut.contact.star_fits import of_second_order
from abut.problem.contact_pairs import Pair

SHARE, OF_SECOND_ORDER = 0.6, 0.8  # theory (P17)
ON_AXIS = 1e-9  # radius over the contactor's largest
EVEN = 1e-6  # smallest over largest eigenvalue of a star of nodes' second moments from which on it has an extent
TRIFLE = 1e-6  # stress over pressure from which down a body does not deform

Array = NDArray[np.float64]


def pressure_error(
    pair: Pair, pressure: Array, average: Array, share: Array, largest: float, stress: Array | None
) -> float:
    """Estimate of the largest error of the pressure at nodes inside contact over ``largest``, NaN where there are none.

    pressure, average, share: (n_points,) at the corners, of the contactor split at its creases: as reported, what that was
    recovered from, and the covered share of their supports; stress: (n_points,) as from ``normal_stress``; theory (P17)."""
    surface, normals = side_normals(pair.contactor)
    graph = Graph.of_nodes(surface)
    closed = (graph.degree > 0) & (average > CLOSED * largest)
    partly = (share > 0.0) & (np.abs(share - 1.0) > WHOLE)
    inside = closed & graph.all_of(closed) & ~partly
    axis, mirrored = _mirrored(pair, graph)
    at = inside & (~graph.rim | axis | mirrored)
    known = np.zeros(len(pressure), dtype=bool)
    if stress is not None and np.nanmax(np.abs(stress[at]), initial=0.0) > TRIFLE * largest:
        known = at & ~np.isnan(stress)
    beside_an_end = graph.any_of(partly | (graph.rim & ~axis & ~mirrored))  # where the pressure may have no bound
    second = known & of_second_order(surface) & ~beside_an_end
    bent = _between(graph, surface.points, normals, pressure) - pressure
    parts = [SHARE * bent[inside & (~graph.rim | axis) & ~second], OF_SECOND_ORDER * (pressure - average)[second]]
    if stress is not None:
        parts += [OF_SECOND_ORDER * (stress - pressure)[second], SHARE * (stress - pressure)[known & ~second]]
    off = np.abs(np.concatenate(parts))
    return float(off.max()) / largest if len(off) else float("nan")


def _mirrored(pair: Pair, graph: Graph) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Points (n_points,) at which the contactor ends but the pressure goes on, on an axis and on planes of symmetry."""
    surface, n = pair.contactor, len(graph.rim)
    axis, plane = np.zeros((2, n), dtype=bool)
    if surface.axisymmetric:
        radius = surface.points[:, 0]
        axis[: len(radius)] = radius <= ON_AXIS * radius[surface.node_ids].max()
    if pair.planes is not None:
        plane[: len(pair.planes.count)] = pair.planes.count > 0
    return axis & graph.rim & (graph.degree > 0), plane & graph.rim


def _between(graph: Graph, points: Array, normals: Array, values: Array) -> Array:
    """Values (n_points,) that a plane through those of the neighbours has at each point, fitted with the weight of the
    inverse square of the distance along the surface; the value at a single one; 0 at points without neighbours."""
    edges = graph.matrix.tocoo()
    used, i = np.unique(edges.row, return_inverse=True)
    j = edges.col
    away = points[j] - points[used[i]]
    away -= (away * normals[used[i]]).sum(axis=1, keepdims=True) * normals[used[i]]
    close = 1.0 / np.maximum((away**2).sum(axis=1), 1e-300)

    def total(of_edges: Array) -> Array:
        columns = [np.bincount(i, column, len(used)) for column in of_edges.reshape(len(i), -1).T]
        return np.stack(columns, axis=-1, dtype=float).reshape(len(used), *of_edges.shape[1:])

    weight = np.maximum(total(close), 1e-300)
    mean = total(close * values[j]) / weight
    centre = total(close[:, None] * away) / weight[:, None]
    apart = away - centre[i]
    metric = total(close[:, None, None] * apart[:, :, None] * apart[:, None])
    rate = total((close * (values[j] - mean[i]))[:, None] * apart)
    slope = np.einsum("nab,nb->na", np.linalg.pinv(metric, rcond=EVEN, hermitian=True), rate)
    result = np.zeros(len(points))
    result[used] = mean - (slope * centre).sum(axis=1)
    return result
