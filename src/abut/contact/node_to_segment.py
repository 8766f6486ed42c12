"""Node-to-segment contact, the method that segment-to-segment replaces: a reference for comparison only.

Each contactor node must not penetrate the target facet that its normal meets; its multiplier is the nodal force over the
node's tributary area. One pass fails the patch test where the meshes differ. Two passes (both sides as contactor) pass it
between straight facets of first order in 2D only, and their inf-sup constant is zero (El-Abbasi and Bathe 2001, sections 2
and 5).
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from abut._core import shape_functions
from abut.cells import CELLS, MAX_FACET_NODES
from abut.contact.bases import non_negative
from abut.contact.bulge import at_reference
from abut.contact.coupling import Coupling, default_reach, no_gap, surface_degree
from abut.contact.geometry import by_kind, facet_sizes, full_moments, nodal_normals, node_coordinates
from abut.contact.pressure_space import PressureSpace, facet_functions
from abut.dofs import dofs_at, n_dofs
from abut.mesh.surface import Surface
from abut.types import Sparse

INSIDE = 1e-9  # how far outside a facet, in reference coordinates, a foot still counts as on it


def node_to_segment(
    contactor: Surface, target: Surface, reach: float | None = None, adjust: float = 0.0
) -> tuple[Coupling, PressureSpace]:
    """Couple every contactor node with the point of the target that its normal meets; gaps and overlaps up to ``adjust``
    (length) count as zero.

    Returns the coupling (entries of a node stand in the row of one of its facets) and the space of nodal pressures; nodes
    that see no target within ``reach`` (a length) have no multiplier. Shapes and units are those of ``couple``. It fails the
    patch test wherever the meshes differ, and is here for comparison.
    """
    degree = surface_degree(contactor)
    row, node = facet_functions(contactor, degree)
    ids, first, column = np.unique(node, return_index=True, return_inverse=True)
    gather: Sparse = sp.csr_matrix(
        (np.ones(len(row)), (row, column.ravel())), shape=(MAX_FACET_NODES * len(contactor), len(ids))
    )
    moments = full_moments(contactor, degree).ravel()
    area = gather.T @ moments
    if not area.min() > 1e-9 * area.max():  # corners of tri6 have no area of their own, those of quad8 a negative one
        area = gather.T @ (non_negative(contactor).T @ moments)
    normal = nodal_normals(contactor).reshape(-1, contactor.dim)[row[first]]
    reach = default_reach(contactor, target) if reach is None else reach
    facet, shapes, gap = feet(contactor.points[ids], normal, target, reach)
    seen = np.flatnonzero(facet >= 0)
    gap = np.where(np.abs(gap) < no_gap(contactor, target, adjust), 0.0, gap)

    dim, same = contactor.dim, contactor.points is target.points
    offset = 0 if same else len(contactor.points)
    shape = (MAX_FACET_NODES * len(contactor), n_dofs(len(contactor.points) + (0 if same else len(target.points)), dim))
    force = -normal * area[:, None]  # along N, from target to contactor
    near = _rows(row[first][seen], ids[seen, None], np.ones((len(seen), 1)), force[seen], shape)
    nodes = target.nodes[facet[seen]]
    other = _rows(row[first][seen], np.where(nodes >= 0, offset + nodes, -1), shapes[seen], force[seen], shape)
    weight, weighted_gap = np.zeros(shape[0]), np.zeros(shape[0])
    weight[row[first][seen]] = area[seen]
    weighted_gap[row[first][seen]] = (area * gap)[seen]
    nodes_seen = np.bincount(row // MAX_FACET_NODES, np.isin(node, ids[seen]), minlength=len(contactor))
    share = nodes_seen / np.bincount(row // MAX_FACET_NODES, minlength=len(contactor))
    coupling = Coupling(
        degree=degree, operator=(near - other).tocsr(), contactor_part=near, target_part=other, gap=weighted_gap,
        weight=weight, mass=np.zeros((len(contactor), MAX_FACET_NODES, MAX_FACET_NODES)),
        covered=full_moments(contactor, 0)[:, 0] * share, segments=nodes_seen.astype(np.int32),
    )  # fmt: skip
    transfer, at = gather[:, seen].tocsr(), ids[seen].astype(np.int64)
    space = PressureSpace("nodal", degree, transfer, transfer, area[seen], at, at, len(ids) - len(seen), False)
    return coupling, space


def _rows(
    row: NDArray[np.int64], nodes: NDArray[np.int64], shapes: NDArray[np.float64], force: NDArray[np.float64],
    shape: tuple[int, int],
) -> Sparse:  # fmt: skip
    dim = force.shape[1]
    used = nodes >= 0
    k = np.nonzero(used)[0]
    value = shapes[used][:, None] * force[k]
    column = dofs_at(nodes[used], dim)
    return sp.csr_matrix((value.ravel(), (np.repeat(row[k], dim), column.ravel())), shape=shape)


def feet(
    points: NDArray[np.float64], normals: NDArray[np.float64], target: Surface, reach: float
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """For each point (n, dim) the target facet met along its normal (n, dim), -1 for none; shape functions there (n, 9); and
    the gap (n,), a length. Facets farther than ``reach`` are not met."""
    sizes = facet_sizes(target)
    x = np.where((target.nodes >= 0)[..., None], target.points[np.maximum(target.nodes, 0)], np.nan)
    tree = cKDTree(np.nanmean(x, axis=1))
    near = tree.query_ball_point(points, reach + 1.5 * np.sqrt(target.dim) * sizes.max())
    count = np.array([len(n) for n in near])
    who, facet = np.repeat(np.arange(len(points)), count), np.concatenate([*near, []]).astype(np.int64)
    best, distance = np.full(len(points), -1), np.full(len(points), np.inf)
    shapes, gaps = np.zeros((len(points), MAX_FACET_NODES)), np.zeros(len(points))
    for kind, facets in by_kind(target):
        pick = np.flatnonzero(np.isin(facet, facets))
        values, along, hit = _meet(target, kind, facet[pick], points[who[pick]], normals[who[pick]])
        hit &= np.abs(along) <= reach
        for i in np.flatnonzero(hit)[np.argsort(-np.abs(along[hit]))]:  # the nearest is written last
            p = who[pick[i]]
            if abs(along[i]) <= distance[p]:
                best[p], distance[p], gaps[p] = facet[pick[i]], abs(along[i]), along[i]
                shapes[p], shapes[p, : values.shape[1]] = 0.0, values[i]
    return best, shapes, gaps


def _meet(
    target: Surface, kind: str, facets: NDArray[np.int64], points: NDArray[np.float64], normals: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
    """Where lines from points along normals meet given facets (Newton): shape functions, distance, inside and facing."""
    cell = CELLS[kind]
    dim = target.dim
    x = target.points[target.nodes[facets, : cell.nodes]]
    xi = np.tile(node_coordinates(kind)[: cell.corners].mean(axis=0), (len(facets), 1))
    along = np.zeros(len(facets))
    matrix = np.zeros((len(facets), dim, dim))
    for _ in range(12):
        shape, derivative = shape_functions(cell.code, np.ascontiguousarray(xi))
        miss = np.einsum("pn,pnd->pd", shape, x) - points - along[:, None] * normals
        matrix[:, :, :-1] = np.einsum("pna,pnd->pda", derivative, x)
        matrix[:, :, -1] = -normals
        regular = np.abs(np.linalg.det(matrix)) > 1e-12 * np.abs(matrix[:, :, :-1]).max(axis=(1, 2)) ** (dim - 1)
        step = np.zeros_like(miss)
        step[regular] = np.linalg.solve(matrix[regular], miss[regular][..., None])[..., 0]
        xi, along = np.clip(xi - step[:, :-1], -3.0, 3.0), along - step[:, -1]
    if cell.dim == 2 and cell.corners == 3:
        inside = (xi >= -INSIDE).all(axis=1) & (xi.sum(axis=1) <= 1.0 + INSIDE)
    else:
        inside = (np.abs(xi) <= 1.0 + INSIDE).all(axis=1)
    tangents = matrix[:, :, :-1]
    if dim == 2:
        facing = tangents[:, 1, 0] * normals[:, 0] - tangents[:, 0, 0] * normals[:, 1] < 0.0
    else:
        facing = np.einsum("pd,pd->p", np.cross(tangents[:, :, 0], tangents[:, :, 1]), normals) < 0.0
    shape, _ = shape_functions(cell.code, np.ascontiguousarray(xi))
    along = along - np.where(inside, at_reference(target, kind, facets, xi), 0.0)
    return shape, along, inside & facing & regular
