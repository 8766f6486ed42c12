"""Facet geometry of a surface: nodal normals, sizes, exact moments of the pressure functions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from abut._core import shape_functions
from abut.cells import BY_CODE, CELLS, MAX_FACET_NODES
from abut.contact.turned_images import Images, extended, sides_of_split, used_sides
from abut.errors import InputError
from abut.mesh.integrals import determinants
from abut.mesh.quadrature import gauss_rule
from abut.mesh.surface import Surface

CREASE = np.cos(np.deg2rad(40.0))  # facets that meet at a larger angle keep their own normals at the common edge
FLAT = 1e-9  # area element at a facet's node over the largest at its nodes, from which down the normal is lost
PLANE = 1e-12  # of the largest coordinate: heights below are rounding

_CORNER_XI = {
    1: np.array([[-1.0], [1.0]]),
    3: np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]),
    4: np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]),
}
REFERENCE_AREA = {3: 0.5, 4: 4.0}  # of facets by corners; that of lines is the same for all
LINEAR_FACET = {"line3": "line2", "tri6": "tri3", "quad8": "quad4", "quad9": "quad4"}


def node_coordinates(kind: str) -> NDArray[np.float64]:
    """Reference coordinates (nodes, dim) of a facet type's nodes."""
    cell = CELLS[kind]
    corners = _CORNER_XI[1 if cell.dim == 1 else cell.corners]
    if cell.degree == 1:
        return corners
    if cell.dim == 1:
        return np.vstack([corners, [[0.0]]])
    middles = 0.5 * (corners + np.roll(corners, -1, axis=0))
    return np.vstack([corners, middles, [[0.0, 0.0]]])[: cell.nodes]


def by_kind(surface: Surface) -> list[tuple[str, NDArray[np.int64]]]:
    """The facet types present, each with its facet numbers (m,)."""
    return [(BY_CODE[code].name, np.flatnonzero(surface.kinds == code)) for code in np.unique(surface.kinds)]


def straight(surface: Surface) -> Surface:
    """Facets of first order through the corners."""
    kinds, nodes = surface.kinds.copy(), surface.nodes.copy()
    for kind, facets in by_kind(surface):
        corners = CELLS[LINEAR_FACET.get(kind, kind)]
        kinds[facets] = corners.code
        nodes[facets, corners.nodes :] = -1
    return replace(surface, kinds=kinds, nodes=nodes)


