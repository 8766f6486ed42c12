"""ADJUST of a contact pair: slave nodes are moved on to the master before anything else, without strain, as in CalculiX and
Abaqus."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.cells import CELLS
from abut.contact.geometry import area_vectors, by_kind, node_coordinates
from abut.io.deck.groups import Groups
from abut.io.deck.record import Deck, Pair
from abut.mesh.mesh import Mesh
from abut.mesh.surface import Surface
from abut.model import Contact
from abut.probing.closest_points import Feet, feet

ROUND = 1e-9  # of the size of the mesh: distances that rounding leaves
Vector = NDArray[np.float64]
Flags = NDArray[np.bool_]


def adjusted(
    mesh: Mesh, deck: Deck, groups: Groups, contacts: Sequence[Contact], notes: list[str]
) -> tuple[Mesh, list[Contact]]:
    """The mesh with the nodes moved that ADJUST asks for, pair by pair, and the contacts. ``notes`` gets how far.

    contacts: those of ``deck.pairs``, in their order. What is left between nodes on facets that were moved as a whole, where
    one of two curved surfaces is faceted otherwise than the other, counts as no gap (``adjust``)."""
    result = list(contacts)
    for i, (contact, pair) in enumerate(zip(contacts, deck.pairs)):
        if pair.is_tie or pair.adjust is None or pair.clearance is not None:
            continue
        slave, master = (mesh.surface(groups.surface(name)) for name in (pair.slave, pair.master))
        extent = float(np.ptp(mesh.points, axis=0).max())
        move, closed = _moves(slave, master, *_asked(pair, groups, slave), ROUND * extent)
        farthest = float(np.linalg.norm(move, axis=1).max(initial=0.0))
        if farthest > ROUND * extent:
            count = int((np.linalg.norm(move, axis=1) > ROUND * extent).sum())
            notes.append(
                f"contact '{pair.name}': ADJUST: {count} nodes of '{pair.slave}' were moved on to '{pair.master}', by up to "
                f"{farthest:.4g}, without strain"
            )
            mesh = replace(mesh, points=mesh.points + move)
        rest = _left(mesh.surface(groups.surface(pair.slave)), mesh.surface(groups.surface(pair.master)), closed)
        if rest > ROUND * extent and not pair.tied:
            result[i] = replace(contact, adjust=rest)
    return mesh, result


def _asked(pair: Pair, groups: Groups, slave: Surface) -> tuple[float, Flags]:
    """Up to which distance gaps are closed, and at which of the slave's ``node_ids``."""
    if isinstance(pair.adjust, np.ndarray):
        return np.inf, np.isin(groups.used[slave.node_ids], pair.adjust)
    assert isinstance(pair.adjust, float)
    return pair.adjust, np.ones(len(slave.node_ids), dtype=bool)


def _moves(slave: Surface, master: Surface, zone: float, inside: Flags, small: float) -> tuple[Vector, Flags]:
    """How points move, (n_points, dim), and which lie on the master then, (n_points,).

    zone, inside: as from ``_asked``; small: a distance that is rounding. An overlap is taken away however deep it is, where
    the surfaces look at each other: not at nodes under the far side of the master's body."""
    nodes = slave.node_ids
    found = feet(master, slave.points[nodes])
    way, facet = np.zeros((len(nodes), slave.dim)), np.full(len(nodes), -1)
    way[found.point] = _points(master, found) - slave.points[nodes[found.point]]  # any of several feet at one place
    facet[found.point] = found.facet
    outward = _outward(master)[facet]
    overlap = (way * outward).sum(axis=1) > 0.0
    facing = _most_opposed(slave, outward)[nodes] < 0.0
    apart = np.linalg.norm(way, axis=1)
    chosen = (facet >= 0) & inside & (overlap & facing | (apart <= zone + small))
    move, closed = np.zeros_like(slave.points), np.zeros(len(slave.points), dtype=bool)
    move[nodes[chosen]], closed[nodes[chosen]] = way[chosen], True
    return move, closed


def _points(surface: Surface, found: Feet) -> Vector:
    """Where feet are, (k, dim)."""
    corners = surface.points[np.maximum(surface.nodes[found.facet], 0)]
    return np.asarray(np.einsum("ka,kad->kd", found.weights, corners))


def _outward(surface: Surface) -> Vector:
    """Unit normals of facets, (n_facets, dim)."""
    normal = area_vectors(surface).sum(axis=1)
    return np.asarray(normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300))


def _most_opposed(slave: Surface, outward: Vector) -> Vector:
    """Of each point of the slave, the smallest product of the normals of its facets with the master's below it,
    (n_points,); outward: that at each of its ``node_ids``."""
    result, at = np.ones(len(slave.points)), np.zeros((len(slave.points), slave.dim))
    at[slave.node_ids] = outward
    facet, local = np.nonzero(slave.nodes >= 0)
    nodes = slave.nodes[facet, local]
    np.minimum.at(result, nodes, (_outward(slave)[facet] * at[nodes]).sum(axis=1))
    return result


def _left(slave: Surface, master: Surface, closed: Flags) -> float:
    """The largest distance from the master between the nodes of facets whose nodes are all on it."""
    samples = []
    for kind, facets in by_kind(slave):
        cell = CELLS[kind]
        whole = facets[closed[slave.nodes[facets, : cell.nodes]].all(axis=1)]
        xi = node_coordinates(kind)
        between = np.concatenate([0.5 * (xi[i] + xi[:i]) for i in range(1, len(xi))])
        shapes = shape_functions(cell.code, np.ascontiguousarray(between))[0]
        corners = slave.points[slave.nodes[whole, : cell.nodes]]
        samples.append(np.einsum("sa,fad->fsd", shapes[:, : cell.nodes], corners).reshape(-1, slave.dim))
    points = np.concatenate([np.zeros((0, slave.dim)), *samples])
    if not len(points):
        return 0.0
    found = feet(master, points)
    return float(found.distance[np.unique(found.point)].max(initial=0.0))
