"""The smooth surface over flat facets: how far it bulges out over each chord, theory (S13), (S14), (S15), (S16)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.cells import CELLS, MAX_FACET_NODES
from abut.contact.geometry import area_vectors, by_kind, split_at_creases, straight
from abut.contact.mirror_images import RINGS, with_images
from abut.contact.turned_images import Extended, extended
from abut.mesh.surface import Surface
from abut.types import Sparse

COMPANION = {"line2": "line3", "tri3": "tri6", "quad4": "quad8"}  # of second order with the same corners
ROUNDING = 1e-9  # of an edge's length: lower bulges are rounding of the coordinates
ON_CHORD = 0.1  # of the bulge: middle nodes of a second order facet that lie lower stand on its chord
NO_SPREAD = 1e-8  # of the largest eigenvalue of a fit: facets side by side in a row say nothing across it
ENOUGH = 6  # neighbours of a point from which on they determine a surface of second order
TURNS = 4  # repetitions of the fit, of which each makes the error of steep slopes smaller by their square
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Held:
    """Directions (n, dim, unit) in which points (n,) of a mesh are held: planes of symmetry, where a surface continues as
    its mirror image."""

    points: NDArray[np.int64]
    directions: Array

    def at(self, points: NDArray[np.integer[Any]]) -> tuple[NDArray[np.int64], Array]:
        """All directions in which points (m,) are held: the number (k,) of each in ``points``, rising, and its direction
        (k, dim)."""
        order = np.argsort(self.points, kind="stable")
        first, last = (np.searchsorted(self.points[order], points, side) for side in ("left", "right"))
        count = last - first
        which = np.arange(int(count.sum())) + np.repeat(first - np.cumsum(count) + count, count)
        return np.repeat(np.arange(len(points)), count), self.directions[order[which]]

    def turned(self, more: Extended) -> Held:
        """With those of images beyond the sides of a sector."""
        beyond = np.flatnonzero(more.point_power != 0)
        number, directions = self.at(more.point[beyond])
        turned = more.turned(directions, more.point_power[beyond][number])
        return Held(np.concatenate([self.points, beyond[number]]), np.concatenate([self.directions, turned]))


def with_bulge(surface: Surface, held: Held | None = None) -> Surface:
    """The surface with its ``bulge``: None where it is flat everywhere."""
    if not len(surface):
        return surface
    if surface.turned is not None:
        more = extended(surface, RINGS)
        found = with_bulge(replace(more.surface, turned=None), None if held is None else held.turned(more)).bulge
        own = None if found is None else found[: len(surface)]
        return surface if own is None or not own.any() else replace(surface, bulge=own)
    split, owner = split_at_creases(surface)
    normals = _vertex_normals(split, owner, held)
    bulge = np.zeros((len(surface), MAX_FACET_NODES))
    for kind, facets in by_kind(surface):
        corners = CELLS[kind].corners
        for edge in range(1 if surface.dim == 2 else corners):
            a, b = (split.nodes[facets, (edge + i) % corners] for i in range(2))
            height = _sagitta(split.points[b] - split.points[a], normals[a], normals[b])
            if CELLS[kind].degree == 2:
                middle = split.points[split.nodes[facets, corners + edge]]
                height = _over_chord(
                    height, middle - 0.5 * (split.points[a] + split.points[b]), normals[a] + normals[b]
                )
            bulge[facets, corners + edge] = height
        if CELLS[kind].nodes == MAX_FACET_NODES:
            bulge[facets, 8] = 0.5 * bulge[facets, 4:8].sum(axis=1)
    return replace(surface, bulge=bulge) if bulge.any() else surface


def bulge_at(surface: Surface, facet: NDArray[np.integer[Any]], shapes: Array) -> Array:
    """How far the smooth surface lies outside of facets (n,) where their shape functions have the values (n, 9), (n,)."""
    result = np.zeros(len(facet))
    if surface.bulge is None:
        return result
    for kind, _ in by_kind(surface):
        at = np.flatnonzero(surface.kinds[facet] == CELLS[kind].code)
        n, height = shapes[at], surface.bulge[facet[at]]
        corners = CELLS[kind].corners
        functions = n[:, corners:] if CELLS[kind].degree == 2 else middle_functions(kind, n)
        result[at] = (functions * height[:, corners : corners + functions.shape[1]]).sum(axis=1)
    return result


def middle_functions(kind: str, shapes: Array) -> Array:
    """The functions (n, edges) of the middle nodes that a facet of first order lacks, theory (S13), where its own have the
    values ``shapes``, (n, 9)."""
    corners = CELLS[kind].corners
    if CELLS[kind].dim == 1:
        return 4.0 * shapes[:, :1] * shapes[:, 1:2]
    if corners == 3:
        return np.asarray(4.0 * shapes[:, :3] * shapes[:, [1, 2, 0]])
    along = shapes[:, :4] + shapes[:, [1, 2, 3, 0]]  # what is left of the way to the edge opposite
    return np.asarray(4.0 * along * along[:, [1, 2, 3, 0]] * along[:, [3, 0, 1, 2]])


def bulging(
    contactor: Surface, target: Surface, facet: NDArray[np.integer[Any]], other: NDArray[np.integer[Any]]
) -> NDArray[np.bool_]:
    """Facets (n_facets,) of the contactor that bulge or face a target's that does. facet, other: (n,) of contactor and
    target, pairs that face each other."""
    result = np.zeros(len(contactor), dtype=bool)
    if contactor.bulge is not None:
        result |= contactor.bulge.any(axis=1)
    if target.bulge is not None:
        there: NDArray[np.bool_] = np.asarray(target.bulge.any(axis=1))
        result[facet[there[other]]] = True
    return result


def at_reference(surface: Surface, kind: str, facets: NDArray[np.int64], xi: Array) -> Array:
    """The same on facets (n,) of one kind at reference points (n, dim of the facet)."""
    if surface.bulge is None:
        return np.zeros(len(facets))
    cell = CELLS[COMPANION.get(kind, kind)]
    values, _ = shape_functions(cell.code, np.ascontiguousarray(xi))
    middles = slice(cell.corners, cell.nodes)
    return np.asarray((values[:, middles] * surface.bulge[facets, middles]).sum(axis=1))


def _sagitta(edge: Array, normal: Array, other: Array) -> Array:
    """Height (n,) of arcs over their chords ``edge`` (n, dim) between unit normals at both ends: theory (S15). The harmonic
    mean of both slopes is that of an arc where they agree, and none where the surface bends at one end only, as the flat
    beside a fillet does."""
    length = np.maximum(np.linalg.norm(edge, axis=1), 1e-300)  # collapsed hexahedra have edges without length
    one, two = -(normal * edge).sum(axis=1) / length, (other * edge).sum(axis=1) / length
    both = one * two > 0.0
    slope = np.where(both, 2.0 * one * two / np.where(both, one + two, 1.0), 0.0)
    height = 0.5 * length * slope / (1.0 + np.sqrt(np.maximum(1.0 - slope**2, 0.0)))
    return np.where(np.abs(height) > ROUNDING * length, height, 0.0)


def _over_chord(height: Array, middle: Array, normal: Array) -> Array:
    """What is missing at middle nodes that lie at ``middle`` (n, dim) from those of the chords; nothing where the facet is
    curved itself."""
    there = (middle * normal).sum(axis=1) / np.linalg.norm(normal, axis=1)
    return np.where(np.abs(there) <= ON_CHORD * np.abs(height), height - there, 0.0)


def _vertex_normals(split: Surface, owner: NDArray[np.int64], held: Held | None) -> Array:
    """Unit normals (n_points, dim) of the smooth surface at the corners of a surface that is split at its creases, zero at
    other points: theory (S16). At planes of symmetry they are those of the surface with its mirror image."""
    plain = straight(split)
    normals = _normals(plain)
    if held is not None:
        rim = _rim_points(plain)
        at = _on_planes(normals, plain, owner[rim], rim, held)
        if len(at.points):
            normals = _normals(with_images(plain, at.points, at.directions))[: len(normals)]
            normals = _inside(normals, at)
    if plain.axisymmetric:
        on_axis = plain.points[:, 0] <= ROUNDING * np.abs(plain.points[:, 0]).max()
        normals[on_axis, 0] = 0.0
    return np.asarray(normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300))


def _normals(plain: Surface) -> Array:
    """Normals (n_points, dim), about unit, at the points of a surface of straight facets; zero where no facet is."""
    unit = area_vectors(plain).sum(axis=1)
    unit /= np.maximum(np.linalg.norm(unit, axis=1, keepdims=True), 1e-300)
    facet, local = np.nonzero(plain.nodes >= 0)
    shape = len(plain.points), len(plain)
    around = sp.csr_matrix((np.ones(len(facet)), (plain.nodes[facet, local], facet)), shape=shape)
    rim, neighbours = _rim_points(plain), np.diff((around @ around.T).tocsr().indptr) - 1
    few = np.zeros(len(plain.points), dtype=bool)
    few[rim] = True
    few |= (neighbours < ENOUGH) & (plain.dim == 3)
    keep = sp.diags((~few).astype(float))
    ring = (keep @ around + sp.diags(few.astype(float)) @ (around @ (around.T @ around))).tocsr()
    ring.eliminate_zeros()
    ring.sum_duplicates()
    mean = np.asarray(ring.sign() @ unit)
    mean /= np.maximum(np.linalg.norm(mean, axis=1, keepdims=True), 1e-300)
    bent = _bent(ring, unit, mean)
    normals = mean.copy()
    if len(bent):
        normals[bent] = _fitted(plain, bent, ring[bent], mean[bent])
        at, flat = _beside_flats(plain, bent, unit)
        normals[at] = unit[flat]
    return normals


def _beside_flats(plain: Surface, bent: NDArray[np.int64], unit: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Points (n,) where a flat goes over into a curved part, as into a fillet, and a facet (n,) of the flat at each. bent:
    points around which facets are not in one plane; unit: (n_facets, dim) normals.

    There the normal is the flat's; the fit (S16), which turns evenly across, has one between both. A facet of a flat has a
    corner that is not bent. One with all its corners beside flats may be a chamfer: nothing tells that it is curved."""
    facet, local = np.nonzero(plain.nodes >= 0)
    point, count = plain.nodes[facet, local].astype(np.int64), len(plain.points)
    is_bent = np.zeros(count, dtype=bool)
    is_bent[bent] = True
    flat = np.zeros(len(plain), dtype=bool)
    flat[facet[~is_bent[point]]] = True
    of = np.full(count, -1)
    here = flat[facet] & is_bent[point]
    of[point[here]] = facet[here]
    other = np.zeros(count, dtype=bool)  # beside flats in several planes
    other[point[here]] |= (np.abs(unit[facet[here]] - unit[of[point[here]]]) > ROUNDING).any(axis=1)
    curved = np.zeros(len(plain), dtype=bool)
    curved[facet[is_bent[point] & (of[point] < 0)]] = True
    chamfer = np.zeros(count, dtype=bool)
    chamfer[point[~flat[facet] & ~curved[facet]]] = True
    at = np.flatnonzero((of >= 0) & ~other & ~chamfer)
    return at, of[at]


