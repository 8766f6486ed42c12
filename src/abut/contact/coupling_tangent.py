"""Derivatives of a contact pair's coupling by the coordinates of both surfaces, theory (T1).

What ``abut.contact.coupling.couple`` integrates is differentiated as it computes it: places where nodes are projected,
clipping, integration points, normals, areas, rays. Only decisions are constants: which facets meet and hide each other,
numbers of integration points and subdivisions, creases.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut._core import couple_tangent, shape_functions
from abut.cells import CELLS, MAX_FACET_NODES
from abut.contact.coupling import CouplingOptions, check_pair, cutting_arguments, point_columns
from abut.contact.geometry import (
    REFERENCE_AREA,
    Smoothing,
    area_vectors,
    by_kind,
    node_coordinates,
    smoothing,
)
from abut.errors import InputError
from abut.mesh.surface import Surface
from abut.types import Array, Json, Sparse


@dataclass(frozen=True)
class CouplingTangent:
    """Derivatives of one contact pair's coupling. Columns are dim times the points of ``abut.contact.coupling.Coupling``.

    gap, weight:   (9 n_facets, dim n_points), of int H_k g and int H_k.
    force:         (dim n_points,) sum_k int H_k (p_k N + (I - N N) t_k) (N_C - N_T) da: what the contact does to the nodes.
    force_tangent: (dim n_points, dim n_points), its derivative at constant p and t; not symmetric.
    """

    gap: Sparse
    weight: Sparse
    force: NDArray[np.float64]
    force_tangent: Sparse


def coupling_tangent(
    contactor: Surface,
    target: Surface,
    degree: int,
    options: CouplingOptions,
    pressure: Array,
    traction: Array | None = None,
    only: NDArray[np.bool_] | None = None,
    across: Smoothing | None = None,
) -> CouplingTangent:
    """Differentiate ``couple(contactor, target, degree, options, only, across)`` by the surfaces' points: theory (T1).

    pressure, traction: (9 n_facets,) and (9 n_facets, dim), coefficients of the facet-wise functions.
    Gaps that ``couple`` takes as none, being within ``options.adjust`` or rounding, change like others.
    Raises InputError where surfaces or coefficients do not fit together, and for componentwise coupling.
    """
    check_pair(contactor, target)
    _check_load(contactor, options, pressure, traction)
    facets = np.arange(len(contactor)) if only is None else np.flatnonzero(only)
    across = across or smoothing(contactor)
    numbers, first = _distinct_normals(contactor, across)
    offset, n_points = point_columns(contactor, target)
    raw = couple_tangent(
        **cutting_arguments(contactor, target, facets, options, across),
        degree=degree,
        pressure=np.ascontiguousarray(pressure.reshape(-1, MAX_FACET_NODES)[facets], dtype=float),
        traction=_tractions(traction, facets, contactor.dim),
        normal_numbers=np.ascontiguousarray(numbers[facets]),
        target_offset=offset,
        n_points=n_points,
    )
    turning = _turning(contactor, across, first, n_points)
    gap, weight = _moments(raw, turning, facets, len(contactor), n_points)
    force = np.zeros((n_points, contactor.dim))
    np.add.at(force, raw["loaded"], raw["load"])
    size = contactor.dim * n_points
    by_normals = _sparse(raw["force_by_normals"], (size, contactor.dim * len(first)))
    tangent = _sparse(raw["force_by_points"], (size, size)) + by_normals @ turning
    return CouplingTangent(gap, weight, force.ravel(), tangent)


def normal_derivative(contactor: Surface, across: Smoothing | None = None) -> Sparse:
    """Derivative of ``nodal_normals(contactor, across)`` by its points, (9 n_facets dim, dim n_points), zero where padded;
    theory (T2)."""
    across = across or smoothing(contactor)
    used = np.flatnonzero(contactor.nodes.ravel() >= 0)
    visits = _turning(contactor, across, np.arange(len(used)), len(contactor.points))
    dim, n = contactor.dim, contactor.nodes.size
    rows = (dim * used[:, None] + np.arange(dim)).ravel()
    place = sp.csr_matrix((np.ones(len(rows)), (rows, np.arange(len(rows)))), shape=(dim * n, len(rows)))
    return (place @ visits).tocsr()


def _check_load(contactor: Surface, options: CouplingOptions, pressure: Array, traction: Array | None) -> None:
    n = MAX_FACET_NODES * len(contactor)
    if options.componentwise:
        raise InputError("a componentwise coupling has no normal, and no derivative: leave 'componentwise' out")
    if pressure.shape != (n,):
        raise InputError(f"the pressure on '{contactor.name}' has shape {pressure.shape}, not ({n},)")
    if traction is not None and traction.shape != (n, contactor.dim):
        raise InputError(f"the traction on '{contactor.name}' has shape {traction.shape}, not ({n}, {contactor.dim})")


def _tractions(traction: Array | None, facets: NDArray[np.int64], dim: int) -> NDArray[np.float64]:
    if traction is None:
        return np.zeros((0, MAX_FACET_NODES, dim))
    return np.ascontiguousarray(traction.reshape(-1, MAX_FACET_NODES, dim)[facets], dtype=float)


def _distinct_normals(surface: Surface, across: Smoothing) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """Numbers of the nodal normals that differ, (n_facets, 9), and the first visit that has each."""
    used = surface.nodes >= 0
    keys = np.random.default_rng(0).integers(0, 2**63, int(used.sum()), dtype=np.uint64)
    total = np.zeros_like(keys)  # the same where the same facets are averaged
    np.add.at(total, across.here, keys[across.other])
    _, first, number = np.unique(total, return_index=True, return_inverse=True)
    numbers = np.full(surface.nodes.shape, -1, dtype=np.int32)
    numbers[used] = number.ravel()
    return numbers, first


def _turning(surface: Surface, across: Smoothing, visits: NDArray[np.int64], n_points: int) -> Sparse:
    """Derivative of the unit normals of some visits, (dim len(visits), dim n_points)."""
    vectors = area_vectors(surface)[surface.nodes >= 0]
    number = np.full(len(vectors), -1)
    number[visits] = np.arange(len(visits))
    kept = number[across.here] >= 0
    here, other = number[across.here[kept]], across.other[kept]
    total = np.zeros((len(visits), surface.dim))
    np.add.at(total, here, vectors[other])
    length = np.linalg.norm(total, axis=1)[:, None, None]
    unit = total / length[:, 0]
    across_it = (np.eye(surface.dim) - unit[:, :, None] * unit[:, None, :]) / length
    sums = sp.csr_matrix((np.ones(len(here)), (here, other)), shape=(len(visits), len(vectors)))
    n = np.arange(len(visits) + 1)
    project = sp.bsr_matrix((across_it, n[:-1], n))
    return (
        project.tocsr() @ (sp.kron(sums, sp.identity(surface.dim), format="csr") @ _swelling(surface, n_points))
    ).tocsr()


def _swelling(surface: Surface, n_points: int) -> Sparse:
    """Derivative of each visit's area vector by the points, (dim n_visits, dim n_points)."""
    dim = surface.dim
    visit = np.full(surface.nodes.shape, -1)
    used = surface.nodes >= 0
    visit[used] = np.arange(int(used.sum()))
    rows, columns, values = [], [], []
    for kind, facets in by_kind(surface):
        cell = CELLS[kind]
        nodes = surface.nodes[facets, : cell.nodes]
        blocks = _area_rates(surface, kind, nodes)
        at = np.broadcast_to(visit[facets, : cell.nodes, None], blocks.shape[:3])
        rows.append(at.ravel())
        columns.append(np.broadcast_to(nodes[:, None, :], blocks.shape[:3]).ravel())
        values.append(blocks.reshape(-1, dim, dim))
    row, column, value = (np.concatenate(parts) for parts in (rows, columns, values))
    step = np.arange(dim)
    i = np.broadcast_to(dim * row[:, None, None] + step[:, None], value.shape)
    j = np.broadcast_to(dim * column[:, None, None].astype(np.int64) + step, value.shape)
    return sp.csr_matrix((value.ravel(), (i.ravel(), j.ravel())), shape=(dim * int(used.sum()), dim * n_points))


