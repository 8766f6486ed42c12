"""The picture: bodies and contact surfaces with their fields, as arrays that a browser draws, within a size."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from abut.mesh.mesh import Mesh
from abut.model import Model
from abut.model.mirror_planes import mirrors
from abut.report.arrays import moved as on_grid
from abut.report.arrays import rounded
from abut.report.friction import arrow_nodes, arrow_normals, at_arrows, friction_fields
from abut.report.inside import tetrahedra
from abut.report.mode_shapes import SHAPE, cost, drawn, mode_shapes
from abut.report.quantities import Extremes, contact_ranges, extremes, of_nodes, of_stress, peak_steps
from abut.report.surface_triangles import Patch, Skin, patch, skin
from abut.solution import ContactResult, Solution, Step
from abut.solution.grids import vectors
from abut.types import Array, Json

BUDGET = 16_000_000  # bytes of arrays, of which about half is left when they are compressed
FINE = 30_000  # points on all contact surfaces together, above which they are divided more coarsely
VALUES = 32  # bytes of a point in a step: displacement, stresses and the like
RUBBING = 32  # more of them on a contactor with friction: traction, slips, status, arrows
FIXED = 60  # bytes of a point in all: coordinates, triangles, edges
CORNERS = 16  # bytes of a tetrahedron of the inside
FOR_INSIDE = 0.5  # share of the size that the inside may take
FOR_MODES = 0.5  # share of what is left that modes may take


@dataclass(frozen=True)
class Scene:
    """``data``: what the page's script reads; ``reduced``: what was left out to keep the file small, in words."""

    data: Json
    reduced: tuple[str, ...]


