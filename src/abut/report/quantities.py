"""What the picture shows of bodies: scalars of the displacement and the stress, and their smallest and largest values."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.materials.invariants import max_shear, principal, von_mises
from abut.materials.plastic import EQUIVALENT
from abut.materials.prestressed import INITIAL
from abut.mesh.mesh import Mesh
from abut.solution import ContactResult, Solution, Step
from abut.solution.grids import cell_error, largest_pressure

Values = NDArray[np.float64]
OF_STRESS = ("von Mises", "largest principal stress", "smallest principal stress")
SIZE, ERROR, PLASTIC, SHEAR = "displacement", "stress error", "plastic strain", "largest shear stress"
BEFORE = "initial von Mises"


@dataclass(frozen=True)
class Extremes:
    """A quantity at the nodes of the bodies in every step: low, high (n_steps, n_bodies) its values there, low_at, high_at
    the mesh's points; NaN and -1 where a body does not have it."""

    low: Values
    high: Values
    low_at: NDArray[np.int64]
    high_at: NDArray[np.int64]

    @property
    def ranges(self) -> list[list[float] | None]:
        """Over all steps, of all bodies and of each: [least, largest], or None."""
        columns = [slice(None), *(slice(i, i + 1) for i in range(self.low.shape[1]))]
        return [_range(self.low[:, own], self.high[:, own]) for own in columns]


def of_stress(stress: Values) -> dict[str, Values]:
    """Scalars of stresses (n, 6) by their names, (n,). Between nodes take them of the stress there: parabolas through a
    scalar's own values at nodes fall below what it can be."""
    roots = principal(stress)
    return {"von Mises": von_mises(stress), OF_STRESS[1]: roots[:, 0], OF_STRESS[2]: roots[:, 2]}


def node_error(mesh: Mesh, step: Step) -> Values | None:
    """The estimated error of stresses at the points of a mesh, (n_points,): the largest of the cells there."""
    error = cell_error(step)
    if error is None:
        return None
    result = np.zeros(len(mesh.points))
    for block, first in zip(mesh.blocks, mesh.starts):
        own = error[first : first + len(block.nodes)]
        np.maximum.at(result, block.nodes, own[:, None])
    return result


def of_nodes(mesh: Mesh, step: Step) -> dict[str, Values]:
    """What is known at the points of a mesh beside displacement and stress, (n_points,), by its name in the picture."""
    error, flow, initial = node_error(mesh, step), step.remembered.get(EQUIVALENT), step.remembered.get(INITIAL)
    before = None if initial is None else von_mises(initial)
    return {name: values for name, values in ((ERROR, error), (PLASTIC, flow), (BEFORE, before)) if values is not None}


def extremes(solution: Solution) -> dict[str, Extremes]:
    """Smallest and largest values of every quantity of bodies at their nodes. Stresses only of bodies that give way."""
    mesh = solution.model.mesh
    nodes = [mesh.nodes_of(body) for body in mesh.bodies]
    strained = {solid.body for solid in solution.model.solids}
    solid = [own if body in strained else own[:0] for body, own in zip(mesh.bodies, nodes)]
    found: dict[str, list[list[tuple[float, float, int, int]]]] = {}
    for step in solution.steps:
        fields = {SIZE: np.linalg.norm(step.displacement, axis=1), **of_stress(step.stress)}
        fields |= {SHEAR: max_shear(step.stress), **of_nodes(mesh, step)}
        for name, values in fields.items():
            found.setdefault(name, []).append([_ends(values, own) for own in (nodes if name == SIZE else solid)])
    return {name: _extremes(rows) for name, rows in found.items()}


def _ends(values: Values, nodes: NDArray[np.int64]) -> tuple[float, float, int, int]:
    own = values[nodes]
    if not np.isfinite(own).any():
        return np.nan, np.nan, -1, -1
    low, high = int(np.nanargmin(own)), int(np.nanargmax(own))
    return float(own[low]), float(own[high]), int(nodes[low]), int(nodes[high])