def _area_vectors(
    surface: Surface, kind: str, facets: NDArray[np.int64], xi: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Outward normal times area element at reference points xi, (facets, points, dim)."""
    cell = CELLS[kind]
    _, derivatives = shape_functions(cell.code, np.ascontiguousarray(xi))
    tangents = np.einsum("pna,fnd->fpad", derivatives, _nodes(surface, kind, facets))
    if surface.dim == 2:
        return np.stack([tangents[..., 0, 1], -tangents[..., 0, 0]], axis=-1)
    (a, b, c), (u, v, w) = np.moveaxis(tangents, (-2, -1), (0, 1))
    return np.stack([b * w - c * v, c * u - a * w, a * v - b * u], axis=-1)


def _nodes(surface: Surface, kind: str, facets: NDArray[np.int64]) -> NDArray[np.float64]:
    return surface.points[surface.nodes[facets, : CELLS[kind].nodes]]


def facet_sizes(surface: Surface) -> NDArray[np.float64]:
    """Length of each facet: largest extent of its bounding box, (n_facets,), in the unit of the coordinates."""
    x = surface.points[np.maximum(surface.nodes, 0)]
    padded = (surface.nodes < 0)[..., None]
    return (np.where(padded, -np.inf, x).max(axis=1) - np.where(padded, np.inf, x).min(axis=1)).max(axis=1)


def area_vectors(surface: Surface) -> NDArray[np.float64]:
    """Outward normals of each facet by itself at its nodes, as long as its area there, (n_facets, 9, dim), zero where
    padded."""
    areas = np.zeros((len(surface), MAX_FACET_NODES, surface.dim))
    for kind, facets in by_kind(surface):
        vectors = _area_vectors(surface, kind, facets, node_coordinates(kind))
        areas[facets, : CELLS[kind].nodes] = REFERENCE_AREA.get(CELLS[kind].corners, 1.0) * vectors
    return areas


@dataclass(frozen=True)
class OnPlanes:
    """Visits (n,) at planes of symmetry, and projections (n, dim, dim) on what lies in these: with the mirror images of the
    facets there area vectors add up to twice their part in the planes."""

    visits: NDArray[np.int64]
    inside: NDArray[np.float64]


@dataclass(frozen=True)
class Smoothing:
    """Which facets' normals are averaged at each node of each facet, as decided in one configuration of a surface.

    A visit is a node of a facet, counted facet by facet.

    here, other: (n,) visits at the same point with no crease between them: the normal at ``here`` contains the facet of
                 ``other``. Each visit is a pair with itself.
    planes:      where the surface goes on as its mirror image, whatever its configuration.
    images:      visits beyond the sides of a sector, numbered after the surface's own; ``other`` may be one.
    """

    here: NDArray[np.int64]
    other: NDArray[np.int64]
    planes: OnPlanes | None = None
    images: Images | None = None


def smoothing(surface: Surface) -> Smoothing:
    """Creases are edges where facets meet at more than 40 degrees. Raises InputError for a facet without a normal at one
    of its nodes."""
    if used_sides(surface) is not None:
        return _across_sides(surface)
    areas = area_vectors(surface)
    facet, local = _visits(surface)
    vector = areas[facet, local]
    length = np.linalg.norm(vector, axis=1, keepdims=True)
    check_normals(surface, areas, length)
    pairs = list(_without_crease(surface.nodes[facet, local].astype(np.int64), vector / length))
    return Smoothing(np.concatenate([p[0] for p in pairs]), np.concatenate([p[1] for p in pairs]))


def _across_sides(surface: Surface) -> Smoothing:
    """The same of a surface that goes on beyond the sides of a sector."""
    more = extended(surface, 1)
    found = smoothing(more.surface)
    facet, local = _visits(more.surface)
    number = np.full(surface.nodes.shape, -1)
    number[_visits(surface)] = own = np.arange(int((surface.nodes >= 0).sum()))
    beyond = facet >= len(surface)
    turns = np.stack([more.turns[k] for k in more.power[facet[beyond]].tolist()])
    kept = found.here < len(own)
    images = Images(number[more.source[facet[beyond]], local[beyond]], turns)
    return Smoothing(found.here[kept], found.other[kept], images=images)


def nodal_normals(surface: Surface, across: Smoothing | None = None) -> NDArray[np.float64]:
    """Continuous unit normals at the facets' nodes, (n_facets, 9, dim), zero where padded; theory (S1).

    At each node the area-weighted normals of the surface's own facets are averaged, leaving out facets that meet
    this one at more than 40 degrees (a crease), here or in the configuration of ``across``. Flat surfaces get the exact
    normal up to their edges. Raises InputError for a facet without a normal at one of its nodes.
    """
    across = across or smoothing(surface)
    areas = area_vectors(surface)
    facet, local = _visits(surface)
    total = _totals(areas[facet, local], across)
    result = np.zeros_like(areas)
    length = np.linalg.norm(total, axis=1, keepdims=True)
    check_normals(surface, areas, length)
    result[facet, local] = total / length
    return result


def _visits(surface: Surface) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Facet and local number of each visit."""
    facet, local = np.nonzero(surface.nodes >= 0)
    return facet, local


def _totals(vector: NDArray[np.float64], across: Smoothing) -> NDArray[np.float64]:
    total = np.zeros_like(vector)
    every = vector if across.images is None else across.images.with_images(vector)
    np.add.at(total, across.here, every[across.other])
    if across.planes is not None:
        visits = across.planes.visits
        total[visits] = np.einsum("vab,vb->va", across.planes.inside, total[visits])
    return total


def check_normals(surface: Surface, vectors: NDArray[np.float64], length: NDArray[np.float64]) -> None:
    """vectors: (n_facets, 9, dim) area vectors; length: (n_visits, 1) of what is to become a unit vector."""
    facet, local = _visits(surface)
    flat = np.flatnonzero(_flat(vectors, facet, length[:, 0]))
    if len(flat):
        raise InputError(
            f"surface '{surface.name}': facet {facet[flat[0]]} has no normal at its point "
            f"{surface.points[surface.nodes[facet[flat[0]], local[flat[0]]]].tolist()}: points of it coincide or lie on "
            "a line; give the cell distinct points (a prism instead of a collapsed hexahedron)"
        )


def without_normal(surface: Surface) -> NDArray[np.bool_]:
    """Which facets have no normal at one of their nodes, (n_facets,): such a surface can be a target, not a contactor."""
    vectors = area_vectors(surface)
    facet, local = _visits(surface)
    flat = _flat(vectors, facet, np.linalg.norm(vectors[facet, local], axis=1))
    return np.bincount(facet[flat], minlength=len(surface)) > 0


def _flat(vectors: NDArray[np.float64], facet: NDArray[np.int64], length: NDArray[np.float64]) -> NDArray[np.bool_]:
    return np.asarray(length <= FLAT * np.linalg.norm(vectors, axis=2).max(axis=1)[facet])


def mean_normals(surface: Surface) -> NDArray[np.float64]:
    """One unit normal a facet, the mean of those at its nodes, (n_facets, dim)."""
    normal = nodal_normals(surface).sum(axis=1)
    return np.asarray(normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300))