def scene(solution: Solution, budget: int = BUDGET, of_bodies: dict[str, Extremes] | None = None) -> Scene:
    """Bodies (in 3D their skins, and their inside for sections), both sides of every contact, and their fields at the end of
    the steps.

    budget: bytes of arrays. Above it the inside is left out, then steps, then skins are thinned. The last step and those of
    the largest values stay. of_bodies: ``extremes`` of the solution, where they are known.
    """
    mesh, contacts = solution.model.mesh, solution.contacts
    of_bodies = extremes(solution) if of_bodies is None else of_bodies
    sides = [(c, role) for c in range(len(contacts)) for role in ("contactor", "target")]
    surfaces = [getattr(contacts[c], role) for c, role in sides]
    without = np.concatenate(
        [np.empty((0, 2), np.int64), *(np.stack([s.cells, s.local], axis=1) for s in surfaces if mesh.dim == 3)]
    )
    patches = [patch(surface, _divided(surfaces)) for surface in surfaces]
    needed, on_contacts = peak_steps(solution, of_bodies), sum(map(len, patches))
    skins = {body: skin(mesh, body, without) for body in mesh.bodies}
    of_point = FIXED + VALUES * len(needed) + max(map(cost, solution.modes), default=0)
    skins, said = _within(mesh, skins, budget, on_contacts, of_point)
    reduced = [said] if said else []
    points = sum(len(s.nodes) for s in skins.values())
    per_step = VALUES * (points + on_contacts)
    rubbing = [p for (c, role), p in zip(sides, patches) if role == "contactor" and contacts[c].friction is not None]
    per_step += RUBBING * sum(map(len, rubbing))
    fixed = FIXED * (points + on_contacts) + CORNERS * sum(len(s.inside) for s in skins.values())
    modes = drawn(solution, points + on_contacts, FOR_MODES * (budget - fixed - per_step * len(needed)))
    fixed += sum(cost(result) for result, _ in modes) * (points + on_contacts)
    steps = kept(solution.steps, needed, max(1, int((budget - fixed) // max(per_step, 1))))
    if len(steps) < len(solution.steps):
        some = f"{len(steps)} of {len(solution.steps)} steps"
        reduced.append(f"the picture shows {some}, those of the largest values among them")
    if len(modes) < (every := sum(map(len, solution.modes))):
        reduced.append(f"the picture shows the first {len(modes)} of {every} modes")
    ranges = {name: own.ranges for name, own in of_bodies.items()} | contact_ranges(solution)
    data = {
        "dim": mesh.dim,
        "finite": solution.model.finite,
        "axisymmetric": mesh.axisymmetric,
        "bodies": [_body(mesh, name, s) for name, s in skins.items()],
        "contacts": [_side(mesh, contacts[c], role, p) for (c, role), p in zip(sides, patches)],
        "steps": [_fields(solution.model, step, list(skins.values()), sides, patches) for step in steps],
        "modes": mode_shapes(modes, list(skins.values()), patches),
        "ranges": ranges | ({SHAPE: [[0.0, 1.0]]} if modes else {}),
        "mirrors": mirrors(solution.model),
    }
    return Scene(data, tuple(reduced))


def _within(
    mesh: Mesh, skins: dict[str, Skin], budget: int, on_contacts: int, of_point: int
) -> tuple[dict[str, Skin], str]:
    """Skins with their inside, without, or thinned, so that points of so many bytes stay within a budget beside some of
    contact surfaces; and what was left out, in words."""
    points = sum(len(s.nodes) for s in skins.values())
    room = max(budget - of_point * on_contacts, budget // 2)
    if points * of_point > room:
        share = room / (points * of_point)
        skins = {body: thin(mesh, s, max(int(share * len(s.nodes)), 50)) for body, s in skins.items()}
        now = sum(len(s.nodes) for s in skins.values())
        return skins, f"the bodies are drawn by {now} of their {points} points; values are those of the points kept"
    if mesh.dim == 2:
        return skins, ""
    filled = {body: own.filled(tetrahedra(mesh, body)) for body, own in skins.items()}
    cost = sum(CORNERS * len(s.inside) + of_point * (len(s.nodes) - len(skins[b].nodes)) for b, s in filled.items())
    if cost < FOR_INSIDE * (budget - (points + on_contacts) * of_point):
        return filled, ""
    return skins, "sections cut the surfaces of the bodies, and do not show their inside"


def _divided(surfaces: Sequence[Any]) -> int:
    """Lines along a facet's edge: as many as show a parabola, fewer on large surfaces."""
    facets, dim = sum(map(len, surfaces)), surfaces[0].dim if surfaces else 3
    most = next((n for n in (4, 2) if facets * (n + 1) ** (dim - 1) <= FINE), 1)
    return most if dim == 3 else 8 if most == 4 else 2


def _body(mesh: Mesh, name: str, skin: Skin) -> Json:
    return {
        "name": name,
        "points": vectors(mesh.points[skin.nodes]),
        "triangles": skin.triangles,
        "edges": skin.edges,
        "features": skin.features,
        "inside": skin.inside,
    }


def _side(mesh: Mesh, contact: ContactResult, role: str, grid: Patch) -> Json:
    surface: Any = getattr(contact, role)
    body = next((i for i, cells in enumerate(mesh.bodies.values()) if np.isin(surface.cells[:1], cells).any()), 0)
    arrows: Json = {}
    if role == "contactor" and contact.friction is not None:
        nodes = arrow_nodes(contact)
        arrows = {"arrows": {"points": vectors(mesh.points[nodes]), "normals": rounded(arrow_normals(contact, nodes))}}
    return {
        **arrows,
        "contact": contact.name,
        "role": role,
        "surface": surface.name,
        "body": body,
        "points": vectors(grid.points),
        "normals": rounded(vectors(grid.normals)),
        "cells": grid.cells,
        "edges": grid.edges,
    }


def _fields(model: Model, step: Step, skins: list[Skin], sides: list[tuple[int, str]], patches: list[Patch]) -> Json:
    """Values at the points of bodies and contact surfaces."""
    moved, known = vectors(step.displacement), of_nodes(model.mesh, step)
    strained = {solid.body for solid in model.solids}
    bodies: list[Json] = []
    for name, own in zip(model.mesh.bodies, skins):
        scalars = {**of_stress(step.stress[own.nodes]), **{key: values[own.nodes] for key, values in known.items()}}
        shown = {key: rounded(values) for key, values in scalars.items()} if name in strained else {}
        bodies.append({"displacement": on_grid(moved[own.nodes]), **shown})
    contacts = []
    for (c, role), grid in zip(sides, patches):
        contact = step.contacts[c]
        pressure = contact.pressure if role == "contactor" else contact.target_pressure
        scalars = of_stress(grid.of_points(step.stress))
        scalars |= {key: grid.within(_own(grid, values)) for key, values in known.items()}
        scalars["pressure"] = _pressure(grid, pressure)
        if role == "contactor":
            scalars["gap"] = grid.nodal(contact.gap)
        if role == "contactor" and contact.friction is not None:
            scalars |= friction_fields(contact.friction, grid)
        values: Json = {"displacement": on_grid(grid.of_points(moved))}
        values |= {key: rounded(field) for key, field in scalars.items()}
        if role == "contactor" and contact.friction is not None:
            nodes = arrow_nodes(contact)
            values["arrows"] = {
                "traction": rounded(at_arrows(contact, nodes, np.nan_to_num(contact.friction.traction))),
                "displacement": on_grid(vectors(step.displacement[nodes])),
            }
        contacts.append(values)
    return {"number": step.number, "time": step.time, "bodies": bodies, "contacts": contacts}


def _own(grid: Patch, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values of the mesh's points at the facets' own nodes, (n_facets, 9), NaN where padded."""
    nodes = grid.surface.nodes
    return np.where(nodes >= 0, values[np.maximum(nodes, 0)], np.nan)


def _pressure(grid: Patch, pressure: NDArray[np.float64]) -> Array:
    """Pressures between nodes; below the smallest of the nodes parabolas go on their own."""
    return np.maximum(grid.nodal(pressure), np.nanmin(pressure, initial=np.inf))


def kept(steps: tuple[Step, ...], needed: Sequence[int], most: int) -> list[Step]:
    """At most so many steps, evenly spread, and ``needed`` ones (indices) in any case."""
    if len(steps) <= most:
        return list(steps)
    spread = np.unique(np.round(np.linspace(len(steps) - 1, 0, max(most, 1))).astype(int))
    chosen = sorted({*needed, *spread.tolist()})
    while len(chosen) > max(
        most, len(needed)
    ):  # of two neighbours one goes: that with the smallest way between its own
        inner = [i for i in range(len(chosen)) if chosen[i] not in needed]
        ends = [-1, *chosen, len(steps)]
        chosen.pop(min(inner, key=lambda i: ends[i + 2] - ends[i]))
    return [steps[i] for i in chosen]


def thin(mesh: Mesh, skin: Skin, most: int) -> Skin:
    """A skin with about ``most`` points: of all in a small box only the one nearest to their middle stays."""
    x = mesh.points[skin.nodes]
    low, size = x.min(axis=0), float(np.ptp(x, axis=0).max())
    boxes = 2.0 * max(most, 1) ** (1.0 / 2.0)
    box = np.arange(len(x))
    while len(np.unique(box)) > most and boxes > 1.0:
        boxes /= 1.2
        places = np.floor((x - low) / size * boxes).astype(np.int64)
        _, box = np.unique(places, axis=0, return_inverse=True)
        box = box.ravel()
    count = np.bincount(box)
    middle = np.stack([np.bincount(box, weights=column) / count for column in x.T], axis=1)
    order = np.lexsort((np.linalg.norm(x - middle[box], axis=1), box))
    keeper = order[np.concatenate([[0], np.cumsum(count)[:-1]])]
    triangles = box[skin.triangles]
    triangles = triangles[(triangles != np.roll(triangles, 1, axis=1)).all(axis=1)]
    _, once = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True)
    parts = []
    for edges in (box[skin.edges[: skin.features]], box[skin.edges[skin.features :]]):
        parts.append(np.unique(np.sort(edges[edges[:, 0] != edges[:, 1]], axis=1), axis=0))
    return replace(
        skin, nodes=skin.nodes[keeper], triangles=triangles[once], edges=np.concatenate(parts), features=len(parts[0])
    )
