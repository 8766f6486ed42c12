"""Errors of a solution against exact fields in the norms of the theory of convergence, all relative.

Exact fields are functions of position, body by body: two bodies may differ where they touch.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.cells import BY_CODE, CELLS
from abut.contact.geometry import facet_measure
from abut.errors import InputError
from abut.fields import Field, evaluate
from abut.materials.material import Material
from abut.materials.plane_stress import law
from abut.mesh.integrals import body_chunks, gradients
from abut.mesh.quadrature import field_rule
from abut.mesh.surface import around
from abut.solution import Solution

Array = NDArray[np.float64]
Pieces = Iterator[tuple[str, Array, Array, Array, Array]]


def displacement_l2(solution: Solution, exact: Mapping[str, Field]) -> float:
    """Root of int |u_h - u|^2 over int |u|^2, both over the bodies named in ``exact``: points (n, dim) -> (n, dim)."""
    dim = solution.model.dim
    error = size = 0.0
    for body, x, weight, u, _ in _pieces(solution, exact):
        wanted = evaluate(exact[body], x, f"exact displacement of '{body}'", (dim,))
        error += float(weight @ ((u - wanted) ** 2).sum(axis=1))
        size += float(weight @ (wanted**2).sum(axis=1))
    return _ratio(error, size)


def energy_norm(solution: Solution, exact: Mapping[str, Field]) -> float:
    """Root of the elastic energy of the error u_h - u over that of u, over the bodies named in ``exact``: points
    (n, dim) -> (n, dim, dim), entry [i, j] the derivative of u_i along j. Elastic energy: that of the strains alone, as
    if no temperature changed.

    Raises InputError for axisymmetric models, whose hoop strain is no gradient."""
    model = solution.model
    if model.plane == "axisymmetric":
        raise InputError("energy norm: axisymmetric models are not supported")
    dim = model.dim
    error = size = 0.0
    for body, x, weight, _, slope in _pieces(solution, exact):
        wanted = evaluate(exact[body], x, f"exact gradient of '{body}'", (dim, dim))
        material = model.deformable.materials[body]
        error += float(weight @ _energy(slope - wanted, material, model.plane))
        size += float(weight @ _energy(wanted, material, model.plane))
    return _ratio(error, size)


def pressure_l2(solution: Solution, exact: Field, contact: int = 0) -> float:
    """Root of int (p_h - p)^2 over int p^2, over the covered facets of a contact's contactor. ``exact``: points (n, dim) ->
    (n,), compression positive."""
    result = solution.contacts[contact]
    surface = result.contactor
    error = size = 0.0
    for code in np.unique(surface.kinds[result.covered]):
        cell = BY_CODE[code]
        facets = np.flatnonzero((surface.kinds == code) & result.covered)
        xi, weights = field_rule(cell.name)
        shapes, _ = shape_functions(code, np.ascontiguousarray(xi))
        x, _, area = facet_measure(surface, cell.name, facets, xi)
        area = area * weights
        wanted = evaluate(exact, x, "exact pressure")
        error += float((area * (result.pressure[facets, : cell.nodes] @ shapes.T - wanted) ** 2).sum())
        size += float((area * wanted**2).sum())
    return _ratio(error, size)


def _pieces(solution: Solution, bodies: Mapping[str, Field]) -> Pieces:
    """Of the integration points of each body: its name, positions (n, dim), weights (n,), displacement (n, dim) and its
    gradient (n, dim, dim)."""
    mesh = solution.model.mesh
    dim = mesh.dim
    for body in bodies:
        for kind, nodes in body_chunks(mesh, body):
            xi, weights = field_rule(kind)
            shapes, derivatives = shape_functions(CELLS[kind].code, np.ascontiguousarray(xi))
            slopes, det = gradients(mesh.points, nodes, derivatives)
            moved = solution.displacement[nodes]
            x = np.einsum("qn,cna->cqa", shapes, mesh.points[nodes])
            u = np.einsum("qn,cna->cqa", shapes, moved)
            weight = weights * det * around(x, mesh.axisymmetric)
            slope = np.matmul(moved.transpose(0, 2, 1)[:, None], slopes)
            yield body, x.reshape(-1, dim), weight.ravel(), u.reshape(-1, dim), slope.reshape(-1, dim, dim)


def _energy(slope: Array, material: Material, plane: str | None) -> Array:
    """Stress times strain of gradients (n, dim, dim), (n,); strains out of the plane have no part in it."""
    n, dim = slope.shape[:2]
    full = np.zeros((n, 3, 3))
    full[:, :dim, :dim] = slope
    once, again = [0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]
    strain = full[:, once, again]
    strain[:, 3:] += full[:, again, once][:, 3:]
    _, (stress, _, _) = law(material.evaluate, plane)(strain, material.initial(n))
    return np.asarray((stress * strain).sum(axis=1))


def _ratio(error: float, size: float) -> float:
    return float(np.sqrt(error / size)) if size > 0.0 else float(np.sqrt(error))
