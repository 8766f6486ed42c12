"""Faceting of curved surfaces: the error of linear facets, theory (L11)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS, MAX_FACET_NODES
from abut.contact.bulge import bulge_at, with_bulge
from abut.contact.coupling import GapSamples
from abut.contact.function_places import at_samples
from abut.contact.geometry import by_kind, nodal_normals
from abut.mesh.surface import Surface
from abut.model import Model
from abut.model.contact import GEOMETRIES
from abut.problem.constraints import Constraints
from abut.problem.pair import Pair

MIDDLE = 2.0 / 3.0  # weight of a segment's middle; its corners share the rest: exact for parabolas on lines and squares
HELD = 1e-9  # share of an axis held at a point below which it is free there
ROUND = 1e-9  # of the facet size: less roundness than that is none


@dataclass(frozen=True)
class Misfit:
    """The gap of the other geometry minus the pair's own, between smooth surfaces and between facets, a length: ``point``
    (n_sights,) where the contactor looks; ``node`` (n_points,) its mean under the pressure function that sits there, NaN
    where there is none."""

    point: NDArray[np.float64]
    node: NDArray[np.float64]


def misfit(pair: Pair) -> Misfit | None:
    """Of a pair, or None where both sides are flat or quadratic, or nothing is known of its gap samples."""
    at = pair.coupling.gap_samples
    if at is None or not len(at.gap):
        return None
    faceted = pair.contact.geometry == GEOMETRIES[1]
    own, other = (with_bulge(side) if faceted else side for side in (pair.contactor, pair.target))
    point = bulge_at(own, at.facet, at.contactor_shapes) + bulge_at(other, at.target_facet, at.target_shapes)
    point = -point if faceted else point
    if np.abs(point).max() <= ROUND * pair.size:
        return None
    moments = _moments(pair, at, point)
    space, node = pair.space, np.full(len(pair.contactor.points), np.nan)
    if space.continuous:
        seen = space.weight > 0.0
        node[space.node[seen]] = (space.transfer.T @ moments)[seen] / space.weight[seen]
    else:  # functions of single facets: the mean under the corner functions of all facets at a node stands for them
        facet, local = np.nonzero(pair.contactor.nodes >= 0)
        here, row = pair.contactor.nodes[facet, local], MAX_FACET_NODES * facet + (local if pair.coupling.degree else 0)
        weight = np.bincount(here, pair.coupling.weight[row], len(node))
        known = weight > 0.0
        node[known] = np.bincount(here, moments[row], len(node))[known] / weight[known]
    return Misfit(point, node)


def _moments(pair: Pair, at: GapSamples, value: NDArray[np.float64]) -> NDArray[np.float64]:
    """Integrals (9 n_facets,) of a value given at the gap samples with the facet-wise pressure functions; in 2D exact to
    the third order (Simpson's rule), in 3D an estimate."""
    contactor, degree = pair.contactor, pair.coupling.degree
    functions = at_samples(contactor, degree, at)
    area, middle, number = _segments(contactor, at)
    corners = np.bincount(number, minlength=len(middle)) - 1
    weight = (1.0 - MIDDLE) / np.maximum(corners, 1)[number]
    weight[middle] = np.where(corners > 0, MIDDLE, 1.0)
    row = (MAX_FACET_NODES * at.facet[:, None].astype(np.int64) + np.arange(MAX_FACET_NODES)).ravel()
    product = (area[number] * weight * value)[:, None] * functions
    return np.asarray(np.bincount(row, product.ravel(), MAX_FACET_NODES * len(contactor)), dtype=np.float64)


def unseen(pair: Pair, of: Misfit) -> NDArray[np.float64]:
    """The part of the misfit at the gap samples, (n_samples,), that no mean over a pressure function sees."""
    at = pair.coupling.gap_samples
    assert at is not None
    nodes = np.maximum(pair.contactor.nodes[at.facet], 0)
    mean = np.nan_to_num(of.node[nodes])
    return np.asarray(of.point - (at.contactor_shapes * mean).sum(axis=1))


def free_axes(model: Model, constraints: Constraints, pair: Pair) -> NDArray[np.bool_]:
    """Along which axes, (dim,), the body of one side at least may shift as a whole: no support holds it there."""
    free = np.zeros(model.dim, dtype=bool)
    for surface in (pair.contactor, pair.target):
        bodies = [body for body, cells in model.mesh.bodies.items() if np.isin(surface.cells, cells).any()]
        nodes = np.unique(np.concatenate([model.mesh.nodes_of(body) for body in bodies]))
        for a, axis in enumerate(np.eye(model.dim)):
            share = constraints.held_share(nodes, np.broadcast_to(axis, (len(nodes), model.dim)))
            free[a] |= bool((share < HELD).all())
    return free


def faceting(pair: Pair, nodal: NDArray[np.float64], closed: float, free: NDArray[np.bool_]) -> float:
    """Pressure that gaps between facets make instead of those between smooth surfaces, where it is carried: theory (L12), an
    estimate; none where gaps are those of the smooth surfaces.

    nodal: (n_facets, 9) pressure, of which what exceeds ``closed`` counts as contact; free: (dim,) axes along
    which a side may shift. What such a shift takes up is left out, and so is the rim, where normals are known from one
    side only, unless contact is nowhere else.
    """
    of = misfit(pair) if pair.contact.geometry == GEOMETRIES[1] else None
    if of is None or pair.compliance == 0.0:
        return 0.0
    surface, known = pair.contactor, np.isfinite(of.node)
    used = surface.nodes >= 0
    pressure = np.zeros(len(known))
    np.maximum.at(pressure, surface.nodes[used], nodal[used])
    loaded = known & (pressure > closed)
    inside = loaded & ~_near_rim(surface)
    loaded = inside if inside.any() else loaded
    if not loaded.any():
        return 0.0
    node = np.where(known, of.node - _shift(surface, of.node, loaded, free), 0.0)
    a, b = _edges(surface).T
    both = (loaded[a] & known[b]) | (loaded[b] & known[a])  # a node that kinks keep open is left out of contact by them
    step = np.abs(node[a] - node[b])[both] / np.linalg.norm(surface.points[a] - surface.points[b], axis=1)[both]
    extent = max(float(np.ptp(surface.points[loaded], axis=0).max()), pair.size)
    even = float(np.abs(node[loaded].mean())) / extent
    return max(float(step.max(initial=0.0)), even) / pair.compliance


def _shift(
    surface: Surface, value: NDArray[np.float64], known: NDArray[np.bool_], free: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """The part of nodal values (n_points,) that is the normal share of one shift along the free axes, by least squares."""
    used = surface.nodes >= 0
    normals = np.zeros_like(surface.points)
    normals[surface.nodes[used]] = nodal_normals(surface)[used]
    normals = normals[:, free]
    shift = np.linalg.lstsq(normals[known], value[known], rcond=1e-6)[0]
    return np.asarray(normals @ shift)


def _edges(surface: Surface) -> NDArray[np.int64]:
    """Both ends of every facet edge (2D: facet), (n, 2), those inside twice."""
    ends = []
    for kind, facets in by_kind(surface):
        corners = CELLS[kind].corners if CELLS[kind].dim == 2 else 2
        nodes = surface.nodes[facets]
        ends += [nodes[:, [i, (i + 1) % corners]] for i in range(corners if corners > 2 else 1)]
    return np.concatenate(ends).astype(np.int64)


def _rim(surface: Surface) -> NDArray[np.bool_]:
    """Points on the rim: ends of edges (2D: ends) that belong to one facet only."""
    edges = np.sort(_edges(surface), axis=1)
    if surface.dim == 2:
        edges = np.repeat(edges.reshape(-1, 1), 2, axis=1)
    single, count = np.unique(edges, axis=0, return_counts=True)
    rim = np.zeros(len(surface.points), dtype=bool)
    rim[single[count == 1]] = True
    return rim


def _near_rim(surface: Surface) -> NDArray[np.bool_]:
    """Points of facets that have a point on the rim."""
    rim = _rim(surface)
    near = surface.nodes[(rim[np.maximum(surface.nodes, 0)] & (surface.nodes >= 0)).any(axis=1)]
    rim[near[near >= 0]] = True
    return rim


def _segments(surface: Surface, at: GapSamples) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
    """Area of every segment, (n_segments,), the number of its sight in the middle, which comes first, and of every sight
    that of its segment, (n_sights,)."""
    new = np.ones(len(at.gap), dtype=bool)
    new[1:] = (at.facet[1:] != at.facet[:-1]) | (at.target_facet[1:] != at.target_facet[:-1])
    middle = np.flatnonzero(new)
    number = np.cumsum(new) - 1
    x = np.einsum("ka,kad->kd", at.contactor_shapes, surface.points[np.maximum(surface.nodes[at.facet], 0)])
    arm = x - x[middle[number]]
    if surface.dim == 2:
        area = np.linalg.norm(arm, axis=1)
    else:  # a fan of triangles round the middle; the last corner is followed by the first
        following = np.minimum(np.arange(len(x)) + 1, len(x) - 1)
        last = np.append(new[1:], True)
        following[last] = np.minimum(middle[number[last]] + 1, len(x) - 1)
        area = np.where(new, 0.0, 0.5 * np.linalg.norm(np.cross(arm, arm[following]), axis=1))
    if surface.axisymmetric:
        area = area * 2.0 * np.pi * x[:, 0]
    return np.asarray(np.bincount(number, area, len(middle)), dtype=np.float64), middle, number
