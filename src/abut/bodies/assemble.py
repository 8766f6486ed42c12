"""Forces and stiffness of solids at a displacement; dof of component a at point i: dim i + a. Forces per unit
thickness in 2D, all round if axisymmetric."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from abut._core import block_pattern, integrate_given, integrate_isotropic
from abut.bodies.evaluation import History, evaluate
from abut.bodies.solids import UNHEATED, Array, Group, Solids, TemperatureChange
from abut.materials.elastic import LinearElastic, lame
from abut.materials.hyperelastic import at_rest
from abut.mesh.quadrature import cell_rule
from abut.types import Operator, Sparse


@dataclass(frozen=True)
class Response:
    """force: (dim n_points,) of the stresses; tangent: its derivative, (dim n_points, dim n_points) CSR with sorted rows, or
    None; history: the new one."""

    force: Array
    tangent: Operator
    history: History


def stiffness(solids: Solids) -> Sparse:
    """Stiffness matrix of all bodies at rest, theory (F4), (dim n_points, dim n_points) CSR with sorted rows; for constant
    materials the tangent everywhere. Finite strains begin with the same one."""
    if solids.kinematics == "finite":
        solids = replace(solids, kinematics="small", materials={b: at_rest(m) for b, m in solids.materials.items()})
    values = no_values(solids)
    for group in solids.groups():
        _add(solids, group, None, UNHEATED, None, None, values)
    return matrix_of(solids, values)


def internal_force(
    solids: Solids, displacement: Array, temperature: TemperatureChange = UNHEATED, history: History | None = None
) -> Array:
    """int B^T sigma, theory (E4), (dim n_points,), at a displacement (n_points, dim) after a history (None: the initial)."""
    return respond(solids, displacement, temperature, history, tangent=False).force


def tangent(
    solids: Solids, displacement: Array, temperature: TemperatureChange = UNHEATED, history: History | None = None
) -> Sparse:
    """Derivative of ``internal_force`` by the displacement, CSR as ``stiffness``."""
    return respond(solids, displacement, temperature, history).tangent


def respond(
    solids: Solids,
    displacement: Array,
    temperature: TemperatureChange = UNHEATED,
    history: History | None = None,
    tangent: bool = True,
) -> Response:
    """Internal force, tangent (unless not wanted) and new history together.

    Raises InputError for a material that returns arrays of other shapes than it should."""
    force = np.zeros(solids.points.shape)
    values = no_values(solids) if tangent else None
    moved = np.ascontiguousarray(displacement, dtype=float)
    after: dict[str, list[Array]] = {}
    for group in solids.groups():
        after.setdefault(group.body, []).extend(_add(solids, group, moved, temperature, history, force, values))
    new = {body: np.concatenate(parts) for body, parts in after.items() if body}
    return Response(force.ravel(), matrix_of(solids, values) if values is not None else None, new)


def thermal_load(solids: Solids, temperature: TemperatureChange) -> Array:
    """int B^T D eps_thermal of linear bodies, theory (F10), (dim n_points,): the forces that would expand them freely.
    Integrated like the stiffness, so that a temperature whose strain the elements can follow leaves no stress; "b-bar" takes
    the mean over each cell, as for the dilatation."""
    if all(temperature.strain(solids, group) is None for group in solids.groups()):
        return np.zeros(solids.points.size)
    return -internal_force(solids, np.zeros(solids.points.shape), temperature)


def _add(
    solids: Solids,
    group: Group,
    displacement: Array | None,
    temperature: TemperatureChange,
    history: History | None,
    force: Array | None,
    values: Array | None,
) -> list[Array]:
    """Adds the cells of a group to force and values of the tangent, in place; returns their new history, in parts."""
    entries = None if values is None else (*solids.pattern, values)
    rule = cell_rule(group.kind, group.integration)
    if not group.body:
        integrate_isotropic(
            group.arrays(solids, rule), moduli(solids, group), solids.plane == "stress", displacement,
            temperature.strain(solids, group), force, entries,
        )  # fmt: skip
        return []
    after = []
    for part, (stress, slope, new) in evaluate(solids, group, rule, displacement, temperature, history):
        integrate_given(part, stress, None if values is None else slope, force, entries)
        after.append(new)
    return after


def moduli(solids: Solids, group: Group) -> Array:
    """Lame's constants of each cell of linear elastic bodies, (cells, 2); lambda reduced in plane stress."""
    return solids.by_cell(
        group,
        {
            body: lame(m, solids.plane) if isinstance(m, LinearElastic) else (0, 0)
            for body, m in solids.materials.items()
        },
    )


def no_values(solids: Solids) -> Array:
    return np.zeros(len(solids.pattern[1]) * solids.mesh.dim**2)


def matrix_of(solids: Solids, values: Array) -> Sparse:
    indptr, indices = block_pattern(*solids.pattern, solids.mesh.dim)
    if len(values) < 2**31:
        indptr = indptr.astype(np.int32)
    matrix = sp.csr_matrix((values, indices, indptr), shape=(solids.points.size,) * 2)
    matrix.has_sorted_indices = True
    return matrix
