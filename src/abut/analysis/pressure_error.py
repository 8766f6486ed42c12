"""How far the reported pressure is off inside contact, by estimate: the certificate's line "pressure error"."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.analysis.oscillation import CLOSED, Graph
from abut.contact.geometry import side_normals
from abut.contact.nodal_recovery import ON_AXIS
from abut.problem.pair import WHOLE, Pair

AVERAGED = 1.0 / 6.0  # of half the second difference: averages, theory (P17)
CHANGE = 0.4  # of the change of that from node to node, theory (P17)
ALTERNATING = 0.75  # of what changes its sign from node to node, theory (P17)
STRESS = 0.4  # of the difference from the stress, theory (P17)
EVEN = 1e-6  # smallest over largest eigenvalue of a star of nodes' second moments from which on it has an extent
TRIFLE = 1e-6  # stress over pressure from which down a body does not deform

Array = NDArray[np.float64]


def pressure_error(
    pair: Pair, pressure: Array, share: Array, largest: float, stress: Array | None, carried: float = np.inf,
    average: Array | None = None,
) -> float:  # fmt: skip
    """Estimate of the largest error of the pressure at nodes inside contact over ``largest``, NaN where there are none.

    pressure, average, share: (n_points,) at the corners, of the contactor split at its creases: as reported, what that was
    recovered from (by default it itself), and the covered share of their supports; stress: (n_points,) as from
    ``normal_stress``; carried: pressure that those at edges of bodies, which may have no limit, are taken for at most;
    theory (P17)."""
    surface, normals = side_normals(pair.contactor)
    graph = Graph.of_nodes(surface, pair.space.seams)
    average = pressure if average is None else average
    closed = (graph.degree > 0) & (average > CLOSED * largest)
    partly = (share > 0.0) & (np.abs(share - 1.0) > WHOLE)
    inside = closed & graph.all_of(closed) & ~partly
    axis, mirrored = _mirrored(pair, graph)
    edge = (graph.rim & ~axis & ~mirrored) | partly
    taken_off = np.abs(pressure - average)
    unbounded = edge & (pressure > carried)
    pressure = np.where(edge, np.minimum(pressure, carried), pressure)
    within = inside & (~graph.rim | axis | mirrored)
    beside = graph.any_of(unbounded)  # differences from a value cut off say nothing there, nor do stresses
    planes = _planes(pair, len(graph.rim))
    bent = np.where(within, _between(graph, surface.points, normals, pressure, *planes) - pressure, 0.0)
    alternating = ALTERNATING * _alternating(graph, np.where(beside, 0.0, bent))
    averaged = AVERAGED * np.abs(bent) + np.maximum(alternating, CHANGE * _change(graph, bent, within))
    parts = [np.where((taken_off > 0.0) & ~beside, taken_off + alternating, averaged)[within]]
    if stress is not None and np.nanmax(np.abs(stress[within]), initial=0.0) > TRIFLE * largest:
        known = within & ~np.isnan(stress)
        # Stresses next to the edge of contact are those of cells beyond it too.
        away = known & graph.all_of(inside | edge) & ~beside
        parts.append(STRESS * np.abs(stress - pressure)[away if away.any() else known])
    off = np.concatenate(parts)
    return float(off.max()) / largest if len(off) else float("nan")


def hollow(pair: Pair, pressure: Array, largest: float) -> float:
    """How far the pressure on planes of symmetry lies below the plane through its neighbours and their mirror images at
    most, inside contact, over ``largest``: a pressure that is even and has its top there lies above it.

    pressure: (n_points,) at the corners, of the contactor split at its creases."""
    surface, normals = side_normals(pair.contactor)
    graph = Graph.of_nodes(surface, pair.space.seams)
    count, along = _planes(pair, len(graph.rim))
    _, mirrored = _mirrored(pair, graph)
    free = graph.rim & ~mirrored  # the body's own edge, whose pressure may have no limit, to where it meets a plane
    closed = (pressure > CLOSED * largest) & ~free & ~(mirrored & graph.any_of(free))
    within = mirrored & closed & graph.all_of(closed)
    if not within.any():
        return 0.0
    below = _between(graph, surface.points, normals, pressure, count, along) - pressure
    return max(float(below[within].max()), 0.0) / largest


def _change(graph: Graph, bent: Array, within: NDArray[np.bool_]) -> Array:
    """Half the distance of values from the mean of those of the neighbours ``within``, (n_points,)."""
    count = np.asarray(graph.matrix @ within.astype(float))
    mean = np.asarray(graph.matrix @ bent) / np.maximum(count, 1.0)  # zero elsewhere
    return np.asarray(np.where(count > 0.0, 0.5 * np.abs(bent - mean), 0.0))


def _alternating(graph: Graph, bent: Array) -> Array:
    """What changes its sign from node to node, (n_points,): the root of the products with the neighbours."""
    edges = graph.matrix.tocoo()
    product = np.maximum(-bent[edges.row] * bent[edges.col], 0.0)
    result = np.zeros(len(bent))
    np.maximum.at(result, edges.row, product)
    return np.asarray(np.sqrt(result))


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


def _planes(pair: Pair, n: int) -> tuple[NDArray[np.int64], Array]:
    """On how many planes of symmetry each point lies, (n,), and the contactor's tangent along one, (n, dim), or zero."""
    count, along = np.zeros(n, dtype=np.int64), np.zeros((n, pair.contactor.dim))
    if pair.planes is not None:
        count[: len(pair.planes.count)], along[: len(pair.planes.along)] = pair.planes.count, pair.planes.along
    return count, along


def _between(
    graph: Graph, points: Array, normals: Array, values: Array, planes: NDArray[np.int64], along: Array
) -> Array:
    """Values (n_points,) that a plane through those of the neighbours has at each point, fitted with the weight of the
    inverse square of the distance along the surface; the value at a single one; 0 at points without neighbours. On planes of
    symmetry, ``planes`` (n_points,) of them, neighbours off them count with their mirror images, so that the plane rises
    ``along`` (n_points, dim) at most."""
    edges = graph.matrix.tocoo()
    used, i = np.unique(edges.row, return_inverse=True)
    j = edges.col
    away = points[j] - points[used[i]]
    away -= (away * normals[used[i]]).sum(axis=1, keepdims=True) * normals[used[i]]
    close = 2.0 ** np.maximum(planes[used[i]] - planes[j], 0) / np.maximum((away**2).sum(axis=1), 1e-300)
    tangent = along[used[i]]
    away = np.where(planes[used[i], None] > 0, (away * tangent).sum(axis=1, keepdims=True) * tangent, away)

    def total(of_edges: Array) -> Array:
        columns = [np.bincount(i, column, len(used)) for column in of_edges.reshape(len(i), -1).T]
        return np.stack(columns, axis=-1, dtype=float).reshape(len(used), *of_edges.shape[1:])

    weight = np.maximum(total(close), 1e-300)
    mean = total(close * values[j]) / weight
    centre = total(close[:, None] * away) / weight[:, None]
    apart = away - centre[i]
    metric = total(close[:, None, None] * apart[:, :, None] * apart[:, None])
    rate = total((close * (values[j] - mean[i]))[:, None] * apart)
    spread = np.bincount(i, minlength=len(used))  # that of one neighbour is rounding beside it
    size, axes = np.linalg.eigh(metric)
    known = size > EVEN * spread[:, None]
    along = np.einsum("nda,nd->na", axes, rate)
    slope = np.einsum("nda,na->nd", axes, np.where(known, along / np.where(known, size, 1.0), 0.0))
    result = np.zeros(len(points))
    result[used] = mean - (slope * centre).sum(axis=1)
    return result
