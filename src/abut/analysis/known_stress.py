"""What is known of the stress at the surfaces of bodies at the end of a step: tractions of contacts, loads and free
surfaces, and planes that continue bodies as their mirror image; theory (Z3), (Z4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.analysis.strain_gauges import gauges
from abut.bodies.recovery import Equations
from abut.bodies.stress import PointStress
from abut.cells import MAX_FACET_NODES
from abut.contact.geometry import area_vectors, full_moments, split_at_creases
from abut.contact.nodal_recovery import carry_to_target
from abut.fields import evaluate
from abut.mesh.patches import Patches
from abut.mesh.surface import Surface
from abut.model import Force, Load, Model, NodalForce, Pressure, Traction
from abut.model.conditions import COMPONENTS, Support, weights
from abut.problem.contact_pairs import Pair
from abut.solution import ContactResult

ALONG = 1e-6  # sine of the angle between a facet's normal and an axis up to which it is along it
ACROSS = 0.7  # of a surface that meets a plane at more than 45 degrees: the plane's own facets are not meant
TABLE = {2: ((0, 3), (3, 1)), 3: ((0, 3, 5), (3, 1, 4), (5, 4, 2))}  # components of a tensor's rows

Vector = NDArray[np.float64]


@dataclass
class _Skin:
    """The facets that bodies end with. surface: now; pressure (n, 9), traction (n, 9, dim) at their nodes, force per area;
    source: (n,) equal for facets with equal sources of these; unknown: (n, dim) components of the traction that are not
    known; mirrored: (n, dim) whether a facet lies in a plane across an axis that continues the body."""

    surface: Surface
    pressure: Vector
    traction: Vector
    source: NDArray[np.int64]
    unknown: NDArray[np.bool_]
    mirrored: NDArray[np.bool_]

    @classmethod
    def of(cls, model: Model, points: Vector) -> _Skin:
        of = model.deformable.patches
        surface = replace(model.mesh.facets(of.outside[of.free]), points=points)
        n, dim = len(surface), model.dim
        return cls(
            surface, np.zeros((n, MAX_FACET_NODES)), np.zeros((n, MAX_FACET_NODES, dim)), np.zeros(n, dtype=np.int64),
            np.zeros((n, dim), dtype=bool), np.zeros((n, dim), dtype=bool),
        )  # fmt: skip

    def find(self, facets: Surface) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Which of some facets are here, and where."""
        own, other = (8 * s.cells + s.local for s in (self.surface, facets))
        order = np.argsort(own)
        at = np.minimum(np.searchsorted(own[order], other), len(own) - 1)
        found = np.flatnonzero(own[order][at] == other)
        return found, order[at[found]]

    def touching(self, points: NDArray[np.bool_], every: bool) -> NDArray[np.bool_]:
        """Facets of which every node, or any, is among some points of the mesh."""
        nodes = self.surface.nodes
        hit = points[np.maximum(nodes, 0)]
        return np.asarray((hit | (nodes < 0)).all(axis=1) if every else (hit & (nodes >= 0)).any(axis=1))


def known_stress(
    model: Model,
    points: Vector,
    time: float,
    pairs: Sequence[Pair],
    contacts: Sequence[ContactResult],
    sampled: PointStress,
) -> Equations:
    """Equations for the stress at the end of a step. points: (n_points, dim) where they are now; contacts: results of the
    pairs; sampled: the stresses of the cells."""
    skin = _Skin.of(model, points)
    factors = dict(zip(model.histories, weights(model.histories, time)))
    for load in model.loads:
        _add_load(model, skin, load, factors[load.amplitude])
    for pair, contact in zip(pairs, contacts):
        _add_contact(skin, pair, contact)
    _add_supports(model, skin)
    return _with_gauges(model, skin, _equations(model, skin), sampled)