def _rim_points(plain: Surface) -> NDArray[np.int64]:
    """Corners at which a surface ends (or was split)."""
    if plain.dim == 2:
        ids, count = np.unique(plain.nodes[plain.nodes >= 0], return_counts=True)
        return ids[count == 1].astype(np.int64)
    pairs = []
    for kind, facets in by_kind(plain):
        n = CELLS[kind].corners
        nodes = plain.nodes[facets, :n].astype(np.int64)
        pairs.append(np.sort(np.stack([nodes, np.roll(nodes, -1, axis=1)], axis=-1), axis=-1).reshape(-1, 2))
    edges, count = np.unique(np.concatenate(pairs), axis=0, return_counts=True)
    return np.unique(edges[count == 1])


def _bent(ring: Sparse, unit: Array, mean: Array) -> NDArray[np.int64]:
    """Points around which facets do not lie in one plane."""
    row = np.repeat(np.arange(ring.shape[0]), np.diff(ring.indptr))
    turned = (np.abs(unit[ring.indices] - mean[row]) > ROUNDING).any(axis=1)
    return np.unique(row[turned])


def _fitted(plain: Surface, points: NDArray[np.int64], ring: Sparse, mean: Array) -> NDArray[np.float64]:
    """Normals (n, dim) at points (n,) of a surface of straight facets, which in the plane square to the ``mean`` (n, dim) of
    those around turn linearly, so that in the middles of the edges around they are square to these. ring: (n, n_facets)
    which facets lie around."""
    n, dim = mean.shape
    at, x = ring.tocoo(), plain.points[points]
    frame = _tangents(mean)
    far = ((x[at.row] - _middles(plain)[at.col]) ** 2).sum(axis=1)
    size = np.maximum(np.sqrt(np.bincount(at.row, far, n) / np.bincount(at.row, minlength=n)), 1e-300)
    row, along, place, up = _edges_around(plain, at, x, frame, mean, size)
    close = 1.0 / np.maximum((place**2).sum(axis=1), 1e-12)
    terms = [along, along * place] if dim == 2 else [
        along, along * place, (along[:, 0] * place[:, 1] + along[:, 1] * place[:, 0])[:, None]
    ]  # fmt: skip
    design = np.hstack(terms)
    m = design.shape[1]
    gather = sp.csr_matrix((close, (row, np.arange(len(row)))), shape=(n, len(row)))
    products = gather @ (design[:, :, None] * design[:, None, :]).reshape(len(row), m * m)
    inverse = np.linalg.pinv(products.reshape(n, m, m), rcond=NO_SPREAD, hermitian=True)
    fit = np.zeros((n, m))
    for _ in range(TURNS):
        slope = _slopes(fit[row], place)
        upright = np.sqrt(np.maximum(1.0 - (slope**2).sum(axis=1), 0.0))
        fit = np.einsum("nab,nb->na", inverse, gather @ (design * (up * upright)[:, None]))
    lean = fit[:, : dim - 1]
    upright = np.sqrt(np.maximum(1.0 - (lean**2).sum(axis=1), 0.0))
    return np.asarray(upright[:, None] * mean - np.einsum("na,nad->nd", lean, frame))