def turning_within(surface: Surface, normals: NDArray[np.float64]) -> NDArray[np.float64]:
    """About the angle by which each facet's normals (n_facets, 9, dim) turn, (n_facets,): twice the largest distance of
    those at its nodes from their mean. Padded normals are zero."""
    used = surface.nodes >= 0
    mean = normals.sum(axis=1) / used.sum(axis=1, keepdims=True)
    away = normals - mean[:, None]
    return 2.0 * np.sqrt(np.where(used, np.einsum("fna,fna->fn", away, away), 0.0).max(axis=1))


def is_plane(surface: Surface) -> bool:
    """Whether all nodes of a surface in 3D lie in one plane, to rounding."""
    first = surface.points[surface.nodes[0, :3]]
    normal = np.cross(first[1] - first[0], first[2] - first[0])
    used = surface.nodes >= 0
    height = (surface.points @ normal)[surface.nodes[used]]
    size = np.abs(surface.points).max() * np.linalg.norm(normal)
    return bool(np.ptp(height) <= PLANE * size)


def beside_others(surface: Surface) -> NDArray[np.bool_]:
    """Facets (n_facets,) that share a point with those of another part, with no crease between them."""
    result = np.zeros(len(surface), dtype=bool)
    if surface.parts is None:
        return result
    areas = area_vectors(surface)
    facet, local = np.nonzero(surface.nodes >= 0)
    unit = areas[facet, local] / np.maximum(np.linalg.norm(areas[facet, local], axis=1, keepdims=True), 1e-300)
    part = surface.parts[facet]
    for here, other in _without_crease(surface.nodes[facet, local].astype(np.int64), unit):
        result[facet[here[part[here] != part[other]]]] = True
    return result


def side_normals(surface: Surface) -> tuple[Surface, NDArray[np.float64]]:
    """The surface split at its creases, and the unit normals at its points, (n_points, dim), zero where no facet is."""
    split, _ = split_at_creases(surface)
    at = np.zeros_like(split.points)
    used = split.nodes >= 0
    at[split.nodes[used]] = nodal_normals(surface)[used]
    return split, at


def _without_crease(
    node: NDArray[np.int64], unit: NDArray[np.float64]
) -> Iterator[tuple[NDArray[np.int64], NDArray[np.int64]]]:
    """Pairs of facets' nodes at the same point with no crease between them; node: (n,) points, unit: (n, dim) normals."""
    order = np.argsort(node, kind="stable")
    counts = np.bincount(node)
    counts = counts[counts > 0]
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    # Every pair of visits to the same node, at a shift s within its group.
    size = np.repeat(counts, counts)
    position = np.arange(len(order)) - np.repeat(starts, counts)
    for shift in range(int(counts.max(initial=0))):
        has = shift < size
        here = order[has]
        other = order[(np.arange(len(order)) - position)[has] + (position[has] + shift) % size[has]]
        near = np.einsum("ij,ij->i", unit[here], unit[other]) > CREASE
        yield here[near], other[near]


def split_at_creases(surface: Surface) -> tuple[Surface, NDArray[np.int64]]:
    """The surface with its points doubled along creases and borders of its parts, one for each smooth side, and (n_points,)
    the point that each of its points was: theory (P13). Points keep their numbers, further ones come at the end."""
    if used_sides(surface) is None:
        return _split(surface)
    (result, owner), more = _split(replace(surface, turned=None)), extended(surface, 1)
    return replace(
        result, turned=sides_of_split(surface, more, _split(more.surface)[0].nodes, result.nodes, owner)
    ), owner


def _split(surface: Surface) -> tuple[Surface, NDArray[np.int64]]:
    """Of facets that are there, without what is beyond the sides of a sector."""
    areas = area_vectors(surface)
    facet, local = np.nonzero(surface.nodes >= 0)
    node = surface.nodes[facet, local].astype(np.int64)
    unit = areas[facet, local] / np.maximum(np.linalg.norm(areas[facet, local], axis=1, keepdims=True), 1e-300)
    pairs = list(_without_crease(node, unit))
    if surface.parts is not None:
        part = surface.parts[facet]
        pairs = [(here[same], other[same]) for here, other in pairs for same in (part[here] == part[other],)]
    links = np.concatenate([np.zeros((2, 0), dtype=np.int64), *(np.stack(pair) for pair in pairs)], axis=1)
    graph = sp.csr_matrix((np.ones(links.shape[1]), (links[0], links[1])), shape=(len(node), len(node)))
    _, side = connected_components(graph, directed=False)
    _, first, number = np.unique(side, return_index=True, return_inverse=True)
    at = node[first]  # point of each side
    by_point = np.argsort(at, kind="stable")
    further = np.zeros(len(at), dtype=bool)
    further[by_point[1:]] = at[by_point[1:]] == at[by_point[:-1]]
    owner = np.arange(len(surface.points))
    if not further.any():
        return surface, owner
    point = at.copy()
    point[further] = len(owner) + np.arange(int(further.sum()))
    nodes = surface.nodes.copy()
    nodes[facet, local] = point[number.ravel()]
    owner = np.concatenate([owner, at[further]])
    return replace(surface, points=surface.points[owner], nodes=nodes), owner


