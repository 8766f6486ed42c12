"""A solution as grids for viewers: cells, points and named arrays, for VTU files and PyVista."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.cells import BY_CODE, CELLS
from abut.materials.invariants import von_mises
from abut.mesh.mesh import Mesh
from abut.mesh.surface import Surface
from abut.solution import ContactResult, Step
from abut.solution.contacts import FrictionResult
from abut.types import Array

NOT_COVERED, OPEN, CLOSED = 0, 1, 2
CONTACTOR, TARGET = 0, 1
TOUCHING = 1e-9  # pressure over the largest from which on a facet is shown as closed: less is rounding


@dataclass(frozen=True)
class Grid:
    """points (n, 2 or 3); blocks of cells (kind, connectivity); arrays over points and over cells (in their order)."""

    points: NDArray[np.float64]
    blocks: tuple[tuple[str, Array], ...]
    point_data: dict[str, Array]
    cell_data: dict[str, Array]


def field_grid(
    mesh: Mesh,
    displacement: NDArray[np.float64],
    stress: NDArray[np.float64],
    error: NDArray[np.float64] | None = None,
    remembered: Mapping[str, NDArray[np.float64]] | None = None,
) -> Grid:
    """The whole mesh with displacement, stress, von_mises at points, and the body's number and stress_error at cells (error:
    (n_cells,) as in ``StressError``, zero where it is not known); remembered: what materials do, at points."""
    body = np.zeros(mesh.n_cells, dtype=np.int32)
    for number, cells in enumerate(mesh.bodies.values()):
        body[cells] = number
    of_cells = np.zeros(mesh.n_cells) if error is None else error
    blocks = tuple((block.kind, block.nodes) for block in mesh.blocks)
    at_points = {**(remembered or {}), **_at_points(displacement, stress)}
    return Grid(mesh.points, blocks, at_points, {"body": body, "stress_error": of_cells})


def cell_error(step: Step) -> NDArray[np.float64] | None:
    """``error`` of ``field_grid``."""
    return None if step.stress_error is None else step.stress_error.cells


def point_fields(step: Step) -> dict[str, NDArray[np.float64]]:
    """What is known at every point of the mesh: displacement (n, 3), stress (n, 6), von_mises (n,), and what materials
    remember."""
    return {**step.remembered, **_at_points(step.displacement, step.stress)}


def _at_points(displacement: NDArray[np.float64], stress: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    return {"displacement": vectors(displacement), "stress": stress, "von_mises": von_mises(stress)}


def contact_grid(step: Step, contact: ContactResult, sides: tuple[int, ...] = (CONTACTOR, TARGET)) -> Grid:
    """Facets of a contact's sides with pressure, multiplier, gap, displacement, contact_force, node at points; status, side
    and unsettled at cells; with friction also traction, slip, total_slip, friction_status, friction_work and
    total_friction_work (per area) at points, zero on the target.

    Each facet has points of its own, so that the multiplier may jump between facets. contact_force (n, 3) is the force at
    the mesh's point ``node``, which all points of that number repeat: over the nodes of a side, each taken once, it adds up
    to the resultant. status: 0 not covered by the target, 1 open, 2 closed; gap is NaN on the target, and where it is not
    covered; multiplier is NaN on the target.
    """
    first = 0
    blocks, points, data, cells = [], [], [], []
    for side in sides:
        for kind, x, values, facets in _side(step, contact, side):
            blocks.append((kind, first + np.arange(len(x)).reshape(-1, CELLS[kind].nodes)))
            first += len(x)
            points.append(x)
            data.append(values)
            cells.append(facets)
    return Grid(
        np.concatenate(points),
        tuple(blocks),
        {k: np.concatenate([d[k] for d in data]) for k in data[0]},
        {k: np.concatenate([c[k] for c in cells]) for k in cells[0]},
    )


def largest_pressure(steps: Sequence[Step]) -> float:
    """Of all contacts over some steps, at nodes that count; 0 where nothing is pressed: the end of the scale of colours."""
    found = [c.max_pressure for step in steps for c in step.contacts]
    return max((value for value in found if 0.0 < value < math.inf), default=0.0)


def vectors(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Two-dimensional vectors with a zero third component, as viewers want them."""
    return np.pad(values, ((0, 0), (0, 3 - values.shape[1])))


def _side(
    step: Step, contact: ContactResult, side: int
) -> list[tuple[str, NDArray[np.float64], dict[str, Array], dict[str, Array]]]:
    """The facets of one side by type: kind, points, arrays over points, arrays over cells."""
    surface: Surface = contact.contactor if side == CONTACTOR else contact.target
    pressure = contact.pressure if side == CONTACTOR else contact.target_pressure
    forces = vectors(contact.contactor_forces if side == CONTACTOR else contact.target_forces)
    ids = surface.node_ids
    closed = np.nan_to_num(pressure).max(axis=1) > TOUCHING * np.nan_to_num(contact.pressure).max(initial=0.0)
    unsettled = np.zeros(len(surface), dtype=np.int32)
    if side == CONTACTOR:
        unsettled[step.cycling.get(contact.name, [])] = 1
    covered = contact.covered if side == CONTACTOR else np.ones(len(surface), dtype=bool)
    status = np.where(covered, np.where(closed, CLOSED, OPEN), NOT_COVERED).astype(np.int32)
    result = []
    for code in np.unique(surface.kinds):
        kind = BY_CODE[code]
        facets = np.flatnonzero(surface.kinds == code)
        nodes = surface.nodes[facets, : kind.nodes].ravel()
        nothing = np.full(len(nodes), np.nan)
        values = {
            "pressure": np.nan_to_num(pressure[facets, : kind.nodes]).ravel(),
            "multiplier": contact.multiplier[facets, : kind.nodes].ravel() if side == CONTACTOR else nothing,
            "gap": contact.gap[facets, : kind.nodes].ravel() if side == CONTACTOR else nothing,
            "displacement": vectors(step.displacement[nodes]),
            "contact_force": forces[np.searchsorted(ids, nodes)],
            "node": nodes.astype(np.int32),
        }
        if contact.friction is not None:
            values |= _friction(contact.friction, facets, kind.nodes, side)
        cells = {
            "status": status[facets], "side": np.full(len(facets), side, dtype=np.int32), "unsettled": unsettled[facets],
        }  # fmt: skip
        result.append((kind.name, surface.points[nodes], values, cells))
    return result


def _friction(friction: FrictionResult, facets: NDArray[np.int64], n_nodes: int, side: int) -> dict[str, Array]:
    """Tangential traction and slips (n, 3), status (0 open, 1 sticking, 2 slipping), and work per area in the step and in
    all, at the nodes of facets."""
    names = {name: name for name in ("traction", "slip", "total_slip")}
    names |= {
        "friction_work": "work_per_area",
        "total_friction_work": "total_work_per_area",
        "friction_status": "status",
    }
    result: dict[str, Array] = {}
    for name, attribute in names.items():
        values = getattr(friction, attribute)
        here = (
            values[facets, :n_nodes]
            if side == CONTACTOR
            else np.zeros_like(values, shape=(len(facets), n_nodes, *values.shape[2:]))
        )
        flat = np.nan_to_num(here).reshape(-1, *values.shape[2:])
        result[name] = vectors(flat) if flat.ndim == 2 else flat
    return result
