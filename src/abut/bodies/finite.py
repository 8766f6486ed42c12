"""Forces, tangent stiffness, stresses and strain energy of solids under finite strains; theory (D1), (D2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from abut._core import integrate_hyperelastic
from abut.bodies.assemble import matrix_of, no_values
from abut.bodies.solids import UNHEATED, Array, Group, Solids, TemperatureChange
from abut.bodies.stress import averaged, to_nodes
from abut.errors import Unsound
from abut.materials.hyperelastic import law
from abut.mesh.quadrature import Rule, stress_rule
from abut.types import Operator


class Inverted(Unsound):
    """A cell without a sound deformation. cell: its number; body: its name; determinant: of the deformation gradient."""

    def __init__(self, cell: int, body: str, determinant: float) -> None:
        self.cell, self.body, self.determinant = cell, body, determinant
        what = (
            f"turns inside out (det F = {determinant:.3g} at an integration point)"
            if determinant <= 0.0
            else f"has no stretch out of the plane without stress there (det F = {determinant:.3g})"
        )
        super().__init__(f"cell {cell} of body '{body}' {what}")


@dataclass(frozen=True)
class FiniteResponse:
    """force: (dim n_points,) of the stresses; tangent: its derivative, (dim n_points, dim n_points) CSR with sorted rows, or
    None; energy: (n_cells,) elastic energy of each cell, per unit thickness in 2D, all round if axisymmetric."""

    force: Array
    tangent: Operator
    energy: Array


def respond_finite(
    solids: Solids, displacement: Array, temperature: TemperatureChange = UNHEATED, tangent: bool = True
) -> FiniteResponse:
    """Internal force at a displacement (n_points, dim), tangent (unless not wanted), and energy. Raises Inverted."""
    force, energy = np.zeros(solids.points.shape), np.zeros(solids.mesh.n_cells)
    values = no_values(solids) if tangent else None
    moved = np.ascontiguousarray(displacement, dtype=float)
    for group in solids.groups():
        energies = np.zeros(len(group.cells))
        _integrate(
            solids, group, moved, temperature, force=force,
            tangent=None if values is None else (*solids.pattern, values), energy=energies,
        )  # fmt: skip
        energy[group.cells] = energies
    return FiniteResponse(force.ravel(), None if values is None else matrix_of(solids, values), energy)


def cauchy_stress(solids: Solids, displacement: Array, temperature: TemperatureChange = UNHEATED) -> Array:
    """Cauchy stress xx yy zz xy yz zx at the points, (n_points, 6), in the fixed axes, averaged over the cells of a point as
    ``abut.bodies.stress.nodal_stress`` does. Raises Inverted."""
    sums = cauchy_sums(solids, displacement, temperature)
    if sums.unsound:
        sums = cauchy_sums(solids, displacement, temperature, sums.unsound)
    return averaged(sums.total, sums.count)


@dataclass(frozen=True)
class CauchySums:
    """Sums of stresses at the points (n_points, 6), and of how many cells (n_points,); unsound: groups of cells (type, law,
    integration) left out because a cell of them is inside out at a point where stresses are taken."""

    total: Array
    count: Array
    unsound: frozenset[tuple[str, int, str]]


def cauchy_sums(
    solids: Solids,
    displacement: Array,
    temperature: TemperatureChange = UNHEATED,
    coarse: frozenset[tuple[str, int, str]] = frozenset(),
) -> CauchySums:
    """What ``cauchy_stress`` averages; sums of parts of a mesh add up. coarse: groups of cells whose stresses are taken at
    the integration points, where they are sound if the forces are. Raises Inverted for these."""
    total, count = np.zeros((len(solids.points), 6)), np.zeros(len(solids.points))
    moved = np.ascontiguousarray(displacement, dtype=float)
    unsound = set()
    for group in solids.groups():
        key = group.kind, group.law, group.integration
        rule = group.rule if key in coarse else stress_rule(group.kind)
        try:
            sums = _nodal_sums(solids, group, moved, temperature, rule)
        except Inverted:
            if key in coarse:
                raise
            unsound.add(key)
            continue
        total, count = total + sums[0], count + sums[1]
    return CauchySums(total, count, frozenset(unsound))


def _nodal_sums(
    solids: Solids, group: Group, moved: Array, temperature: TemperatureChange, rule: Rule
) -> tuple[Array, Array]:
    """Stresses of a group's cells at the points, (n_points, 6), and of how many cells (n_points,)."""
    total, count = np.zeros((len(solids.points), 6)), np.zeros(len(solids.points))
    _integrate(
        solids, group, moved, temperature, nodal=(to_nodes(group.kind, rule[0]), total, count), rule=rule
    )  # fmt: skip
    return total, count


def is_symmetric(solids: Solids) -> bool:
    """Whether the tangent is symmetric: F-bar's is not."""
    return "b-bar" not in {solids.integration.get(body, "full") for body in solids.materials}


def _integrate(
    solids: Solids,
    group: Group,
    moved: Array,
    temperature: TemperatureChange,
    rule: Rule | None = None,
    **wanted: object,
) -> None:
    constants = solids.by_cell(group, {body: (law(m) or (0, (0.0, 0.0)))[1] for body, m in solids.materials.items()})
    unsound = integrate_hyperelastic(
        group.arrays(solids, rule or group.rule), constants, group.law,
        solids.plane == "stress", moved, temperature.strain(solids, group), **wanted,
    )  # fmt: skip
    if unsound is not None:
        cell = int(group.cells[unsound[0]])
        raise Inverted(cell, list(solids.materials)[solids.body_of[cell]], unsound[1])
