"""Motion that small kinematics does not follow: along the surfaces of a contact, and turns of bodies."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from abut.contact.geometry import area_vectors, facet_sizes
from abut.mesh.mesh import Mesh
from abut.mesh.surface import Surface
from abut.model import Model
from abut.problem.pair import Pair

PLANE = 1e-6  # sine of an angle between facets of one plane

Array = NDArray[np.float64]


def slid(pair: Pair, displacement: Array, held: bool) -> Array:
    """How far each facet of the contactor has moved along the target since the outset, over the larger of both facets' sizes
    there, (n_facets,). Zero on a plane that is held as a whole, where it makes no difference.

    displacement: (n_points, dim); held: whether nothing can move the target."""
    at = pair.coupling.gap_samples
    farthest = np.zeros(len(pair.contactor))
    if at is None or not len(at.gap) or (held and _plane(pair.target)):
        return farthest
    moved = np.zeros_like(at.normal)
    for sign, surface, facet, shapes in (
        (1.0, pair.contactor, at.facet, at.contactor_shapes),
        (-1.0, pair.target, at.target_facet, at.target_shapes),
    ):
        nodes = np.maximum(surface.nodes[facet], 0)  # shape functions are zero where padded
        for a in range(int((surface.nodes >= 0).sum(axis=1).max(initial=0))):
            moved += sign * shapes[:, a, None] * displacement[nodes[:, a]]
    moved -= (moved * at.normal).sum(axis=1, keepdims=True) * at.normal
    size = np.maximum(facet_sizes(pair.contactor)[at.facet], facet_sizes(pair.target)[at.target_facet])
    np.maximum.at(farthest, at.facet, np.linalg.norm(moved, axis=1) / size)
    return farthest


def _plane(surface: Surface) -> bool:
    areas = area_vectors(surface).reshape(-1, surface.dim)
    size = np.linalg.norm(areas, axis=1)
    unit = areas[size > 0.0] / size[size > 0.0, None]
    return bool(len(unit) and np.linalg.norm(unit - unit[0], axis=1).max() < PLANE)


def largest_turn(mesh: Mesh, displacement: Array, bodies: Iterable[str] | None = None) -> float:
    """The largest turn of a body as a whole, by the rigid motion nearest to the displacement (n_points, dim) of its points,
    radians (its tangent). bodies: which, all where left out. Axisymmetric bodies do not turn."""
    if mesh.axisymmetric:
        return 0.0
    names = mesh.bodies if bodies is None else bodies
    return max((_turn(mesh.points[nodes], displacement[nodes]) for nodes in map(mesh.nodes_of, names)), default=0.0)


def _turn(points: Array, moved: Array) -> float:
    """Size of the vector w that makes w x x nearest to displacements, both about their means."""
    x, u = points - points.mean(axis=0), moved - moved.mean(axis=0)
    if x.shape[1] == 2:
        return float(abs((x[:, 0] * u[:, 1] - x[:, 1] * u[:, 0]).sum()) / max((x**2).sum(), 1e-300))
    inertia = (x**2).sum() * np.eye(3) - x.T @ x
    return float(np.linalg.norm(np.linalg.lstsq(inertia, np.cross(x, u).sum(axis=0), rcond=1e-9)[0]))


def turned(model: Model, displacement: Array) -> float:
    """Largest turn of a body, where they are taken for small, else 0; rigid ones may turn by any where contact follows
    them."""
    if not model.small_strains:
        return 0.0
    return largest_turn(model.mesh, displacement, model.materials if model.finite else model.mesh.bodies)
