"""Tangential jumps of a contact pair: operators for the slip of the contactor over its target, and a frame for it at every
node of the contactor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.coupling import IntegrationPoints
from abut.dofs import component_of, dofs_at, n_dofs, n_places, place_of
from abut.mesh.surface import Surface
from abut.types import Sparse

UNEVEN = 1e-6  # difference of the shares that supports hold of two tangents, above which the frame follows them
HELD = 1e-9  # share of a tangent along which a node can move, below which it cannot
Array = NDArray[np.float64]


@dataclass(frozen=True)
class SlipOperators:
    """Of slip and of its forces, facet by facet. along: (9 n_facets, dim n_points) sparse for each direction d, int H_k d .
    (u_C - u_T), theory (R1), or its target's part alone where only that is asked for; arms: (9 n_facets, 3) int H_k (x_C -
    x_T), in 2D its size (9 n_facets, 1), theory (R12), None where tractions have no couple, theory (G4)."""

    along: tuple[Sparse, ...]
    arms: Array | None


def slip_operators(at: IntegrationPoints, points: Array) -> SlipOperators:
    """For directions d in the tangent plane of each integration point: in 2D the normal turned by a right angle, in 3D the
    three axes less their normal parts. points: (n_points, dim) of the mesh."""
    return SlipOperators(_along(at, at.gap_operator.tocoo()), _arms(at, points))


def target_operators(at: IntegrationPoints, target: Surface) -> SlipOperators:
    """The target's part alone: what tractions do to it, where it has points in common with the contactor."""
    entries = at.gap_operator.tocoo()
    node = place_of(entries.col, at.normal.shape[1])
    theirs = (target.nodes[at.target_facet[entries.row]] == node[:, None]).any(axis=1)
    part = sp.coo_matrix((entries.data[theirs], (entries.row[theirs], entries.col[theirs])), shape=entries.shape)
    return SlipOperators(_along(at, part), None)


def _along(at: IntegrationPoints, entries: Sparse) -> tuple[Sparse, ...]:
    """entries: of ``at.gap_operator``, all or some."""
    normal = at.normal
    dim = normal.shape[1]
    along = entries.data * normal[entries.row, component_of(entries.col, dim)]
    shapes = sp.csr_matrix(  # of the contactor, minus those of the target: the normal part of each, put together
        (along, (entries.row, place_of(entries.col, dim))), shape=(len(normal), n_places(entries.shape[1], dim))
    )
    if dim == 2:
        fields = [turned(normal)]
    else:
        fields = [np.eye(dim)[a] - normal * normal[:, [a]] for a in range(dim)]
    return tuple(_integrated(at, shapes, field) for field in fields)


def _arms(at: IntegrationPoints, points: Array) -> Array:
    """int H_k (x_C - x_T), (9 n_facets, 3); in 2D its size (9 n_facets, 1): theory (R12)."""
    gap = at.weight * (at.gap_operator @ points.ravel())
    field = gap[:, None] if points.shape[1] == 2 else gap[:, None] * at.normal
    return np.asarray(at.pressure.T @ field)


def _integrated(at: IntegrationPoints, shapes: Sparse, field: Array) -> Sparse:
    """int H_k d . (u_C - u_T); field: (n, dim) the direction d at every integration point."""
    dim, parts = field.shape[1], []
    for a in range(dim):
        scalar = (at.pressure.T @ sp.diags(at.weight * field[:, a]) @ shapes).tocoo()
        where = scalar.row, dofs_at(scalar.col, dim)[:, a]
        parts.append(sp.csr_matrix((scalar.data, where), shape=(scalar.shape[0], n_dofs(scalar.shape[1], dim))))
    return sum(parts[1:], parts[0])


def turned(normal: Array) -> Array:
    """Unit normals (n, 2) turned by a right angle, against the clock."""
    return np.column_stack([-normal[:, 1], normal[:, 0]])


def frames(normals: Array, moves: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Tangents (n, dim - 1, dim) square to each other and to unit normals (n, dim), and which of them, (n, dim - 1) bool,
    point where the contactor's node can move.

    moves: (n, dim, dim), projector on the directions in which each node can move. In 3D the frame follows what supports
    hold, so that a tangent is free or held and never both; else its first tangent is the axis nearest to the plane."""
    dim = normals.shape[1]
    if dim == 2:
        tangents = turned(normals)[:, None]
    else:
        axis = np.eye(dim)[np.abs(normals).argmin(axis=1)]
        first = axis - normals * np.einsum("nd,nd->n", axis, normals)[:, None]
        first /= np.linalg.norm(first, axis=1, keepdims=True)
        tangents = np.stack([first, np.cross(normals, first)], axis=1)
        inside = np.einsum("nad,nde,nbe->nab", tangents, moves, tangents)
        level = 0.5 * np.trace(inside, axis1=1, axis2=2)[:, None, None] * np.eye(2)
        uneven = np.abs(inside - level).max(axis=(1, 2), initial=0.0) > UNEVEN
        turn = np.linalg.eigh(inside[uneven])[1]
        tangents[uneven] = np.einsum("nab,nad->nbd", turn, tangents[uneven])
    free = np.einsum("nad,nde,nae->na", tangents, moves, tangents) > HELD
    return tangents, free
