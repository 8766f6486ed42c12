"""A surface that ends at the sides of a sector of cyclic symmetry, with the facets beyond: its own, turned."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from abut.mesh.surface import Surface
from abut.sectors import Turned

ON_AXIS = 1e-9  # of the surface's size: points that a turn moves by less stay where they are
Array = NDArray[np.float64]
Ids = NDArray[np.int64]


@dataclass(frozen=True)
class Extended:
    """surface: its own facets and points first, images after; source, power: (m,) of all its facets which one each is, and
    turned by how many sectors; point, point_power: the same of its points; turns: (dim, dim) by power."""

    surface: Surface
    source: Ids
    power: Ids
    point: Ids
    point_power: Ids
    turns: dict[int, Array]

    def turned(self, vectors: Array, power: Ids) -> Array:
        """Vectors (n, ..., dim), each turned by as many sectors as ``power`` (n,) says."""
        result = vectors.copy()
        for k in np.unique(power[power != 0]).tolist():
            result[power == k] = vectors[power == k] @ self.turns[k].T
        return result


@dataclass(frozen=True)
class Images:
    """Further visits, of images beyond the sides of a sector: of which visit each is one, (n,), and how it is turned,
    (n, dim, dim)."""

    source: NDArray[np.int64]
    turns: NDArray[np.float64]

    def with_images(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Vectors of all visits, (n_visits, dim), with those of the images after them."""
        return np.concatenate([values, np.einsum("nab,nb->na", self.turns, values[self.source])])


def extended(surface: Surface, rings: int) -> Extended:
    """With images of the facets within some ``rings`` of its own. Points common to a facet and an image are one."""
    n, facets = len(surface.points), np.arange(len(surface))
    none = Extended(surface, facets, np.zeros_like(facets), np.arange(n), np.zeros(n, dtype=np.int64), {})
    sides = used_sides(surface)
    if sides is None:
        return none
    count, copies = sides.sectors, _copies(surface, sides, rings)
    moves = {k: sides.power(k) for k in copies}
    links = []
    for c, k in enumerate(copies):
        before = [d for d, j in enumerate(copies) if (j - k + 1 == 0 if not count else (j - k + 1) % count == 0)]
        links += [(c * n + sides.partners, d * n + sides.nodes) for d in before if d != c]
    axis = _on_axis(surface, sides)
    links += [(c * n + axis, axis) for c in range(1, len(copies))]
    one, two = (np.concatenate(ends) for ends in zip(*links))
    graph = sp.csr_matrix((np.ones(len(one)), (one, two)), shape=(n * len(copies),) * 2)
    _, label = connected_components(graph, directed=False)
    least = np.full(int(label.max()) + 1, n * len(copies))
    np.minimum.at(least, label, np.arange(len(label)))
    same = least[label]
    there = surface.nodes >= 0
    every = np.concatenate(
        [np.where(there, same[c * n + np.maximum(surface.nodes, 0)], -1) for c in range(len(copies))]
    )
    keep = _near(every, len(surface), rings)
    every, number = every[keep], np.flatnonzero(keep)
    source, power = number % len(surface), np.array(copies)[number // len(surface)]
    further = np.unique(every[every >= n])
    place = np.arange(n * len(copies))
    place[further] = n + np.arange(len(further))
    point, point_power = np.concatenate([np.arange(n), further % n]), np.concatenate([np.zeros(n, int), further // n])
    point_power = np.array(copies)[point_power]
    points = surface.points[point]
    for k, (turn, shift) in moves.items():
        here = point_power == k
        points[here] = points[here] @ turn.T + shift if k else points[here]
    nodes = np.where(every >= 0, place[np.maximum(every, 0)], -1).astype(surface.nodes.dtype)
    result = replace(surface.part(source), points=points, nodes=np.ascontiguousarray(nodes), turned=None)
    return Extended(result, source, power, point, point_power, {k: turn for k, (turn, _) in moves.items()})


def used_sides(surface: Surface) -> Turned | None:
    """The points of a surface on both sides of a sector; None where it does not reach both."""
    sides = surface.turned
    if sides is None:
        return None
    used = np.zeros(len(surface.points), dtype=bool)
    used[surface.nodes[surface.nodes >= 0]] = True
    both = used[sides.nodes] & used[sides.partners]
    return replace(sides, nodes=sides.nodes[both], partners=sides.partners[both]) if both.any() else None


def sides_of_split(
    surface: Surface, more: Extended, both: NDArray[np.int32], nodes: NDArray[np.int32], owner: Ids
) -> Turned:
    """The sides of a sector by the points of a surface that was split at its creases: facets beyond tell which belong
    together. more: the surface with images, both: its nodes (m, 9) after it was split; nodes: (n_facets, 9) of the surface
    itself; owner: (n,) which point each of these was."""
    sides = used_sides(surface)
    assert sides is not None
    facet, local = np.nonzero(both >= 0)
    place, image = both[facet, local], facet >= len(surface)
    here = np.full(int(place.max()) + 1, -1)
    here[place[~image]] = nodes[facet[~image], local[~image]]
    node, partner = here[place[image]], nodes[more.source[facet[image]], local[image]]
    of = np.full(len(owner), -1)
    of[sides.nodes] = sides.partners
    pairs = np.stack([node, partner], axis=1)[(node >= 0) & (of[owner[node]] == owner[partner])]
    pairs = np.unique(pairs, axis=0).astype(np.int64)
    return replace(sides, nodes=pairs[:, 0], partners=pairs[:, 1])


def _copies(surface: Surface, sides: Turned, rings: int) -> list[int]:
    """Turned by how many sectors images may be within so many rings, itself first: a sector is a facet wide, or more. Round
    an axis that the surface meets all are."""
    count = sides.sectors
    if count and (2 * rings + 1 >= count or len(_on_axis(surface, sides))):
        return [0, *range(1, count // 2 + 1), *range(-((count - 1) // 2), 0)]
    return [0, *range(1, rings + 1), *range(-rings, 0)]


def _on_axis(surface: Surface, sides: Turned) -> Ids:
    ids = surface.node_ids
    x = surface.points[ids]
    moved = np.linalg.norm(x @ sides.turn.T + sides.shift - x, axis=1)
    return ids[moved <= ON_AXIS * np.ptp(x, axis=0).max()]


def _near(nodes: NDArray[np.int64], own: int, rings: int) -> NDArray[np.bool_]:
    """Which facets (nodes padded with -1) are the first ``own``, or within some rings of them."""
    keep = np.arange(len(nodes)) < own
    there = nodes >= 0
    for _ in range(rings):
        near = np.zeros(int(nodes.max()) + 1, dtype=bool)
        near[nodes[keep][there[keep]]] = True
        keep |= (near[np.maximum(nodes, 0)] & there).any(axis=1)
    return keep