def _extremes(rows: list[list[tuple[float, float, int, int]]]) -> Extremes:
    table = np.array(rows, dtype=float)
    at = table[..., 2:].astype(np.int64)
    return Extremes(table[..., 0], table[..., 1], at[..., 0], at[..., 1])


def _range(low: Values, high: Values) -> list[float] | None:
    return [float(np.nanmin(low)), float(np.nanmax(high))] if np.isfinite(low).any() else None


def contact_ranges(solution: Solution) -> dict[str, list[list[float] | None]]:
    """Ranges over all steps of what contacts have, at the nodes of their contactors."""
    contacts = [contact for step in solution.steps for contact in step.contacts]
    ranges: dict[str, list[list[float] | None]] = {}
    top = largest_pressure(solution.steps)
    if contacts:
        ranges["pressure"] = [[0.0, top]]
    for name, field in _ON_CONTACTS.items():
        some = [values[np.isfinite(values)] for values in map(field, contacts) if values is not None]
        every = np.concatenate([*some, np.empty(0)])
        if len(every):
            ranges[name] = [[float(every.min()), float(every.max())]]
    return ranges


_ON_CONTACTS: Mapping[str, Callable[[ContactResult], Values | None]] = {
    "gap": lambda c: c.gap,
    "traction": lambda c: None if c.friction is None else np.linalg.norm(c.friction.traction, axis=2),
    "slip": lambda c: None if c.friction is None else np.linalg.norm(c.friction.total_slip, axis=2),
    "slip in the step": lambda c: None if c.friction is None else _moved(c),
    "friction work": lambda c: None if c.friction is None else c.friction.total_work_per_area,
}


def _moved(contact: ContactResult) -> Values:
    """Sizes of the slip in the step where surfaces touch, (n_facets, 9)."""
    assert contact.friction is not None
    return np.where(contact.friction.status > 0, np.linalg.norm(contact.friction.slip, axis=2), np.nan)


def peak_steps(solution: Solution, of_bodies: Mapping[str, Extremes]) -> list[int]:
    """Steps that must be shown: the last, and those in which a quantity has its largest value (index into the steps)."""
    chosen = {len(solution.steps) - 1}
    for name, own in of_bodies.items():
        if name not in (ERROR, SHEAR, BEFORE) and np.isfinite(own.high).any():
            chosen.add(int(np.unravel_index(np.nanargmax(own.high), own.high.shape)[0]))
    for i in range(len(solution.contacts)):
        pressures = [step.contacts[i].max_pressure for step in solution.steps]
        if np.isfinite(pressures).any():
            chosen.add(int(np.nanargmax(pressures)))
        tractions = [f.max_traction for step in solution.steps if (f := step.contacts[i].friction) is not None]
        if len(tractions) == len(solution.steps):
            chosen.add(int(np.argmax(tractions)))
    return sorted(chosen)


def largest_by_body(solution: Solution, of_bodies: Mapping[str, Extremes]) -> tuple[list[str], list[list[str]]]:
    """Head and rows of a table: largest values at the nodes of each body over all steps, where and when."""
    mesh, several = solution.model.mesh, len(solution.steps) > 1
    columns = [
        ("largest von Mises stress", "von Mises", True),
        ("largest principal stress", OF_STRESS[1], True),
        ("smallest principal stress", OF_STRESS[2], False),
        ("largest shear stress", SHEAR, True),
        ("largest displacement", SIZE, True),
    ]
    head, rows = ["body", *(title for title, _, _ in columns)], []
    for number, body in enumerate(mesh.bodies):
        cells = [body]
        for _, name, high in columns:
            own = of_bodies[name]
            values, at = (own.high, own.high_at) if high else (-own.low, own.low_at)
            if not np.isfinite(values[:, number]).any():
                cells.append("rigid")
                continue
            step = int(np.nanargmax(values[:, number]))
            value = values[step, number] if high else -values[step, number]
            point = ", ".join(f"{x:.4g}" for x in mesh.points[at[step, number]])
            when = f", step {solution.steps[step].number}" if several else ""
            cells.append(f"{value:.6g} at ({point}){when}")
        rows.append(cells)
    return head, rows