def _slopes(fit: Array, place: Array) -> Array:
    """g + H x of coefficients (n, m) at places (n, dim - 1)."""
    if place.shape[1] == 1:
        return fit[:, :1] + fit[:, 1:] * place
    return fit[:, :2] + fit[:, 2:4] * place + fit[:, 4:] * place[:, ::-1]


def _edges_around(
    plain: Surface, at: Sparse, points: Array, frame: Array, mean: Array, size: Array
) -> tuple[NDArray[np.int64], Array, Array, Array]:
    """The edges of the facets around each of the points (n, dim): its number, and in its frame (dim - 1 tangents, normal)
    the edge's unit vector along the tangents, its middle over ``size``, and the unit vector's rise along the normal."""
    rows, ends = [], []
    for kind, facets in by_kind(plain):
        pick = np.isin(at.col, facets)
        corners = CELLS[kind].corners
        nodes = plain.nodes[at.col[pick], :corners].astype(np.int64)
        for edge in range(1 if plain.dim == 2 else corners):
            rows.append(at.row[pick].astype(np.int64))
            ends.append(nodes[:, [edge, (edge + 1) % corners]])
    row, x = np.concatenate(rows), plain.points[np.concatenate(ends)]
    step, middle = x[:, 1] - x[:, 0], 0.5 * (x[:, 0] + x[:, 1]) - points[row]
    step = step / np.maximum(np.linalg.norm(step, axis=1, keepdims=True), 1e-300)
    along, place = (np.einsum("nad,nd->na", frame[row], v) for v in (step, middle))
    return row, along, place / size[row, None], (mean[row] * step).sum(axis=1)