def pressure_kind(kind: str, degree: int) -> str:
    """The facet type whose shape functions carry a pressure of this degree (1: the corners', 2: the facet's own)."""
    return kind if degree == 2 else LINEAR_FACET.get(kind, kind)


def corner_functions(kind: str, degree: int) -> NDArray[np.float64]:
    """The corners' functions as combinations of those of a degree, 1 or 2: their values at its nodes, (nodes, corners)."""
    values, _ = shape_functions(CELLS[pressure_kind(kind, 1)].code, node_coordinates(pressure_kind(kind, degree)))
    return np.asarray(values)


def function_count(kind: str, degree: int) -> int:
    """Number of pressure functions on a facet."""
    return 1 if degree == 0 else CELLS[pressure_kind(kind, degree)].nodes


def facet_measure(
    surface: Surface, kind: str, facets: NDArray[np.int64], xi: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Facets of one type at reference points xi (q, dim of the facet): positions (facets, q, dim), metric of the reference
    coordinates (facets, q, a, a), and area per reference area (facets, q)."""
    shapes, slopes = shape_functions(CELLS[kind].code, np.ascontiguousarray(xi))
    x = _nodes(surface, kind, facets)
    at = shapes @ x
    n, (q, k, a) = len(x), slopes.shape
    # One matrix product: several times faster than einsum.
    tangents = (x.transpose(0, 2, 1).reshape(-1, k) @ slopes.transpose(1, 0, 2).reshape(k, -1)).reshape(n, -1, q, a)
    metric = np.empty((n, q, a, a))
    for i, j in np.ndindex(a, a):
        metric[..., i, j] = (tangents[..., i] * tangents[..., j]).sum(axis=1)
    return at, metric, np.sqrt(determinants(metric)) * surface.around(at)


def full_moments(surface: Surface, degree: int) -> NDArray[np.float64]:
    """int H_k over the whole of each facet, an area (2D: a length), (n_facets, 9), zero where padded."""
    moments = np.zeros((len(surface), MAX_FACET_NODES))
    for kind, facets in by_kind(surface):
        xi, weights = gauss_rule(kind, 6)
        _, _, area = facet_measure(surface, kind, facets, xi)
        if degree == 0:
            moments[facets, 0] = area @ weights
        else:
            cell = CELLS[pressure_kind(kind, degree)]
            values, _ = shape_functions(cell.code, np.ascontiguousarray(xi))
            moments[facets, : cell.nodes] = (area * weights) @ values
    return moments


def facet_products(surface: Surface, degree: int) -> NDArray[np.float64]:
    """int H_k H_l over the whole of each facet, (n_facets, 9, 9), for degree 1 or 2."""
    result = np.zeros((len(surface), MAX_FACET_NODES, MAX_FACET_NODES))
    for kind, facets in by_kind(surface):
        cell = CELLS[pressure_kind(kind, degree)]
        xi, weights = gauss_rule(kind, 6)
        _, _, area = facet_measure(surface, kind, facets, xi)
        values, _ = shape_functions(cell.code, np.ascontiguousarray(xi))
        block = np.einsum("fq,qk,ql->fkl", area * weights, values, values, optimize=True)
        result[facets[:, None, None], np.arange(cell.nodes)[:, None], np.arange(cell.nodes)] = block
    return result


def facet_stiffness(surface: Surface, degree: int) -> NDArray[np.float64]:
    """int grad H_k . grad H_l along the surface over the whole of each facet, (n_facets, 9, 9), for degree 1 or 2."""
    result = np.zeros((len(surface), MAX_FACET_NODES, MAX_FACET_NODES))
    for kind, facets in by_kind(surface):
        cell = CELLS[pressure_kind(kind, degree)]
        xi, weights = gauss_rule(kind, 3)
        _, metric, area = facet_measure(surface, kind, facets, xi)
        _, slopes = shape_functions(cell.code, np.ascontiguousarray(xi))
        block = np.einsum("fq,qka,fqab,qlb->fkl", area * weights, slopes, np.linalg.inv(metric), slopes, optimize=True)
        result[facets[:, None, None], np.arange(cell.nodes)[:, None], np.arange(cell.nodes)] = block
    return result