def _add_load(model: Model, skin: _Skin, load: Load, factor: float) -> None:
    mesh = model.mesh
    if isinstance(load, NodalForce):
        skin.unknown[skin.touching(_marked(model, mesh.nodes_of(load.on)), False)] = True
    if not isinstance(load, (Pressure, Traction, Force)) or load.on not in mesh.surfaces:
        return
    surface = mesh.surface(load.on)
    found, at = skin.find(surface)
    skin.source[at] = 31 * skin.source[at] + 1 + model.loads.index(load)
    dead = model.finite and not (isinstance(load, Pressure) and load.follows)
    before, now = area_vectors(surface)[found], area_vectors(replace(surface, points=skin.surface.points))[found]
    sizes = [np.linalg.norm(area, axis=2) for area in (before, now)]
    shrunk = (
        sizes[0] / np.maximum(sizes[1], 1e-300) if dead else np.ones(sizes[0].shape)
    )  # forces are by undeformed area
    x = mesh.points[np.maximum(surface.nodes[found], 0)]
    where = x.reshape(-1, model.dim)
    if isinstance(load, Pressure):
        values = factor * evaluate(load.value, where, f"pressure on '{load.on}': value").reshape(x.shape[:2])
        if not dead:
            skin.pressure[at] += values
            return
        traction = -values[..., None] * before / np.maximum(np.linalg.norm(before, axis=2, keepdims=True), 1e-300)
    elif isinstance(load, Force):
        traction = np.broadcast_to(factor * np.array(load.value) / full_moments(surface, 0).sum(), x.shape)
    else:
        given = load.value(where) if callable(load.value) else np.broadcast_to(load.value, where.shape)
        traction = factor * np.asarray(given, dtype=float).reshape(x.shape)
    skin.traction[at] += traction * shrunk[..., None]


def _add_contact(skin: _Skin, pair: Pair, contact: ContactResult) -> None:
    for side, sign in ((pair.contactor, 1.0), (pair.target, -1.0)):
        found, at = skin.find(side)
        skin.source[at] = 31 * skin.source[at] + 1009 + sum(map(ord, pair.contact.name)) % 997
        if pair.tied:
            skin.unknown[at] = True
            continue
        skin.pressure[at] += np.nan_to_num((contact.pressure if sign > 0.0 else contact.target_pressure)[found])
        if contact.friction is not None:
            traction = np.nan_to_num(contact.friction.traction)
            if sign < 0.0:
                traction = np.stack([_carried(pair, component) for component in np.moveaxis(traction, 2, 0)], axis=2)
            skin.traction[at] += sign * traction[found]


def _carried(pair: Pair, values: Vector) -> Vector:
    """Values (n_facets, 9) at the nodes of the contactor's facets at those of the target's."""
    return np.nan_to_num(carry_to_target(pair.contactor, pair.target, pair.coupling.target_part, values))


def _add_supports(model: Model, skin: _Skin) -> None:
    mesh, dim = model.mesh, model.dim
    held = np.zeros((len(mesh.points), dim), dtype=bool)
    moved = np.zeros(len(mesh.points), dtype=bool)  # not all alike
    for support in model.supports:
        nodes = mesh.nodes_of(support.on)
        for axis, value in _axes(model, support):
            held[nodes, axis] = True
            moved[nodes] |= callable(value)
    for on in (*(c.on for c in model.couplings), *(r.on for r in model.rotations)):
        held[mesh.nodes_of(on)] = True
    for equation in model.equations:
        for term in equation.terms:
            at = mesh.nodes_of(term.on) if isinstance(term.on, str) else np.array([int(term.on)])
            skin.unknown[skin.touching(_marked(model, at), False)] = True
    for places, every in (([s for p in model.preloads for s in p.sides], True), ([s.on for s in model.springs], False)):
        for on in places:  # what sections and springs exert is not known point by point
            skin.unknown[skin.touching(_marked(model, mesh.nodes_of(on)), every)] = True
    normal = area_vectors(skin.surface)[:, 0]
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    whole = np.stack([skin.touching(held[:, axis], True) for axis in range(dim)], axis=1)
    skin.unknown |= whole
    alone = (whole.sum(axis=1) == 1) & ~skin.touching(moved, False) & (skin.source == 0)
    for axis in range(dim):
        along = np.abs(np.delete(normal, axis, axis=1)).max(axis=1) < ALONG
        skin.mirrored[:, axis] = alone & whole[:, axis] & along
    if mesh.axisymmetric:
        radius = np.abs(mesh.points[:, 0])
        axis_nodes = radius <= 1e-9 * radius.max(initial=0.0)
        on_axis = skin.touching(axis_nodes, True)
        skin.unknown[on_axis], skin.mirrored[on_axis, 0] = True, True


def _axes(model: Model, support: Support) -> list[tuple[int, object]]:
    """Components that a support holds, and the values; all where they lie along its surface's normals or local axes."""
    if support.normal is not None or support.axes is not None:
        return [(axis, lambda x: x) for axis in range(model.dim)]
    given = [(axis, getattr(support, name)) for axis, name in enumerate(COMPONENTS[: model.dim])]
    return [(axis, value) for axis, value in given if value is not None]


def _marked(model: Model, nodes: NDArray[np.int64]) -> NDArray[np.bool_]:
    marked = np.zeros(len(model.mesh.points), dtype=bool)
    marked[nodes] = True
    return marked


