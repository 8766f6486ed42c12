"""Slopes of displacements along surfaces from those of the surface's nodes (polynomial preserving recovery, Zhang and Naga
2005), and the stresses that they and the traction give: theory (Z9), (Z10)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.bodies.solids import Solids, TemperatureChange
from abut.bodies.surface_law import Along, known_law, stress_along
from abut.cells import CELLS
from abut.materials.places import Places, is_local, placed, uniform_expansion
from abut.mesh.mesh import Mesh
from abut.mesh.reference import reference_nodes
from abut.mesh.surface import Surface
from abut.types import Sparse

NEAR = 0.1  # of the squared size of a patch: a node close to its middle counts at most by 100, as in (Z2)
LOST = 1e-6  # singular value over the largest from which down nodes cannot tell a term
ON_PLANE = 1e-9  # distance over the size of a patch

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SurfacePoints:
    """Points of the mesh on smooth pieces of the bodies' outside. node: (n,) their numbers; facets: (n, n_facets) CSR,
    nonzero where a facet of their piece has them; normal: (n, dim) of undeformed bodies; mirrored: (n, dim) whether a plane
    across an axis continues the body there; traction: (n, dim) per current area."""

    node: NDArray[np.int64]
    facets: Sparse
    normal: Array
    mirrored: NDArray[np.bool_]
    traction: Array


def surface_stress(
    solids: Solids, skin: Surface, displacement: Array, temperature: TemperatureChange, points: SurfacePoints
) -> tuple[Array, NDArray[np.bool_]]:
    """Stresses at points (n, 6), and where they are known, (n,): where the material's law hangs on the strain alone. skin:
    the facets that bodies end with, undeformed; displacement: (n_points, dim)."""
    n, dim = points.normal.shape
    at = _along(solids.mesh, skin, displacement, points)
    stress, found = np.zeros((n, 6)), np.zeros(n, dtype=bool)
    some = points.facets.indices[points.facets.indptr[:-1]]  # a facet of each
    body, finite = solids.body_of[skin.cells[some]], solids.kinematics == "finite"
    for number, (name, material) in enumerate(solids.materials.items()):
        here = body == number
        if not here.any():
            continue
        change = np.full(int(here.sum()), temperature.bodies.get(name, 0.0))
        if temperature.nodes is not None:
            change += temperature.nodes[points.node[here]]
        local = placed(material, Places(solids.points[points.node[here]], change))
        evaluate, expansion = known_law(local, finite, solids.plane), uniform_expansion(material)
        if evaluate is None or (finite and change.any() and (is_local(material) or expansion)):
            continue
        at.thermal[here] = expansion * change
        stress[here], found[here] = stress_along(evaluate, material.modulus, finite, solids.plane, at.part(here))
    return stress[:, : 4 if dim == 2 else 6], found


def _along(mesh: Mesh, skin: Surface, displacement: Array, points: SurfacePoints) -> Along:
    n, dim = points.normal.shape
    tangents = _tangents(points.normal)
    level = points.facets @ _cell_slopes(mesh, skin, displacement).reshape(len(skin), dim * dim)
    level = level.reshape(n, dim, dim) / np.diff(points.facets.indptr)[:, None, None]
    for axis in range(dim):
        turn = np.where(np.arange(dim) == axis, -1.0, 1.0)
        image = turn[:, None] * level * turn
        level = np.where(points.mirrored[:, axis, None, None], 0.5 * (level + image), level)
    slope = level @ np.swapaxes(tangents, 1, 2)
    for rows, apart, moved in _patches(skin, displacement, points):
        more = moved - apart @ np.swapaxes(level[rows], 1, 2)
        slope[rows] += np.swapaxes(_fitted(apart @ np.swapaxes(tangents[rows], 1, 2), more), 1, 2)
    hoop = np.zeros(n)
    if skin.axisymmetric:
        radius = skin.points[points.node, 0]
        middle = points.mirrored[:, 0]
        hoop = np.where(
            middle, slope[:, 0, 0] * tangents[:, 0, 0], displacement[points.node, 0] / np.where(middle, 1.0, radius)
        )
    across = (level @ points.normal[..., None])[..., 0]
    return Along(slope, tangents, points.normal, across, hoop, np.zeros(n), points.traction)


def _fitted(y: Array, values: Array) -> Array:
    """Slopes (n, dim - 1, dim) in the middle of quadratic polynomials that are zero there, fitted to values (n, k, dim) at y
    (n, k, dim - 1); the smallest where these do not tell."""
    size = np.abs(y).max(axis=(1, 2))
    y = y / size[:, None, None]
    dim = y.shape[2]
    terms = [y[..., a] for a in range(dim)] + [y[..., a] * y[..., b] for a in range(dim) for b in range(a, dim)]
    root = ((y != 0.0).any(axis=2) / (NEAR + (y**2).sum(axis=2)))[..., None]
    rows = np.linalg.pinv(root * np.stack(terms, axis=2), rcond=LOST)[:, :dim]
    return np.asarray(rows @ (root * values) / size[:, None, None])


def _patches(
    skin: Surface, displacement: Array, points: SurfacePoints
) -> Iterator[tuple[NDArray[np.int64], Array, Array]]:
    """Points (m,) with equally many nodes around, and where these are and move relative to them, (m, k, dim), with images
    beyond planes; those on the planes, which are their own images, are zero there."""
    facet, local = np.nonzero(skin.nodes >= 0)
    has = sp.csr_matrix((np.ones(len(facet)), (facet, skin.nodes[facet, local])), shape=(len(skin), len(skin.points)))
    pattern = (points.facets @ has).tocsr()
    planes = points.mirrored @ (1 << np.arange(points.mirrored.shape[1]))
    count = np.diff(pattern.indptr)
    alike = count * 8 + planes
    for key in np.unique(alike):
        rows = np.flatnonzero(alike == key)
        near = pattern.indices[pattern.indptr[rows][:, None] + np.arange(key // 8)]
        middle = points.node[rows][:, None]
        apart = skin.points[near] - skin.points[middle]
        moved = displacement[near] - displacement[middle]
        size = ON_PLANE * np.abs(apart).max(axis=(1, 2))[:, None]
        for axis in np.flatnonzero(points.mirrored[rows[0]]):
            own = (np.abs(apart[..., axis]) <= size)[..., None]
            turn = np.where(np.arange(apart.shape[2]) == axis, -1.0, 1.0)
            apart = np.concatenate([apart, np.where(own, 0.0, apart * turn)], axis=1)
            moved = np.concatenate([moved, np.where(own, 0.0, moved * turn)], axis=1)
        yield rows, apart, moved


def _cell_slopes(mesh: Mesh, skin: Surface, displacement: Array) -> Array:
    """Of the cells' own displacements in the middles of facets, (n_facets, dim, dim): d u_i / d x_j."""
    result = np.zeros((len(skin), skin.dim, skin.dim))
    for block, first in zip(mesh.blocks, mesh.starts.tolist()):
        cell = CELLS[block.kind]
        inside = (skin.cells >= first) & (skin.cells < first + len(block.nodes))
        for local, (kind, nodes) in enumerate(cell.facets):
            here = np.flatnonzero(inside & (skin.local == local))
            if len(here):
                corners = list(nodes)[: CELLS[kind].corners]
                middle = reference_nodes(block.kind)[corners].mean(axis=0, keepdims=True)
                slopes = shape_functions(cell.code, np.ascontiguousarray(middle))[1][0]
                own = block.nodes[skin.cells[here] - first]
                map_, moved = (np.swapaxes(values[own], 1, 2) @ slopes for values in (skin.points, displacement))
                result[here] = moved @ np.linalg.pinv(map_)  # cells may be degenerate there
    return result


def _tangents(normal: Array) -> Array:
    """Orthonormal directions along surfaces, (n, dim - 1, dim)."""
    if normal.shape[1] == 2:
        return np.stack([-normal[:, 1], normal[:, 0]], axis=1)[:, None]
    axis = np.eye(3)[np.abs(normal).argmin(axis=1)]
    one = np.cross(axis, normal)
    one /= np.linalg.norm(one, axis=1, keepdims=True)
    return np.stack([one, np.cross(normal, one)], axis=1)
