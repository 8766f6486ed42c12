"""Forces and stiffness of solids at a displacement; dof of component a at point i: dim i + a. Forces per unit
thickness in 2D, all round if axisymmetric."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import cast

import numpy as np
import scipy.sparse as sp

from abut.bodies.continuous import pressure_response, pressure_stiffness
from abut.bodies.evaluation import History
from abut.bodies.integrate import integrate
from abut.bodies.solids import UNHEATED, Array, Solids, TemperatureChange
from abut.bordered import eliminated
from abut.materials.kernel import Since, Wanted
from abut.materials.material import linear, symmetric
from abut.types import Operator, Sparse


@dataclass(frozen=True)
class Response:
    """force: (dim n_points,) of the stresses; tangent: its derivative, (dim n_points, dim n_points) CSR with sorted rows, a
    ``Bordered`` of continuous pressures where there are any, or None; history: the new one; energy: (n_cells,) elastic
    energy of each cell, per unit thickness in 2D, all round if axisymmetric: under finite strains, and of laws in the
    compiled core that have a history; not a number of other bodies under finite strains."""

    force: Array
    tangent: Operator
    history: History
    energy: Array


def stiffness(solids: Solids) -> Sparse:
    """Stiffness matrix of all bodies at rest, theory (F4), (dim n_points, dim n_points) CSR with sorted rows; for constant
    materials the tangent everywhere. Finite strains begin with the same one."""
    return cast(Sparse, eliminated(stiffness_at_rest(solids)))


def stiffness_at_rest(solids: Solids) -> Operator:
    """The same, with continuous pressures as its border where there are any."""
    if solids.kinematics == "finite":
        rest = {body: linear(material) or material for body, material in solids.materials.items()}
        solids = replace(solids, kinematics="small", materials=rest)
    values = _no_values(solids)
    for group in solids.groups():
        wanted = Wanted(tangent=(*solids.pattern, values))
        integrate(solids, group, group.rule, None, UNHEATED, None, wanted)
    matrix, more = _matrix_of(solids, values), pressure_stiffness(solids)
    return matrix if more is None else more + matrix


def internal_force(
    solids: Solids, displacement: Array, temperature: TemperatureChange = UNHEATED, history: History | None = None
) -> Array:
    """int B^T sigma, theory (E4), (dim n_points,), at a displacement (n_points, dim) after a history (None: the initial)."""
    return respond(solids, displacement, temperature, history, tangent=False).force


def tangent(
    solids: Solids, displacement: Array, temperature: TemperatureChange = UNHEATED, history: History | None = None
) -> Sparse:
    """Derivative of ``internal_force`` by the displacement, CSR as ``stiffness``."""
    return cast(Sparse, eliminated(respond(solids, displacement, temperature, history).tangent))


def respond(
    solids: Solids,
    displacement: Array,
    temperature: TemperatureChange = UNHEATED,
    history: History | None = None,
    tangent: bool = True,
    since: Since | None = None,
) -> Response:
    """Internal force, tangent (unless not wanted), new history and energy together; of finite strains theory (D1), (D2).
    since: from where Newton's method came; the tangent is then that of theory (D24).

    Raises InputError for a material that returns arrays of other shapes than it should, and Inverted."""
    force, energy = np.zeros(solids.points.shape), np.zeros(solids.mesh.n_cells)
    values = _no_values(solids) if tangent else None
    entries = None if values is None else (*solids.pattern, values)
    moved = np.ascontiguousarray(displacement, dtype=float)
    after: dict[str, list[Array]] = {}
    for group in solids.groups():
        of_cells = np.zeros(len(group.cells))
        wanted = Wanted(force, entries, energy=of_cells)
        new = integrate(solids, group, group.rule, moved, temperature, history, wanted, since)
        energy[group.cells] = of_cells
        after.setdefault(group.body, []).extend(new)
    history = {body: parts[0] if len(parts) == 1 else np.concatenate(parts) for body, parts in after.items() if body}
    total = force.ravel()
    slope: Operator = None if values is None else _matrix_of(solids, values)
    more = pressure_response(solids, moved, temperature, tangent, since)
    if more is not None:
        total, energy = total + more.force, energy + more.energy
        slope = None if slope is None or more.tangent is None else more.tangent + slope
    return Response(total, slope, history, energy)


def is_symmetric(solids: Solids) -> bool:
    """Whether the tangent under finite strains is symmetric: F-bar's is not; bodies that are integrated together have
    energies, others' laws say it."""
    alike = "b-bar" not in {solids.integration.get(body, "full") for body in solids.materials}
    return alike and all(not group.body or symmetric(solids.materials[group.body]) for group in solids.groups())


def thermal_load(solids: Solids, temperature: TemperatureChange) -> Array:
    """int B^T D eps_thermal, theory (F10), (dim n_points,): the forces that would expand linear bodies freely; of others
    what keeps their shape at zero displacement. Integrated like the stiffness, so that a temperature whose strain the
    elements can follow leaves no stress; "b-bar" takes the mean over each cell, as for the dilatation."""
    if not temperature.acts(solids):
        return np.zeros(solids.points.size)
    return -internal_force(solids, np.zeros(solids.points.shape), temperature)


def _no_values(solids: Solids) -> Array:
    return np.zeros(len(solids.pattern[1]) * solids.mesh.dim**2)


def _matrix_of(solids: Solids, values: Array) -> Sparse:
    indptr, indices = solids.rows
    matrix = sp.csr_matrix((values, indices, indptr), shape=(solids.points.size,) * 2)
    matrix.has_sorted_indices = True
    return matrix