def _equations(model: Model, skin: _Skin) -> Equations:
    of, dim, surface = model.deformable.patches, model.dim, skin.surface
    body = model.deformable.body_of[surface.cells]
    _, part = np.unique(np.column_stack([body, skin.source, skin.unknown]), axis=0, return_inverse=True)
    split, owner = split_at_creases(surface)
    facet, local = np.nonzero(surface.nodes >= 0)
    smooth = split.nodes[facet, local].astype(np.int64)
    area = np.zeros((len(split.points), dim))
    np.add.at(area, smooth, area_vectors(surface)[facet, local])
    for axis in range(dim):  # a curved surface that goes on beyond a plane has its normal in the plane
        nodes = surface.nodes[skin.mirrored[:, axis]]
        there = _marked(model, nodes[nodes >= 0].astype(np.int64))[owner] & (
            np.abs(area[:, axis]) < ACROSS * np.linalg.norm(area, axis=1)
        )
        area[there, axis] = 0.0
    normal = area / np.maximum(np.linalg.norm(area, axis=1, keepdims=True), 1e-300)
    keys, point = np.unique(smooth * (int(part.max(initial=0)) + 1) + part.ravel()[facet], return_inverse=True)
    n, point = len(keys), point.ravel()
    one = np.zeros(n, dtype=np.int64)
    one[point] = np.arange(len(point))  # a visit of each
    normal, x = normal[smooth[one]], surface.points[owner[smooth[one]]]
    count = np.bincount(point, minlength=n)
    t = np.stack(
        [np.bincount(point, skin.traction[facet, local, a], n) / count for a in range(dim)], axis=1
    ) - (np.bincount(point, skin.pressure[facet, local], n) / count)[:, None] * normal  # fmt: skip
    known = ~skin.unknown[facet[one]] & normal.any(axis=1)[:, None]
    visits = sp.csr_matrix((np.ones(len(facet)), (facet, point)), shape=(len(surface), n))
    around = (of.skin[:, of.free] @ visits).tocsr()
    parts = [(np.flatnonzero(known[:, a]), a) for a in range(dim)]
    coefficients = []
    for rows, a in parts:
        own = np.zeros((len(rows), 4 if dim == 2 else 6))
        for b in range(dim):
            own[:, TABLE[dim][a][b]] = normal[rows, b]
        coefficients.append(own)
    planes, bare = _planes(of, skin)
    return Equations(
        np.concatenate([x[rows] for rows, _ in parts]), np.concatenate(coefficients),
        np.concatenate([t[rows, a] for rows, a in parts]), sp.hstack([around[:, rows] for rows, _ in parts]).tocsr(),
        planes, np.eye(dim), bare,
    )  # fmt: skip


def _with_gauges(model: Model, skin: _Skin, known: Equations, sampled: PointStress) -> Equations:
    """What strains along the surface tell beside, where the whole traction is known."""
    used = skin.surface.nodes >= 0
    area = area_vectors(skin.surface)
    normal = area / np.maximum(np.linalg.norm(area, axis=2, keepdims=True), 1e-300)
    nodal = np.where(used[..., None], skin.traction - skin.pressure[..., None] * normal, 0.0)
    traction = nodal.sum(axis=1) / used.sum(axis=1, keepdims=True)
    whole = np.asarray(~(skin.unknown | skin.mirrored).any(axis=1))
    found = gauges(model.deformable, skin.surface, sampled, whole, traction)
    of = model.deformable.patches
    return replace(
        known, x=np.concatenate([known.x, found.x]), coefficients=np.concatenate([known.coefficients, found.coefficients]),
        value=np.concatenate([known.value, found.value]),
        of=sp.hstack([known.of, of.skin[:, np.flatnonzero(of.free)[found.facet]]]).tocsr(),
    )  # fmt: skip


def _planes(of: Patches, skin: _Skin) -> tuple[NDArray[np.int32], NDArray[np.bool_]]:
    """Planes that mirror each patch, and which patches end elsewhere too."""
    planes = np.full((len(of.corner), 3), -1, dtype=np.int32)
    for axis in range(skin.mirrored.shape[1]):
        planes[np.asarray(of.skin[:, of.free] @ skin.mirrored[:, axis]).ravel() > 0, axis] = axis
    ends = np.ones(len(of.outside), dtype=bool)
    ends[np.flatnonzero(of.free)] = ~skin.mirrored.any(axis=1)
    return planes, np.asarray(of.skin @ ends).ravel() > 0
