"""Consistent nodal forces of loads on surfaces, all facet types, and in bodies, all cell types."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.cells import BY_CODE, CELLS
from abut.fields import Given, evaluate
from abut.mesh.integrals import body_chunks, gradients
from abut.mesh.mesh import Mesh
from abut.mesh.quadrature import facet_rule, field_rule, stiffness_rule
from abut.mesh.surface import Surface, around
from abut.types import Array


def facet_points(surface: Surface) -> Iterator[tuple[NDArray[np.int32], Array, Array, Array, Array]]:
    """Integration points of the n facets of each kind: nodes (n, k), shape functions (q, k), weights (q,), normals as long
    as the area is beside that of the reference facet (n, q, dim), coordinates (n, q, dim)."""
    for code in np.unique(surface.kinds):
        cell = CELLS[BY_CODE[code].name]
        nodes = surface.nodes[surface.kinds == code, : cell.nodes]
        xi, weights = facet_rule(cell.name)
        values, derivatives = shape_functions(cell.code, np.ascontiguousarray(xi))
        tangents = np.einsum("qna,fnd->fqad", derivatives, surface.points[nodes])
        if surface.dim == 2:
            normal = np.stack([tangents[..., 0, 1], -tangents[..., 0, 0]], axis=-1)
        else:
            normal = np.cross(tangents[..., 0, :], tangents[..., 1, :])
        yield nodes, values, weights, normal, np.einsum("qn,fnd->fqd", values, surface.points[nodes])


def _spread(surface: Surface, given: Given, rank: int, name: str = "") -> NDArray[np.float64]:
    """int N t for a traction t, uniform or a function of position; rank 1: t itself is given, rank 2: a stress whose product
    with the outward normal t is, rank 0: a stress that is the same in all directions."""
    load = np.zeros(surface.points.shape)
    for nodes, values, weights, normal, at in facet_points(surface):
        value = evaluate(given, at, name, (surface.dim,) * rank)
        if rank == 1:
            force = np.linalg.norm(normal, axis=2)[..., None] * value
        else:
            force = np.einsum("fqa,fqab->fqb", normal, value) if rank else normal * value[..., None]
        force = force * surface.around(at)[..., None]
        np.add.at(load, nodes, np.einsum("q,qn,fqd->fnd", weights, values, force))
    return load


def pressure_load(surface: Surface, value: Given, name: str = "pressure: value") -> NDArray[np.float64]:
    """Pressure (force per area, positive into the body), a number or a function of position, points (n, dim) -> (n,);
    (dim n_points,). Raises InputError, beginning with ``name``, for a function that does not return finite numbers."""
    return -_spread(surface, value, 0, name).ravel()


def stress_load(surface: Surface, stress: NDArray[np.float64]) -> NDArray[np.float64]:
    """Traction of a uniform stress (dim, dim) on the surface's outward side, (dim n_points,)."""
    return _spread(surface, stress, 2).ravel()


def traction_load(surface: Surface, value: Given, name: str = "traction: value") -> NDArray[np.float64]:
    """Traction (force per area), a vector or a function of position, points (n, dim) -> (n, dim); (dim n_points,).

    Raises InputError, beginning with ``name``, for a function that does not return a finite vector for each point."""
    return _spread(surface, value, 1, name).ravel()


def surface_area(surface: Surface) -> float:
    """Area (2D: length; axisymmetric: all round) of a surface."""
    return float(area_weights(surface).sum())


def area_weights(surface: Surface) -> NDArray[np.float64]:
    """Share of each point in the area of a surface: int N, (n_points,)."""
    first = np.zeros(surface.dim)
    first[0] = 1.0
    return np.asarray(_spread(surface, first, 1)[:, 0])


def force_load(surface: Surface, vector: NDArray[np.float64]) -> NDArray[np.float64]:
    """Total force, spread evenly over the surface, (dim n_points,)."""
    return traction_load(surface, np.asarray(vector, dtype=float) / surface_area(surface))


def body_load(mesh: Mesh, forces: Mapping[str, Given], name: str = "body force: value") -> NDArray[np.float64]:
    """int f N of a force per volume in each of the bodies named, a vector or a function of position, points (n, dim) ->
    (n, dim); (dim n_points,).

    Raises InputError, beginning with ``name``, for a function that does not return a finite vector for each point."""
    load = np.zeros(mesh.points.shape)
    dim = mesh.dim
    for body, value in forces.items():
        for kind, nodes in body_chunks(mesh, body):
            xi, weights = field_rule(kind) if callable(value) else stiffness_rule(kind)
            shapes, derivatives = shape_functions(CELLS[kind].code, np.ascontiguousarray(xi))
            at = np.einsum("qn,cnd->cqd", shapes, mesh.points[nodes])
            _, det = gradients(mesh.points, nodes, derivatives)
            density = evaluate(value, at, name, (dim,)) * (weights * det * around(at, mesh.axisymmetric))[..., None]
            np.add.at(load, nodes, np.einsum("qn,cqa->cna", shapes, density))
    return load.ravel()
