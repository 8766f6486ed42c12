"""Normals of contact at small displacements: between those of contactor and target, theory (R2)."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.cells import CELLS, MAX_FACET_NODES
from abut.contact.coupling import Couple, CouplingOptions, IntegrationPoints
from abut.contact.coupling import couple as couple_here
from abut.contact.geometry import CREASE, by_kind, corner_functions, nodal_normals, split_at_creases, turning_within
from abut.contact.pressing_edges import TURNED, Opposite, at_edges, pressing
from abut.dofs import component_of, n_places, place_of
from abut.mesh.surface import Surface

NO_TILT = 1e-9  # between the normals of the two sides: rounding
POINTS = 3  # for each direction of a segment, so that the mean on curved facets is the same however segments are cut
Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


def common_normals(
    contactor: Surface, target: Surface, outward: Array, other: Array, share: float, reach: float, couple: Couple
) -> Array:
    """Unit normals at the contactor's facets' nodes, out of it, (n_facets, 9, dim), zero where padded: its ``outward``
    turned by ``share`` of the way to the target opposite, theory (R2); as they are where there is none, or it leans by
    more than at a crease. Where a sharp edge presses, those of the face that it presses on, theory (R2). outward, other: of
    contactor and target, as from ``nodal_normals``; reach: length, as for ``couple``."""
    if _facing_planes(contactor, outward, target, other):
        return outward
    options = CouplingOptions(points=POINTS, reach=reach, keep_points=True, normals=outward)
    if share == 0.0:  # edges alone could turn
        at = couple_here(contactor, target, 1, options, at_edges(contactor)).points
    else:
        at = couple(contactor, target, 1, options).points
    if at is None or not len(at.weight):
        return outward
    opposite = _opposite(target, other, at)
    tilt = opposite - at.normal
    mine, theirs = _edges(contactor, outward, target, other, at, opposite)
    edge = mine & ~theirs
    part = np.where(edge, 1.0, np.where(theirs & ~mine, 0.0, share))
    part[~edge & (np.einsum("na,na->n", at.normal, opposite) < CREASE)] = 0.0
    tilt *= part[:, None]
    if np.abs(tilt).max(initial=0.0) <= NO_TILT:
        return outward
    return _turned(contactor, outward, _at_nodes(contactor, at, tilt))


def edges_press(contactor: Surface, target: Surface, at: IntegrationPoints, least: float) -> tuple[Flags, Flags]:
    """Of contactor and target, whether a sharp edge of its facet presses there, theory (R2), at each integration point (n,).
    least: sine of the angle between the sides. Raises InputError for a facet without a normal."""
    outward, other = nodal_normals(contactor), nodal_normals(target)
    return _edges(contactor, outward, target, other, at, _opposite(target, other, at), least)


def _edges(
    contactor: Surface, outward: Array, target: Surface, other: Array, at: IntegrationPoints, opposite: Array,
    least: float = TURNED,
) -> tuple[Flags, Flags]:  # fmt: skip
    """The same with normals at hand. opposite: (n, dim) the target's at the points."""
    turns = turning_within(contactor, outward)[at.facet], turning_within(target, other)[at.target_facet]
    mine = pressing(contactor, outward, Opposite(at.facet, opposite, turns[1], at.weight), least)[at.facet]
    seen = Opposite(at.target_facet, -at.normal, turns[0], at.weight)
    return mine, pressing(target, other, seen, least)[at.target_facet]


def _facing_planes(contactor: Surface, outward: Array, target: Surface, other: Array) -> bool:
    """Whether all normals are one, of either side."""
    mine, theirs = outward[contactor.nodes >= 0], other[target.nodes >= 0]
    return bool(np.abs(mine - mine[0]).max() <= NO_TILT and np.abs(theirs + mine[0]).max() <= NO_TILT)


def _opposite(target: Surface, normals: Array, at: IntegrationPoints) -> Array:
    """The target's unit normal at each integration point, (n, dim), which points to the contactor."""
    n, dim = at.normal.shape
    entries = at.gap_operator.tocoo()
    along = -entries.data * at.normal[entries.row, component_of(entries.col, dim)]
    shape = n, n_places(at.gap_operator.shape[1], dim)
    shapes = sp.csr_matrix((along, (entries.row, place_of(entries.col, dim))), shape=shape)
    nodes = target.nodes[at.target_facet]
    point, local = np.nonzero(nodes >= 0)
    first = shapes.shape[1] - len(target.points)  # surfaces of one mesh share their points, else the target's come last
    values = np.asarray(shapes[point, first + nodes[point, local]]).ravel()
    result = np.zeros((n, dim))
    np.add.at(result, point, values[:, None] * normals[at.target_facet[point], local])
    return result / np.maximum(np.linalg.norm(result, axis=1, keepdims=True), 1e-300)


def _at_nodes(contactor: Surface, at: IntegrationPoints, values: Array) -> Array:
    """Means (n_facets, 9, dim) of values (n, dim) under the corners' functions, and between corners linear."""
    split, _ = split_at_creases(contactor)
    corner = np.zeros((len(contactor), MAX_FACET_NODES), dtype=bool)
    for kind, facets in by_kind(contactor):
        corner[facets, : CELLS[kind].corners] = True
    row = np.flatnonzero(corner.ravel())
    side = split.nodes[corner]
    gather = sp.csr_matrix((np.ones(len(row)), (row, side)), shape=(corner.size, len(split.points)))
    functions = (at.pressure @ gather).tocsr()
    weight = functions.T @ at.weight
    mean = (functions.T @ (at.weight[:, None] * values)) / np.maximum(weight, 1e-300)[:, None]
    mean[weight <= 0.0] = 0.0
    result = np.zeros((len(contactor), MAX_FACET_NODES, contactor.dim))
    for kind, facets in by_kind(contactor):
        between = corner_functions(kind, CELLS[kind].degree)
        n, corners = between.shape
        result[facets, :n] = np.einsum("kc,fcd->fkd", between, mean[split.nodes[facets, :corners]])
    return result


def _turned(contactor: Surface, normals: Array, tilt: Array) -> Array:
    """Unit normals less a tilt of their opposites."""
    result = normals - tilt
    length = np.linalg.norm(result, axis=2, keepdims=True)
    return np.where((contactor.nodes >= 0)[..., None], result / np.maximum(length, 1e-300), 0.0)
