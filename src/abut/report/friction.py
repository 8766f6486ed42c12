"""Friction in the report: its table, its plots over the load steps, and its fields and arrows in the picture."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from abut.contact.geometry import nodal_normals
from abut.report.contact_words import number, vector
from abut.report.surface_triangles import Patch
from abut.solution import ContactResult, FrictionResult, Solution
from abut.solution.grids import vectors

HEAD = [
    "contact", "sticks on", "slips on", "friction force", "by area", "at most", "largest share of the limit",
    "largest traction", "largest slip in the step", "in all", "work in the step", "in all",
]  # fmt: skip
SHOWN = np.array([0.0, 2.0, 1.0])  # status as drawn, in the order of zones: open, slipping, sticking
MOST = 1500  # arrows on one contactor
Vector = NDArray[np.float64]


def friction_rows(solution: Solution) -> list[list[str]]:
    """Rows of text below ``HEAD`` for the contacts with friction at the end of the last step."""
    rows = []
    for contact in solution.contacts:
        friction = contact.friction
        if friction is not None:
            numbers = [
                friction.force_by_area,
                friction.force_limit,
                friction.largest_share,
                friction.max_traction,
                friction.max_slip,
            ]
            numbers += [friction.max_total_slip, friction.work, friction.total_work]
            areas = [number(friction.sticking_area), number(friction.slipping_area)]
            rows.append([contact.name, *areas, vector(friction.force, friction.force_by_area), *map(_bounded, numbers)])
    return rows


def _bounded(value: float) -> str:
    return "no limit" if math.isinf(value) else number(value)


def friction_history(steps: Sequence[FrictionResult | None]) -> dict[str, list[float]] | None:
    """What is drawn over the steps for one contact, by name; None without friction."""
    known = [step for step in steps if step is not None]
    if not known:
        return None
    return {
        "force": [step.force_by_area for step in known],
        "limit": [step.force_limit for step in known],
        "work": [step.total_work for step in known],
        "sticking": [step.sticking_area for step in known],
        "slipping": [step.slipping_area for step in known],
    }


def friction_fields(friction: FrictionResult, at: Patch) -> dict[str, Vector]:
    """Fields for the colours of a contactor at the points of its patch: sizes of traction and slips, status and work."""
    moved = np.where((friction.status > 0)[..., None], friction.slip, 0.0)
    return {
        "traction": np.linalg.norm(at.nodal(friction.traction), axis=1),
        "slip": np.linalg.norm(at.nodal(friction.total_slip), axis=1),
        "slip in the step": np.linalg.norm(at.nodal(moved), axis=1),
        "friction work": at.within(friction.total_work_per_area),
        "status": at.within(SHOWN[friction.status]),
    }


def arrow_nodes(contact: ContactResult) -> NDArray[np.int64]:
    """Nodes of a contactor with an arrow, sorted: the corners of its facets, at most ``MOST``, spread over it."""
    ids = np.unique(contact.contactor.nodes[_corners(contact)]).astype(np.int64)
    if len(ids) > MOST:
        ids = np.sort(np.random.default_rng(0).permutation(ids)[:MOST])
    return ids


def at_arrows(contact: ContactResult, nodes: NDArray[np.int64], values: Vector) -> Vector:
    """Vectors at the facets' own nodes (n_facets, 9, dim) as means at some nodes, (n, 3)."""
    corners = _corners(contact)
    ids, at_nodes = contact.contactor.nodes[corners], values[corners]
    place = np.searchsorted(nodes, ids).clip(max=len(nodes) - 1)
    there = nodes[place] == ids
    total = np.zeros((len(nodes), values.shape[-1]))
    np.add.at(total, place[there], at_nodes[there])
    return vectors(total / np.bincount(place[there], minlength=len(nodes))[:, None])


def arrow_normals(contact: ContactResult, nodes: NDArray[np.int64]) -> Vector:
    """Unit normals out of the contactor at some nodes, (n, 3)."""
    normal = at_arrows(contact, nodes, nodal_normals(contact.contactor))
    return np.asarray(normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300))


def _corners(contact: ContactResult) -> NDArray[np.bool_]:
    """(n_facets, 9) whether a node of a facet is a corner of it."""
    used = contact.contactor.nodes >= 0
    count = used.sum(axis=1)
    corners = np.where(contact.contactor.dim == 2, 2, np.where(np.isin(count, (3, 6)), 3, 4))
    return used & (np.arange(used.shape[1]) < corners[:, None])
