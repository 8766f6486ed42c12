"""Sharp edges (in 2D corners) of a surface that press on the other one: where that leans out over them; theory (R2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.contact.geometry import split_at_creases, turning_within
from abut.contact.rim import Rim, rim
from abut.mesh.surface import Surface

ACROSS = np.cos(np.deg2rad(45.0))  # of the angle between an edge's outward direction and where the other side leans to
ROUND = 2.0  # times what sides turn within a facet, about as much as normals of round ones lean where facets end
TURNED = 1e-6  # sine of an angle from which on surfaces lean

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


def leaning(own: Array, other: Array) -> Array:
    """The part of the opposite of ``other`` that is square to ``own``, (n, dim) each: as long as the sine of their angle."""
    return np.asarray((own * other).sum(axis=1, keepdims=True) * own - other)


def outward(ends: Rim) -> Array:
    """Unit directions (m, dim) in which facets end at their edges."""
    return np.asarray(ends.out / np.maximum(np.linalg.norm(ends.out, axis=1, keepdims=True), 1e-300))


def at_edges(surface: Surface) -> Flags:
    """Facets (n_facets,) with an edge at which the surface ends or has a crease. Raises InputError as ``rim`` does."""
    result = np.zeros(len(surface), dtype=bool)
    result[rim(split_at_creases(surface)[0]).facet] = True
    return result


@dataclass(frozen=True)
class Opposite:
    """What lies opposite facets (n,) of a surface at n points. normal: (n, dim) unit, out of the other side; turns: (n,) by
    how much its facet's normals turn; weight: (n,) area."""

    facet: NDArray[np.int64]
    normal: Array
    turns: Array
    weight: Array


def pressing(surface: Surface, normals: Array, opposite: Opposite, least: float = TURNED) -> Flags:
    """Facets (n_facets,) with an edge, at which the surface ends or has a crease, over which the other side leans: by more
    than both turn within their facets, as round surfaces lean, which have no such edge.

    normals: (n_facets, 9, dim) nodal, out of the surface; least: sine of the angle by which it leans at least. Raises
    InputError for a facet without a normal."""
    result = np.zeros(len(surface), dtype=bool)
    facet = opposite.facet
    split, _ = split_at_creases(surface)
    ends = rim(split)
    total = np.bincount(facet, opposite.weight, len(surface))
    seen = total[ends.facet] > 0.0
    if not seen.any():
        return result
    sums = [np.bincount(facet, opposite.weight * along, len(surface)) for along in opposite.normal.T]
    mean = np.stack(sums, axis=1) / np.maximum(total, 1e-300)[:, None]
    turns = turning_within(surface, normals)
    spread = np.zeros(len(surface))
    np.maximum.at(spread, facet, 2.0 * np.linalg.norm(opposite.normal - mean[facet], axis=1) + opposite.turns)
    at_edge = (split.nodes[ends.facet][:, :, None] == ends.ends[:, None, :]).any(axis=2)
    own = (normals[ends.facet] * at_edge[..., None]).sum(axis=1)
    own /= np.maximum(np.linalg.norm(own, axis=1, keepdims=True), 1e-300)
    lean = leaning(own, mean[ends.facet])
    size = np.linalg.norm(lean, axis=1)
    out = (lean * outward(ends)).sum(axis=1) > ACROSS * size
    result[ends.facet[seen & out & (size > ROUND * (turns + spread)[ends.facet] + least)]] = True
    return result
