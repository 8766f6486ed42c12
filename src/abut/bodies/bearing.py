"""Bearing loads: a force that reaches a surface as a pressure which falls off with the cosine; theory (F17)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.bodies.loads import facet_points
from abut.errors import InputError
from abut.mesh.surface import Surface

ROUNDS = 100  # each finds on which points the pressure acts; there are finitely many, and some rounds are enough
LEFT = 1e-9  # of the force: what the surface cannot carry


def bearing_pressure(normals: NDArray[np.float64], direction: NDArray[np.float64]) -> NDArray[np.float64]:
    """Pressure (...,) at unit normals (..., dim), outward, of a load with its ``direction`` (dim,)."""
    return np.maximum(0.0, -normals @ direction)


def bearing_direction(
    surface: Surface, force: NDArray[np.float64], planes: NDArray[np.float64], where: str
) -> NDArray[np.float64]:
    """The vector (dim,) whose pressures add up to a force (dim,) over the surface.

    planes: unit normals (n, dim) of planes of symmetry at which the surface ends. About those along the force it is half of
    a whole, whose pressures add up to twice the force; what they push across such a plane its supports take.

    Raises InputError, beginning with ``where``, for forces that no pressure on this surface adds up to."""
    normals, areas = [], []
    for _, _, weights, normal, _ in facet_points(surface):
        size = np.linalg.norm(normal, axis=2)
        normals.append((normal / size[..., None]).reshape(-1, surface.dim))
        areas.append((weights * size).ravel())
    n, area = np.concatenate(normals), np.concatenate(areas)
    for plane in planes[np.abs(planes @ force) <= LEFT * np.linalg.norm(force)]:
        n = np.concatenate([n, n - 2.0 * np.outer(n @ plane, plane)])
        area, force = np.tile(area, 2), 2.0 * force
    direction = force
    for _ in range(ROUNDS):
        pressed = n[n @ direction < 0.0]
        stiffness = pressed.T @ (area[n @ direction < 0.0, None] * pressed)
        direction = np.linalg.lstsq(stiffness, force, rcond=1e-9)[0]
        reached = -n.T @ (area * bearing_pressure(n, direction))
        if np.linalg.norm(reached - force) <= LEFT * np.linalg.norm(force):
            return np.asarray(direction)
    raise InputError(
        f"{where}: no pressure on '{surface.name}' adds up to this force; a bearing load presses against the surface, so "
        "give one that is round about the force's direction, or leave bearing out"
    )


def bearing_load(
    surface: Surface, force: NDArray[np.float64], planes: NDArray[np.float64], where: str
) -> NDArray[np.float64]:
    """Its nodal forces (dim n_points,). Raises InputError as ``bearing_direction`` does, whose ``planes`` these are."""
    load = np.zeros(surface.points.shape)
    direction = bearing_direction(surface, force, planes, where)
    for nodes, values, weights, normal, _ in facet_points(surface):
        unit = normal / np.linalg.norm(normal, axis=2)[..., None]
        push = -bearing_pressure(unit, direction)[..., None] * normal
        np.add.at(load, nodes, np.einsum("q,qn,fqd->fnd", weights, values, push))
    return load.ravel()