def _tangents(normal: Array) -> NDArray[np.float64]:
    """Unit vectors (n, dim - 1, dim) square to unit vectors (n, dim)."""
    if normal.shape[1] == 2:
        return np.stack([normal[:, 1], -normal[:, 0]], axis=1)[:, None]
    axis = np.eye(3)[np.abs(normal).argmin(axis=1)]
    one = np.cross(axis, normal)
    one /= np.maximum(np.linalg.norm(one, axis=1, keepdims=True), 1e-300)
    return np.stack([one, np.cross(normal, one)], axis=1)


def _middles(plain: Surface) -> NDArray[np.float64]:
    """Means of the facets' corners, (n_facets, dim)."""
    used = plain.nodes >= 0
    return np.asarray(
        (plain.points[np.maximum(plain.nodes, 0)] * used[..., None]).sum(axis=1) / used.sum(axis=1)[:, None]
    )


def _on_planes(normals: Array, plain: Surface, points: NDArray[np.int64], rim: NDArray[np.int64], held: Held) -> Held:
    """Where a surface that is curved ends at planes of symmetry: normals lean out of these by less than facets turn. rim:
    (m,) where it ends, as points of the split surface; points: (m,) the same of the mesh. Points of the result are of the
    split surface."""
    turn = np.zeros(len(normals))
    unit = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    used = plain.nodes >= 0
    at = unit[np.maximum(plain.nodes, 0)]
    mean = (at * used[..., None]).sum(axis=1) / used.sum(axis=1)[:, None]
    far = np.where(used, np.linalg.norm(at - mean[:, None], axis=2), 0.0).max(axis=1)
    np.maximum.at(turn, plain.nodes[used], np.broadcast_to(far[:, None], used.shape)[used])
    number, directions = held.at(points)
    here = rim[number]
    leans = np.abs(np.einsum("na,na->n", unit[here], directions)) <= turn[here]
    leans &= turn[here] > ROUNDING
    leans[leans] = ~_goes_on(plain, here[leans], directions[leans])
    return Held(here[leans], directions[leans])


