"""Contact detection: the facets on the boundaries of the bodies that face each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from abut.contact.bulge import with_bulge
from abut.contact.contactor_choice import NEAR
from abut.contact.coupling import CouplingOptions, couple, default_reach
from abut.contact.geometry import facet_sizes, full_moments, mean_normals, straight
from abut.mesh.exterior import exterior
from abut.mesh.mesh import Mesh
from abut.mesh.surface import Surface

OPPOSITE = -0.5  # cosine between the normals of facets that face each other: within 60 degrees of opposite
HALF = 0.5  # of the thickness of the bodies, or of what is near: overlaps that are deeper are none
SEEN_TWICE = 1.2  # covered area over a facet's area from which on what lies behind is hidden


@dataclass(frozen=True)
class Outside:
    """All exterior facets of some bodies. rows: (n, 2) of the mesh; body: (n,) number among ``names``; solid: (n,) number of
    the bodies that share points; normal: (n, dim) mean unit normals; size, area: (n,); surface: with straight edges;
    curved: as a run sees it."""

    surface: Surface
    curved: Surface
    rows: NDArray[np.int64]
    names: tuple[str, ...]
    body: NDArray[np.int64]
    solid: NDArray[np.int64]
    normal: NDArray[np.float64]
    size: NDArray[np.float64]
    area: NDArray[np.float64]


@dataclass(frozen=True)
class Facing:
    """Pairs of facets that face each other: one, other: (m,) facet numbers of an ``Outside``; gap: (m,) negative where they
    overlap; area: (m,) on ``one``."""

    one: NDArray[np.int64]
    other: NDArray[np.int64]
    gap: NDArray[np.float64]
    area: NDArray[np.float64]

    def where(self, keep: NDArray[np.bool_]) -> Facing:
        return Facing(self.one[keep], self.other[keep], self.gap[keep], self.area[keep])


def outside(mesh: Mesh, names: Sequence[str]) -> Outside:
    """The exterior facets of the bodies ``names``, with straight edges and their bulges, and as if plane where the mesh is
    axisymmetric: the search needs no more, and is much quicker so."""
    number = np.full(mesh.n_cells, -1, dtype=np.int64)
    for i, name in enumerate(names):
        number[mesh.bodies[name]] = i
    rows = exterior(mesh)
    rows = rows[number[rows[:, 0]] >= 0]
    curved = replace(replace(mesh, axisymmetric=False).facets(rows, "exterior"), parts=number[rows[:, 0]])
    surface, curved = (replace(with_bulge(side), parts=None) for side in (straight(curved), curved))
    normal = mean_normals(surface)
    area = full_moments(surface, 0)[:, 0]
    member = np.zeros((len(names), len(mesh.points)), dtype=np.int32)
    for i, name in enumerate(names):
        member[i, mesh.nodes_of(name)] = 1
    sparse = sp.csr_matrix(member)
    solid = connected_components(sparse @ sparse.T, directed=False)[1].astype(np.int64)
    body = number[rows[:, 0]]
    return Outside(surface, curved, rows, tuple(names), body, solid[body], normal, facet_sizes(surface), area)


def facing(all_of: Outside, reach: float | None) -> Facing:
    """Facets of different bodies that face each other within ``reach`` (length; None: half the sum of their sizes), with
    nothing in between. Overlaps count as far as gaps that come from the sizes, and half way through the bodies at most."""
    count = len(all_of.names)
    of_body = [np.flatnonzero(all_of.body == i) for i in range(count)]
    parts = [_search(all_of, of_body[a], of_body[b], reach) for a, b in combinations(range(count), 2)]
    met = np.unique(np.concatenate([f for p in parts for f in (p.one, p.other)])) if parts else of_body[0][:0]
    for facets in of_body:  # what hides others behind its own thickness
        hidden = _search(all_of, facets[np.isin(facets, met)], facets, reach, boxes=False)
        parts += [hidden, Facing(hidden.other, hidden.one, hidden.gap, hidden.area)]
    every = _joined(parts)
    two = all_of.body[every.one] != all_of.body[every.other]
    ahead = every.where(two | (every.gap > 0.0))  # a body's own thickness hides nothing outside it
    ahead = ahead.where(_visible(all_of, ahead) & (all_of.body[ahead.one] != all_of.body[ahead.other]))
    inside = every.where(_visible(all_of, every) & two & _shallow(all_of, every))
    return _joined([ahead.where(ahead.gap >= 0.0), inside.where(inside.gap < 0.0)])


def seen_by(all_of: Outside, contactor: NDArray[np.int64], target: NDArray[np.int64]) -> NDArray[np.int64]:
    """The target with the facets of its body that a contactor, and so its pressure, sees within the reach of the two, and
    does not lie deep inside of. Larger facets among these reach further: until there are no more."""
    body = np.flatnonzero(all_of.body == all_of.body[target[0]])
    part, other = all_of.curved.part(contactor), all_of.curved.part(body)
    far, before = default_reach(part, all_of.curved.part(target)), 0.0
    while far > before:
        at = couple(part, other, 0, CouplingOptions(points=1, reach=far, keep_points=True)).points
        if at is None:
            break
        near = NEAR * (all_of.size[contactor[at.facet]] + all_of.size[body[at.target_facet]])
        target = np.union1d(target, body[at.target_facet[-at.gap <= near]])
        far, before = default_reach(part, all_of.curved.part(target)), far
    return target


def _joined(parts: Sequence[Facing]) -> Facing:
    return Facing(*(np.concatenate([getattr(p, key) for p in parts]) for key in ("one", "other", "gap", "area")))


def _shallow(all_of: Outside, every: Facing) -> NDArray[np.bool_]:
    """Overlaps of two bodies that reach less than half way through either of them: what lies deeper is nearer to the far
    side. Of bodies that share points the far side of one may be that of the other."""
    one_solid = all_of.solid[every.one] == all_of.solid[every.other]
    deep = -every.gap > HALF * NEAR * (all_of.size[every.one] + all_of.size[every.other])
    same = (all_of.body[every.one] == all_of.body[every.other]) & (every.gap < 0.0)
    through = every.where(same | (one_solid & deep))
    thick = np.full(len(all_of.rows), np.inf)
    for facets in (through.one, through.other):
        np.minimum.at(thick, facets, -through.gap)
    half_way = -every.gap <= HALF * np.minimum(thick[every.one], thick[every.other])
    return np.asarray(half_way & ~(one_solid & deep))


def _visible(all_of: Outside, every: Facing) -> NDArray[np.bool_]:
    return _nearest(all_of, every, every.one, every.other) & _nearest(all_of, every, every.other, every.one)


def _search(
    all_of: Outside, one: NDArray[np.int64], other: NDArray[np.int64], reach: float | None, boxes: bool = True
) -> Facing:
    """Facets among ``one`` and ``other`` that face each other; ``boxes``: first leave out what lies far from all others."""
    none = Facing(one[:0], one[:0], np.zeros(0), np.zeros(0))
    if not len(one) or not len(other):
        return none
    far = max(all_of.size[one].max(), all_of.size[other].max()) if reach is None else reach
    if boxes:
        one, other = one[_near(all_of, one, other, far)], other[_near(all_of, other, one, far)]
        if not len(one) or not len(other):
            return none
    options = CouplingOptions(points=1, reach=far, keep_points=True, hidden=True)
    at = couple(all_of.surface.part(one), all_of.surface.part(other), 0, options).points
    if at is None:
        return none
    found = Facing(one[at.facet], other[at.target_facet], at.gap, at.weight)
    return found.where(_plausible(all_of, found, reach))


def _plausible(all_of: Outside, found: Facing, reach: float | None) -> NDArray[np.bool_]:
    opposite = np.einsum("ij,ij->i", all_of.normal[found.one], all_of.normal[found.other]) < OPPOSITE
    # The far side of a body may lie at any angle.
    opposite |= (all_of.body[found.one] == all_of.body[found.other]) & (found.gap < 0.0)
    near = NEAR * (all_of.size[found.one] + all_of.size[found.other])
    limit = near if reach is None else reach
    close = (found.gap <= limit) & (-found.gap <= np.minimum(limit, near))
    left, right = all_of.surface.nodes[found.one], all_of.surface.nodes[found.other]
    common = ((left[:, :, None] == right[:, None, :]) & (left[:, :, None] >= 0)).any(axis=(1, 2))
    return np.asarray(opposite & close & ~common)


def _nearest(all_of: Outside, every: Facing, facet: NDArray[np.int64], partner: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Whether what faces a facet is not behind what covers the facet already: another body, or its own thickness."""
    if not len(facet):
        return np.zeros(0, dtype=bool)
    n = len(all_of.names)
    key, group = np.unique(facet * n + all_of.body[partner], return_inverse=True)
    area = np.bincount(group, every.area)
    distance = np.bincount(group, every.area * np.abs(every.gap)) / np.maximum(area, 1e-300)
    owner = key // n
    order = np.lexsort((distance, owner))
    covered = np.cumsum(area[order])
    first = np.concatenate([[True], owner[order][1:] != owner[order][:-1]])
    before = np.concatenate([[0.0], covered[:-1]])
    covered = covered - np.maximum.accumulate(np.where(first, before, 0.0))
    seen = np.empty(len(key), dtype=bool)
    seen[order] = first | (covered <= SEEN_TWICE * all_of.area[owner[order]])
    return np.asarray(seen[group])


def _near(all_of: Outside, facets: NDArray[np.int64], others: NDArray[np.int64], reach: float) -> NDArray[np.bool_]:
    """Facets whose box meets the box of all the others, wider by the reach."""
    low, high = _boxes(all_of.surface, facets)
    their_low, their_high = _boxes(all_of.surface, others)
    limits = their_low.min(axis=0) - reach, their_high.max(axis=0) + reach
    return np.asarray(((low <= limits[1]) & (high >= limits[0])).all(axis=1))


def _boxes(surface: Surface, facets: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    nodes = surface.nodes[facets]
    x = surface.points[np.where(nodes >= 0, nodes, nodes[:, :1])]
    return x.min(axis=1), x.max(axis=1)
