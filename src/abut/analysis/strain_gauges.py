"""Stresses along the surface of linear elastic bodies, as strain gauges tell them: from the strain of the facets and the
traction on them; theory (Z9)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.bodies.recovery import carried
from abut.bodies.solids import Solids
from abut.bodies.stress import PointStress
from abut.cells import CELLS
from abut.contact.geometry import area_vectors
from abut.materials.elastic import LinearElastic
from abut.mesh.reference import reference_nodes
from abut.mesh.surface import Surface

Array = NDArray[np.float64]
INDEX = {
    2: ((0, 0), (1, 1), (0, 1)),
    3: ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)),
}  # of the components but zz in 2D
PLACE = {2: (0, 1, 3), 3: (0, 1, 2, 3, 4, 5)}  # among xx yy zz xy (yz zx)


@dataclass(frozen=True)
class Gauges:
    """In the middles of facets. facet: (n,) where each equation is; x: (n, dim); coefficients: (n, 4 or 6) of the stress as
    in ``abut.bodies.recovery.Equations``; value: (n,) what their sum with it is."""

    facet: NDArray[np.int64]
    x: Array
    coefficients: Array
    value: Array


def gauges(solids: Solids, skin: Surface, stress: PointStress, known: NDArray[np.bool_], traction: Array) -> Gauges:
    """On facets of first order of the outside of bodies. known: (n_facets,) on which the whole traction is; traction:
    (n_facets, dim), its mean, force per area."""
    yields, linear = _poisson(solids, skin.cells)
    facet = np.flatnonzero(known & linear)
    at, found = _at_facets(solids, skin, stress, facet)
    facet, at = facet[found], at[found]
    dim, area = skin.dim, area_vectors(skin)[facet]
    used = (skin.nodes[facet] >= 0)[..., None]
    x = (skin.points[np.maximum(skin.nodes[facet], 0)] * used).sum(axis=1) / used.sum(axis=1)
    normal = area.sum(axis=1) / np.linalg.norm(area.sum(axis=1), axis=1, keepdims=True)
    more = yields[facet] * (
        (traction[facet] * normal).sum(axis=1) - (_row(normal, normal) * at[:, PLACE[dim]]).sum(axis=1)
    )
    full, values = [], []
    for one, other in _directions(normal):
        row = np.zeros((len(facet), 4 if dim == 2 else 6))
        row[:, PLACE[dim]] = _row(one, other)
        full.append(row)
        values.append((row * at[:, : row.shape[1]]).sum(axis=1) + more * (one * other).sum(axis=1))
    if dim == 2 and solids.plane != "stress":
        full.append(np.broadcast_to([0.0, 0.0, 1.0, 0.0], (len(facet), 4)))
        values.append(at[:, 2] + more)
    times = len(full)
    return Gauges(np.tile(facet, times), np.tile(x, (times, 1)), np.concatenate(full), np.concatenate(values))


def _directions(normal: Array) -> list[tuple[Array, Array]]:
    """Pairs of unit vectors (n, dim) along facets, between which a stress is asked for."""
    if normal.shape[1] == 2:
        along = np.column_stack([-normal[:, 1], normal[:, 0]])
        return [(along, along)]
    axis = np.eye(3)[np.abs(normal).argmin(axis=1)]
    one = np.cross(axis, normal)
    one /= np.linalg.norm(one, axis=1, keepdims=True)
    other = np.cross(normal, one)
    return [(one, one), (other, other), (one, other)]


def _row(one: Array, other: Array) -> Array:
    """Coefficients (n, 3 or 6) of the components ``INDEX`` of a stress in one . stress other."""
    return np.stack(
        [0.5 * (1 + (a != b)) * (one[:, a] * other[:, b] + one[:, b] * other[:, a]) for a, b in INDEX[one.shape[1]]],
        axis=1,
    )


def _poisson(solids: Solids, cells: NDArray[np.int64]) -> tuple[Array, NDArray[np.bool_]]:
    """How much of a normal stress comes back along a surface that is not strained, nu / (1 - nu), at cells (n,), and
    whether they are linear elastic."""
    share, linear = np.zeros(len(solids.materials)), np.zeros(len(solids.materials), dtype=bool)
    for number, material in enumerate(solids.materials.values()):
        if isinstance(material, LinearElastic) and solids.kinematics == "small":
            nu, linear[number] = material.poisson, True
            share[number] = nu if solids.plane == "stress" else nu / (1.0 - nu)
    body = solids.body_of[cells]
    return share[body], linear[body] & (body >= 0)


def _at_facets(
    solids: Solids, skin: Surface, stress: PointStress, facet: NDArray[np.int64]
) -> tuple[Array, NDArray[np.bool_]]:
    """The cells' own stresses (n, 6) in the middles of facets (n,), and which of these are of first order."""
    result, found = np.zeros((len(facet), 6)), np.zeros(len(facet), dtype=bool)
    place = np.full(solids.mesh.n_cells, -1)
    for group, values in zip(solids.groups(), stress):
        cell = CELLS[group.kind]
        if cell.degree != 1:
            continue
        place[:] = -1
        place[group.cells] = np.arange(len(group.cells))
        for local, (_, nodes) in enumerate(cell.facets):
            here = np.flatnonzero((place[skin.cells[facet]] >= 0) & (skin.local[facet] == local))
            if len(here):
                middle = reference_nodes(group.kind)[list(nodes)].mean(axis=0, keepdims=True)
                weights = carried(group.kind, group.rule, middle)[0]
                result[here] = np.einsum("q,fqc->fc", weights, values[place[skin.cells[facet[here]]]])
                found[here] = True
    return result, found