def _goes_on(plain: Surface, points: NDArray[np.int64], directions: Array) -> NDArray[np.bool_]:
    """Whether facets at points (n,) lie on both sides of planes through them with normals (n, dim), as of a body that is
    held in its middle: it has no image there."""
    used = plain.nodes >= 0
    facet, local = np.nonzero(used)
    has = sp.csr_matrix((np.ones(len(facet)), (plain.nodes[facet, local], facet)), (len(plain.points), len(plain)))
    around = (has[points] @ has.T).tocoo()
    level = ((plain.points[around.col] - plain.points[points[around.row]]) * directions[around.row]).sum(axis=1)
    far = np.zeros(len(points))
    np.maximum.at(far, around.row, np.abs(level))
    beyond = [np.zeros(len(points), dtype=bool) for _ in range(2)]
    for side, sign in zip(beyond, (1.0, -1.0)):
        side[around.row[sign * level > ROUNDING * far[around.row]]] = True
    return np.asarray(beyond[0] & beyond[1])


def _inside(normals: Array, at: Held) -> Array:
    """Normals that lie in the planes to rounding, exactly there."""
    result, order = normals.copy(), np.argsort(at.points, kind="stable")
    points, directions = at.points[order], at.directions[order]
    rank = np.arange(len(points)) - np.searchsorted(points, points)
    for _ in range(2):  # planes that are not square to each other
        for k in range(int(rank.max(initial=-1)) + 1):
            here, direction = points[rank == k], directions[rank == k]
            result[here] -= np.einsum("na,na->n", result[here], direction)[:, None] * direction
    return result
