"""The picture: bodies and contact surfaces with their fields, as arrays that a browser draws, within a size."""

from __future__ import annotations

import base64
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from abut.mesh.mesh import Mesh
from abut.report.friction import arrow_nodes, arrow_normals, at_arrows, friction_fields
from abut.report.surface_triangles import Patch, Skin, patch, skin
from abut.solution import ContactResult, Solution, Step
from abut.solution.grids import largest_pressure, point_fields, vectors
from abut.types import Array, Json

BUDGET = 9_000_000  # bytes of arrays; a third more as text
FINE = 30_000  # points on all contact surfaces together, above which they are divided more coarsely
VALUES = 20  # bytes of a point in a step: displacement, von Mises and the like
RUBBING = 32  # more of them on a contactor with friction: traction, slips, status, arrows
FIXED = 36  # bytes of a point in all: coordinates, triangles, edges


@dataclass(frozen=True)
class Scene:
    """``data``: what the page's script reads; ``reduced``: what was left out to keep the file small, in words."""

    data: Json
    reduced: tuple[str, ...]


def scene(solution: Solution, budget: int = BUDGET) -> Scene:
    """Bodies (in 3D their skins), both sides of every contact, and their fields at the end of the steps.

    budget: bytes of arrays. Above it steps are left out, then contact surfaces are divided less, then skins are thinned.
    """
    mesh, contacts = solution.model.mesh, solution.contacts
    reduced = []
    sides = [(c, role) for c in range(len(contacts)) for role in ("contactor", "target")]
    surfaces = [getattr(contacts[c], role) for c, role in sides]
    without = np.concatenate(
        [np.empty((0, 2), np.int64), *(np.stack([s.cells, s.local], axis=1) for s in surfaces if mesh.dim == 3)]
    )
    skins = {body: skin(mesh, body, without) for body in mesh.bodies}
    facets = sum(map(len, surfaces))
    most = next((n for n in (4, 2) if facets * (n + 1) ** (mesh.dim - 1) <= FINE), 1)
    if mesh.dim == 2:
        most = 8 if most == 4 else 2
    patches = [patch(surface, most) for surface in surfaces]
    points = sum(len(s.nodes) for s in skins.values())
    on_contacts = sum(map(len, patches))
    room = budget - (FIXED + VALUES) * on_contacts
    if points * (FIXED + VALUES) > max(room, budget // 2):
        share = max(room, budget // 2) / (points * (FIXED + VALUES))
        skins = {body: thin(mesh, s, max(int(share * len(s.nodes)), 50)) for body, s in skins.items()}
        now = sum(len(s.nodes) for s in skins.values())
        reduced.append(f"the bodies are drawn by {now} of their {points} points; values are those of the points kept")
        points = now
    fixed, per_step = FIXED * (points + on_contacts), VALUES * (points + on_contacts)
    rubbing = [p for (c, role), p in zip(sides, patches) if role == "contactor" and contacts[c].friction is not None]
    per_step += RUBBING * sum(map(len, rubbing))
    steps = _kept(solution.steps, max(1, int((budget - fixed) // max(per_step, 1))))
    if len(steps) < len(solution.steps):
        reduced.append(f"the picture shows {len(steps)} of {len(solution.steps)} steps")
    data = {
        "dim": mesh.dim,
        "finite": solution.model.finite,
        "axisymmetric": mesh.axisymmetric,
        "bodies": [_body(mesh, name, s) for name, s in skins.items()],
        "contacts": [_side(mesh, contacts[c], role, p) for (c, role), p in zip(sides, patches)],
        "steps": [_fields(step, list(skins.values()), sides, patches) for step in steps],
        "largest": {"pressure": largest_pressure(steps)},
    }
    return Scene(data, tuple(reduced))


def pack(values: Array) -> dict[str, str]:
    """An array as text: 32-bit floats or unsigned integers, little-endian, base64."""
    real = np.issubdtype(values.dtype, np.floating)
    array = np.ascontiguousarray(values, dtype="<f4" if real else "<u4")
    return {"type": "f4" if real else "u4", "data": base64.b64encode(array.tobytes()).decode("ascii")}


def _body(mesh: Mesh, name: str, skin: Skin) -> Json:
    return {
        "name": name,
        "points": pack(vectors(mesh.points[skin.nodes])),
        "triangles": pack(skin.triangles),
        "edges": pack(skin.edges),
        "features": skin.features,
    }


def _side(mesh: Mesh, contact: ContactResult, role: str, grid: Patch) -> Json:
    surface: Any = getattr(contact, role)
    body = next((i for i, cells in enumerate(mesh.bodies.values()) if np.isin(surface.cells[:1], cells).any()), 0)
    arrows: Json = {}
    if role == "contactor" and contact.friction is not None:
        nodes = arrow_nodes(contact)
        arrows = {
            "arrows": {"points": pack(vectors(mesh.points[nodes])), "normals": pack(arrow_normals(contact, nodes))}
        }
    return {
        **arrows,
        "contact": contact.name,
        "role": role,
        "surface": surface.name,
        "body": body,
        "points": pack(vectors(grid.points)),
        "normals": pack(vectors(grid.normals)),
        "cells": pack(grid.cells),
        "edges": pack(grid.edges),
    }


def _fields(step: Step, skins: list[Skin], sides: list[tuple[int, str]], patches: list[Patch]) -> Json:
    """Values at the points of bodies and contact surfaces."""
    fields = point_fields(step)
    stress, moved = fields["von_mises"], fields["displacement"]
    bodies = [{"displacement": pack(moved[s.nodes]), "von Mises": pack(stress[s.nodes])} for s in skins]
    contacts = []
    for (c, role), grid in zip(sides, patches):
        contact = step.contacts[c]
        pressure = contact.pressure if role == "contactor" else contact.target_pressure
        values: Json = {
            "displacement": pack(grid.of_points(moved)),
            "von Mises": pack(grid.of_points(stress)),
            "pressure": pack(grid.nodal(pressure)),
        }
        if role == "contactor":
            values["gap"] = pack(grid.nodal(contact.gap))
        if role == "contactor" and contact.friction is not None:
            values |= {name: pack(field) for name, field in friction_fields(contact.friction, grid).items()}
            nodes = arrow_nodes(contact)
            values["arrows"] = {
                "traction": pack(at_arrows(contact, nodes, np.nan_to_num(contact.friction.traction))),
                "displacement": pack(vectors(step.displacement[nodes])),
            }
        contacts.append(values)
    return {"number": step.number, "factor": step.factor, "bodies": bodies, "contacts": contacts}


def _kept(steps: tuple[Step, ...], most: int) -> list[Step]:
    """At most so many steps, evenly spread, always the last."""
    if len(steps) <= most:
        return list(steps)
    picked = np.unique(np.round(np.linspace(len(steps) - 1, 0, most)).astype(int)) if most > 1 else [len(steps) - 1]
    return [steps[i] for i in picked]


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