def _area_rates(surface: Surface, kind: str, nodes: Array) -> NDArray[np.float64]:
    """Derivative of the area vectors at a facet's nodes by its points, (facets, nodes, nodes, dim, dim)."""
    cell = CELLS[kind]
    _, slopes = shape_functions(cell.code, np.ascontiguousarray(node_coordinates(kind)))  # (at, node, direction)
    if surface.dim == 2:
        turn = np.array([[0.0, 1.0], [-1.0, 0.0]])
        return np.broadcast_to(slopes[None, :, :, 0, None, None] * turn, (len(nodes), *slopes.shape[:2], 2, 2))
    tangents = np.einsum("pja,fjd->fpad", slopes, surface.points[nodes])
    along, up = _crossing(tangents[:, :, 0]), _crossing(tangents[:, :, 1])
    first, second = slopes[None, :, :, 0, None, None], slopes[None, :, :, 1, None, None]
    return REFERENCE_AREA[cell.corners] * (second * along[:, :, None] - first * up[:, :, None])


def _crossing(v: Array) -> NDArray[np.float64]:
    """The matrices (..., 3, 3) of w -> v x w."""
    result = np.zeros((*v.shape, 3))
    for a, b, c in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        result[..., a, c], result[..., c, a] = v[..., b], -v[..., b]
    return result


def _moments(
    raw: Json, turning: Sparse, facets: NDArray[np.int64], n_facets: int, n_points: int
) -> tuple[Sparse, Sparse]:
    dim = turning.shape[1] // n_points
    result = []
    for k in range(2):
        parts = []
        for name, width in (("moment_by_points", dim * n_points), ("moment_by_normals", turning.shape[0])):
            value, column, start = raw[name]
            blocks = np.ascontiguousarray(value[:, k : k + 1])
            parts.append(_sparse((blocks, column, start), (MAX_FACET_NODES * len(facets), width)))
        moment = parts[0] + parts[1] @ turning
        if len(facets) < n_facets:
            rows = (MAX_FACET_NODES * facets[:, None] + np.arange(MAX_FACET_NODES)).ravel()
            shape = MAX_FACET_NODES * n_facets, len(rows)
            moment = sp.csr_matrix((np.ones(len(rows)), (rows, np.arange(len(rows)))), shape=shape) @ moment
        result.append(moment.tocsr())
    return result[0], result[1]


def _sparse(blocks: tuple[Array, Array, Array], shape: tuple[int, int]) -> Sparse:
    """Compressed blocks (value, column, start) as rows."""
    return sp.bsr_matrix(blocks, shape=shape).tocsr()
