"""Forces, stiffness and stresses of pressures that are continuous: what ``integrate`` leaves out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from abut.bodies.corner_pressures import KIND, CornerPressures, Turned, Volumes, linear_functions
from abut.bodies.inverted import Inverted
from abut.bodies.solids import Array, Solids, TemperatureChange
from abut.bordered import Bordered
from abut.materials.kernel import Since


@dataclass(frozen=True)
class PressureResponse:
    """force: (dim n_points,); tangent: its derivative, None where it was not asked for; energy: (n_cells,), as in
    ``abut.bodies.assemble.Response``."""

    force: Array
    tangent: Bordered | None
    energy: Array


def pressure_stiffness(solids: Solids) -> Bordered | None:
    """Of bodies at rest, under small strains; None without such pressures."""
    of = solids.pressures
    if of is None:
        return None
    return of.stiffness(of.at_rest.rows, of.evaluate(np.zeros(of.count), None, False)[2])


def pressure_response(
    solids: Solids, displacement: Array, temperature: TemperatureChange, tangent: bool, since: Since | None = None
) -> PressureResponse | None:
    """At displacements (n_points, dim); None without such pressures. since: as in ``abut.bodies.assemble.respond``. Raises
    Inverted, under finite strains."""
    of, finite = solids.pressures, solids.kinematics == "finite"
    if of is None:
        return None
    now, growth = _volumes(solids, of, displacement)
    energy, pressure, bend = of.evaluate(growth, _swelling(solids, of, temperature), finite)
    force = np.asarray(now.rows.T @ (of.volume * pressure))
    slope = None
    if tangent:
        bending = None
        if finite:
            foreseen = pressure - bend * _unforeseen(of, displacement, growth, since)
            bending = of.bending(displacement, foreseen, solids.pattern, solids.rows)
        slope = of.stiffness(now.rows, bend, bending)
    of_cells = np.zeros(solids.mesh.n_cells)
    if not solids.constant:
        of_cells[of.cells] = (of.shares * energy[of.corner]).sum(axis=1)
    return PressureResponse(force, slope, of_cells)


def corner_pressures(solids: Solids, displacement: Array, temperature: TemperatureChange) -> Array | None:
    """Mean stresses (n_corners,), > 0 in tension, that these pressures add; None without. Raises Inverted."""
    of = solids.pressures
    if of is None:
        return None
    growth = _volumes(solids, of, displacement)[1]
    return of.evaluate(growth, _swelling(solids, of, temperature), solids.kinematics == "finite")[1]


def add_pressures(solids: Solids, displacement: Array, temperature: TemperatureChange, stress: Sequence[Array]) -> None:
    """Adds them to stresses at the integration points of each of ``solids.groups()``, in place."""
    of, pressure = solids.pressures, corner_pressures(solids, displacement, temperature)
    if of is None or pressure is None:
        return
    row = np.full(solids.mesh.n_cells, -1)
    row[of.cells] = np.arange(len(of.cells))
    for group, values in zip(solids.groups(), stress):
        at = row[group.cells]
        if group.kind == KIND and (at >= 0).any():
            here = np.where(at[:, None] >= 0, pressure[of.corner[at]], 0.0)
            values[..., :3] += (here @ linear_functions(group.rule[0]).T)[..., None]


def _volumes(solids: Solids, of: CornerPressures, displacement: Array) -> tuple[Volumes, Array]:
    """Means about the corners, and how much they have grown."""
    if solids.kinematics == "small":
        return of.at_rest, np.asarray(of.at_rest.rows @ displacement.ravel())
    now = of.at(displacement)
    if isinstance(now, Turned):
        cell = int(of.cells[now.row])
        raise Inverted(cell, list(solids.materials)[solids.body_of[cell]], now.determinant)
    return now, now.growth


def _unforeseen(of: CornerPressures, displacement: Array, growth: Array, since: Since | None) -> Array:
    """Growth of the volumes beyond what Newton's method foresaw, theory (D24); none where it came from nowhere, or from
    where volumes have turned inside out."""
    before = None if since is None else of.at(since.displacement)
    if since is None or not isinstance(before, Volumes):
        return np.zeros(of.count)
    more = growth - before.growth
    return more if since.guessed else more - before.rows @ (displacement - since.displacement).ravel()


def _swelling(solids: Solids, of: CornerPressures, temperature: TemperatureChange) -> Array | None:
    """Thermal strains at the corners, None without."""
    row = np.full(solids.mesh.n_cells, -1)
    row[of.cells] = np.arange(len(of.cells))
    thermal, warm = np.zeros(of.nodes.shape), False
    for group in solids.groups():
        at = row[group.cells]
        own = temperature.strain(solids, group) if group.kind == KIND and (at >= 0).any() else None
        if own is not None:
            thermal[at[at >= 0]], warm = own[at >= 0], True
    return of.by_corner(thermal) if warm else None
