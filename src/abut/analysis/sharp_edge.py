"""Contact at a sharp edge (in 2D a corner): its force may be right, its pressure is that of the mesh; theory (L17)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut.analysis.edge_load import normals_at
from abut.contact.geometry import facet_sizes, nodal_normals, turning_within
from abut.contact.pressing_edges import Opposite, at_edges, leaning, pressing
from abut.errors import InputError
from abut.mesh.mesh import Mesh
from abut.mesh.surface import Surface
from abut.problem.pair import Pair

MOST = 0.5  # of the force: share at edges from which on contact is theirs

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Forces:
    """At nodes, (dim n_points,): of stresses, and the sizes of those of loads and of contacts."""

    internal: Array
    acting: Array


@dataclass(frozen=True)
class SharpEdge:
    """of_target: whose edge it is; place: (dim,) the loaded point of it; give: how far both bodies give way under their
    forces, a length; off: what the edge itself gives way beyond what facets show, or what the gap's mean over facets is off
    by, over that."""

    of_target: bool
    place: Array
    give: float
    off: float


def sharp_edge(mesh: Mesh, pair: Pair, pressure: Array, displacement: Array, forces: Forces) -> SharpEdge | None:
    """The sharp edge that carries most of a pair's force; None where there is none, and where edges of both sides meet.

    pressure: (n,) of the pair; displacement: (n_points, dim)."""
    if pair.tied:
        return None
    at, facet_wise = pair.coupling.gap_samples, pair.space.transfer @ pressure[pair.normal]
    force = np.abs(pair.coupling.weight * facet_wise).reshape(len(pair.contactor), -1).sum(axis=1)
    if at is None or not len(at.gap) or not force.any():
        return None
    loaded = (force > 0.0)[at.facet]
    try:
        if not (at_edges(pair.contactor)[at.facet] | at_edges(pair.target)[at.target_facet])[loaded].any():
            return None
        one, other = (replace(side, points=side.points + displacement) for side in (pair.contactor, pair.target))
        own, theirs = (nodal_normals(side) for side in (one, other))
        n_own = normals_at(own, at.facet, at.contactor_shapes)
        n_other = normals_at(theirs, at.target_facet, at.target_shapes)
        facets, each = (at.facet.astype(np.int64), at.target_facet.astype(np.int64)), np.ones(len(at.gap))
        turns = turning_within(one, own)[facets[0]], turning_within(other, theirs)[facets[1]]
        mine = pressing(one, own, Opposite(facets[0], n_other, turns[1], each))[facets[0]]
        of_target = pressing(other, theirs, Opposite(facets[1], n_own, turns[0], each))[facets[1]]
    except InputError:  # a facet without a normal
        return None
    for is_target, flags in ((False, mine & ~of_target), (True, of_target & ~mine)):
        here = np.zeros(len(force), dtype=bool)
        here[at.facet[flags]] = True
        if force[here].sum() > MOST * force.sum():
            lean = np.linalg.norm(leaning(n_own, n_other), axis=1)
            worst = int(np.argmax(np.where(here, force, 0.0)))
            sine = float(lean[flags & (at.facet == worst)].mean())
            give = _give(mesh, pair, displacement, forces)
            off = _averaged(pair, worst, sine) if is_target else _unseen(pair, worst, sine, force)
            return SharpEdge(is_target, _middle(pair.contactor, worst), give, off / max(give, 1e-300))
    return None


def _unseen(pair: Pair, facet: int, sine: float, force: Array) -> float:
    """What an edge gives way between the size of a facet and the half width of its contact, a length, theory (L17)."""
    size = float(facet_sizes(pair.contactor)[facet])
    by_length = size * float(force[facet] / max(pair.coupling.covered[facet], 1e-300))
    give = pair.compliance * by_length
    width = give / (2.0 * sine)
    return give / np.pi * float(np.log(size / width)) if 0.0 < width < size else 0.0


def _averaged(pair: Pair, facet: int, sine: float) -> float:
    """What the gap of a facet with an edge opposite is off by if it is closed in the mean, a length."""
    return 0.5 * sine * float(facet_sizes(pair.contactor)[facet])


def _middle(surface: Surface, facet: int) -> Array:
    nodes = surface.nodes[facet]
    return np.asarray(surface.points[nodes[nodes >= 0]].mean(axis=0))


def _give(mesh: Mesh, pair: Pair, displacement: Array, forces: Forces) -> float:
    """Of the bodies on either side, twice the energy over the sizes of the loads and contact forces, added up, a length."""
    total, dim = 0.0, displacement.shape[1]
    sides = [side.node_ids for side in (pair.contactor, pair.target)]
    internal, acting = forces.internal.reshape(-1, dim), forces.acting.reshape(-1, dim)
    for body in mesh.bodies:
        nodes = mesh.nodes_of(body)
        size = float(np.linalg.norm(acting[nodes], axis=1).sum())
        if size > 0.0 and any(np.isin(side, nodes).mean() > MOST for side in sides):
            total += abs(float((internal[nodes] * displacement[nodes]).sum())) / size
    return total
