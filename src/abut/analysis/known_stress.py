"""What is known of the stress at the surfaces of bodies at the end of a step: tractions of contacts, loads and free
surfaces, and planes that continue bodies as their mirror image; theory (Z3), (Z4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.analysis.surface_slopes import SurfacePoints, surface_stress
from abut.bodies.bearing import bearing_direction, bearing_pressure
from abut.bodies.mirror import mirrors
from abut.bodies.patch_fits import Equations, no_equations
from abut.bodies.solids import TemperatureChange
from abut.cells import MAX_FACET_NODES
from abut.contact.geometry import area_vectors, full_moments, split_at_creases
from abut.contact.nodal_recovery import carry_to_target
from abut.fields import evaluate
from abut.mesh.patches import Patches
from abut.mesh.surface import Surface
from abut.model import Force, Load, Model, NodalForce, Pressure, Traction
from abut.model.conditions import COMPONENTS, Support, weights
from abut.model.mirror_planes import at_ends
from abut.problem.pair import Pair
from abut.solution import ContactResult
from abut.types import Sparse

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
    displacement: Vector,
    time: float,
    temperature: TemperatureChange,
    contacts: Sequence[tuple[Pair, ContactResult]],
) -> Equations:
    """Equations for the stress at the end of a step. points: (n_points, dim) where they are now; displacement: (n_points,
    dim). Of models with bodies that come back planes of symmetry alone: their strains are not those of displacements."""
    if model.removals:
        return mirrored(model, points, time, [pair for pair, _ in contacts])
    skin = _loaded(model, points, time)
    for pair, contact in contacts:
        _add_contact(skin, pair, contact)
    _add_supports(model, skin)
    pieces = _Pieces.of(model, skin)
    whole = np.flatnonzero(_alone(model, pieces))
    still = replace(skin.surface, points=model.mesh.points)
    at = SurfacePoints(
        pieces.node[whole], pieces.visits[:, whole].T.tocsr(), pieces.still[whole], pieces.mirrored[whole],
        pieces.traction[whole],
    )  # fmt: skip
    stress, found = surface_stress(model.deformable, still, displacement, temperature, at)
    return _equations(model, skin, pieces, whole[found], stress[found])


def mirrored(model: Model, points: Vector, time: float, pairs: Sequence[Pair]) -> Equations:
    """The same without equations: planes of symmetry alone."""
    skin, of = _loaded(model, points, time), model.deformable.patches
    for side in (side for pair in pairs for side in (pair.contactor, pair.target)):
        skin.source[skin.find(side)[1]] = 1
    _add_supports(model, skin)
    planes, bare = _planes(of, skin)
    return replace(no_equations(of, model.dim), planes=planes, normals=np.eye(model.dim), bare=bare)


def _loaded(model: Model, points: Vector, time: float) -> _Skin:
    skin = _Skin.of(model, points)
    factors = dict(zip(model.histories, weights(model.histories, time)))
    for load in model.loads:
        _add_load(model, skin, load, factors[load.amplitude])
    return skin


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
    elif isinstance(load, Force) and load.bearing:
        normals = before / np.maximum(np.linalg.norm(before, axis=2, keepdims=True), 1e-300)
        direction = bearing_direction(surface, np.array(load.value), at_ends(model, surface), f"force on '{load.on}'")
        traction = -factor * bearing_pressure(normals, direction)[..., None] * normals
    elif isinstance(load, Force):
        traction = np.broadcast_to(factor * np.array(load.value) / full_moments(surface, 0).sum(), x.shape)
    else:
        given = load.along(where) if callable(load.along) else np.broadcast_to(load.along, where.shape)
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
    for nodes in (*(c.nodes(mesh) for c in model.couplings), *(mesh.nodes_of(r.on) for r in model.rotations)):
        held[nodes] = True
    linked = np.zeros(len(mesh.points), dtype=bool)
    for term in (term for equation in model.equations for term in equation.terms):
        linked[mesh.nodes_of(term.on) if isinstance(term.on, str) else int(term.on)] = True
    skin.unknown[skin.touching(linked, False)] = True
    for places, every in (([s for p in model.preloads for s in p.sides], True), ([s.on for s in model.springs], False)):
        for on in places:  # what sections and springs exert is not known point by point
            skin.unknown[skin.touching(_marked(model, mesh.nodes_of(on)), every)] = True
    for item in model.penetrations:  # nor where a fluid is
        for side in model.sides(next(contact for contact in model.contacts if contact.name == item.contact)):
            skin.unknown[skin.touching(_marked(model, side.node_ids), True)] = True
    normal = area_vectors(skin.surface)[:, 0]
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    whole = np.stack([skin.touching(held[:, axis], True) for axis in range(dim)], axis=1)
    skin.unknown |= whole
    alone = (whole.sum(axis=1) == 1) & ~skin.touching(moved, False) & (skin.source == 0)
    for axis in range(dim):
        along = np.abs(np.delete(normal, axis, axis=1)).max(axis=1) < ALONG
        flat = np.flatnonzero(alone & whole[:, axis] & along)
        cells, middle = skin.surface.cells[flat], mesh.points[skin.surface.nodes[flat, 0]]
        across = np.broadcast_to(np.eye(dim)[axis], middle.shape)
        skin.mirrored[flat, axis] = mirrors(model.deformable, cells, middle, across)
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


@dataclass(frozen=True)
class _Pieces:
    """The points of smooth pieces of the outside on which tractions come from the same sources. node: (n,) of the mesh; x,
    normal, traction: (n, dim) now, per current area; still: (n, dim) normal of undeformed bodies; known: (n, dim)
    components of the traction; mirrored: (n, dim) whether a plane across an axis continues the body there; visits:
    (n_facets, n) CSR, nonzero where a facet of the piece has the point; plane: (n,) whether the piece is such a plane."""

    node: NDArray[np.int64]
    x: Vector
    normal: Vector
    still: Vector
    traction: Vector
    known: NDArray[np.bool_]
    mirrored: NDArray[np.bool_]
    visits: Sparse
    plane: NDArray[np.bool_]

    @classmethod
    def of(cls, model: Model, skin: _Skin) -> _Pieces:
        dim, surface = model.dim, skin.surface
        body = model.deformable.body_of[surface.cells]
        _, part = np.unique(np.column_stack([body, skin.source, skin.unknown]), axis=0, return_inverse=True)
        split, owner = split_at_creases(surface)
        facet, local = np.nonzero(surface.nodes >= 0)
        smooth = split.nodes[facet, local].astype(np.int64)
        ends = np.stack(
            [
                _marked(model, nodes[nodes >= 0].astype(np.int64))
                for nodes in map(surface.nodes.__getitem__, skin.mirrored.T)
            ],
            axis=1,
        )
        keys, point = np.unique(smooth * (int(part.max(initial=0)) + 1) + part.ravel()[facet], return_inverse=True)
        n, point = len(keys), point.ravel()
        one = np.zeros(n, dtype=np.int64)
        one[point] = np.arange(len(point))  # a visit of each
        smooth, node = smooth[one], owner[smooth[one]]
        count = np.bincount(point, minlength=n)
        now, still = (
            _normals(replace(surface, points=points), split.nodes, ends[owner])[smooth]
            for points in (surface.points, model.mesh.points)
        )
        pressure = np.bincount(point, skin.pressure[facet, local], n) / count
        along = [np.bincount(point, skin.traction[facet, local, a], n) / count for a in range(dim)]
        return cls(
            node, surface.points[node], now, still, np.stack(along, axis=1) - pressure[:, None] * now,
            np.asarray(~skin.unknown[facet[one]] & now.any(axis=1, keepdims=True)), ends[node],
            sp.csr_matrix((np.ones(len(facet)), (facet, point)), shape=(len(surface), n)),
            np.asarray(skin.mirrored[facet[one]].any(axis=1)),
        )  # fmt: skip


def _normals(surface: Surface, split: NDArray[np.int32], ends: NDArray[np.bool_]) -> Vector:
    """Mean normals (n, dim) at points of smooth sides; split: these points at the facets' nodes; ends: (n, dim) which lie on
    planes: a curved surface that goes on beyond one has its normal in the plane."""
    facet, local = np.nonzero(split >= 0)
    area = np.zeros(ends.shape)
    np.add.at(area, split[facet, local], area_vectors(surface)[facet, local])
    steep = np.abs(area) >= ACROSS * np.linalg.norm(area, axis=1, keepdims=True)
    area[ends & ~steep] = 0.0
    return np.asarray(area / np.maximum(np.linalg.norm(area, axis=1, keepdims=True), 1e-300))


def _alone(model: Model, pieces: _Pieces) -> NDArray[np.bool_]:
    """At which points (n,) the whole traction is known, and there is no other piece or body."""
    of, n = model.deformable.patches, len(model.mesh.points)
    others = np.bincount(pieces.node[~pieces.plane], minlength=n) > 1
    others |= np.bincount(of.point, minlength=n) > 1
    return np.asarray(pieces.known.all(axis=1) & ~pieces.plane & ~others[pieces.node])


def _equations(model: Model, skin: _Skin, pieces: _Pieces, whole: NDArray[np.int64], stress: Vector) -> Equations:
    """The components of the traction that are known at points of pieces, or all of the stress (n, 4 or 6) at some points,
    ``whole`` (n,)."""
    of, dim = model.deformable.patches, model.dim
    around = (of.skin[:, of.free] @ pieces.visits).tocsr()
    components = stress.shape[1]
    told = pieces.known & ~pieces.plane[:, None]  # images make shear vanish on a plane
    told[whole] = False
    rows, axis = np.nonzero(told)
    coefficients = np.zeros((len(rows), components))
    for b in range(dim):
        coefficients[np.arange(len(rows)), np.array(TABLE[dim])[axis, b]] = pieces.normal[rows, b]
    each = np.repeat(whole, components)
    planes, bare = _planes(of, skin)
    return Equations(
        np.concatenate([pieces.x[rows], pieces.x[each]]),
        np.concatenate([coefficients, np.tile(np.eye(components), (len(whole), 1))]),
        np.concatenate([pieces.traction[rows, axis], stress.ravel()]),
        sp.hstack([around[:, rows], around[:, each]]).tocsr(),
        planes, np.eye(dim), bare, pieces.node[whole], stress,
    )  # fmt: skip


def _planes(of: Patches, skin: _Skin) -> tuple[NDArray[np.int32], NDArray[np.bool_]]:
    """Planes that mirror each patch, and which patches end elsewhere too."""
    planes = np.full((len(of.corner), 3), -1, dtype=np.int32)
    for axis in range(skin.mirrored.shape[1]):
        planes[np.asarray(of.skin[:, of.free] @ skin.mirrored[:, axis]).ravel() > 0, axis] = axis
    ends = np.ones(len(of.outside), dtype=bool)
    ends[np.flatnonzero(of.free)] = ~skin.mirrored.any(axis=1)
    return planes, np.asarray(of.skin @ ends).ravel() > 0
