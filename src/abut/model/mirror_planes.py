"""Planes at which a model may be mirrored: those of symmetry, as far as supports tell."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from abut.mesh.surface import Surface
from abut.model.conditions import Support
from abut.model.model import Model

FLAT = 1e-6  # of the model's size


def mirrors(model: Model) -> list[list[float]]:
    """Planes n x = c as unit normal (three components) and constant, at most three.

    All points lie on the side n x <= c; every deforming point on the plane is held along the normal and free along the
    plane. Frictionless floors look the same, so that this is an offer. The axis of an axisymmetric model is one, since its
    other half is the mirror image."""
    mesh = model.mesh
    points = np.pad(mesh.points, ((0, 0), (0, 3 - mesh.dim)))
    size = float(np.ptp(points, axis=0).max())
    deforming = np.zeros(len(points), dtype=bool)
    for solid in model.solids:
        deforming[mesh.nodes_of(solid.body)] = True
    held: dict[tuple[float, ...], NDArray[np.bool_]] = {}
    once = Counter(support.on for support in model.supports)
    for support in (own for own in model.supports if once[own.on] == 1):
        for normal, nodes in _held(model, support, points):
            level = points @ normal
            normal = normal if level[nodes].mean() >= 0.5 * (level.min() + level.max()) else -normal
            level = points @ normal
            at = float(level[nodes].max())
            if np.ptp(level[nodes]) > FLAT * size or level.max() > at + FLAT * size:
                continue
            key = (*np.round(normal, 6), round(at / size, 6))
            held.setdefault(key, np.zeros(len(points), dtype=bool))[nodes] = True
    planes = []
    for key, fixed in held.items():
        normal = np.array(key[:3]) / np.linalg.norm(key[:3])
        level = points @ normal
        at = float(level[fixed].max())
        there = deforming & (level > at - FLAT * size)
        if (fixed | ~there).all():
            planes.append([*(normal + 0.0).tolist(), at if abs(at) > FLAT * size else 0.0])
    if mesh.axisymmetric:
        planes.insert(0, [-1.0, 0.0, 0.0, 0.0])
    return planes[:3]


def at_ends(model: Model, surface: Surface) -> NDArray[np.float64]:
    """Unit normals (n, dim) of those planes which a surface reaches, about which it goes on as its mirror image."""
    if model.mesh.axisymmetric:
        return np.empty((0, model.dim))
    planes = np.array(mirrors(model)).reshape(-1, 4)
    points = model.mesh.points[np.unique(surface.nodes[surface.nodes >= 0])]
    away = points @ planes[:, : model.dim].T - planes[:, 3]
    size = float(np.ptp(model.mesh.points, axis=0).max())
    return np.asarray(planes[away.max(axis=0) > -FLAT * size, : model.dim])


def _held(
    model: Model, support: Support, points: NDArray[np.float64]
) -> Iterator[tuple[NDArray[np.float64], NDArray[np.int64]]]:
    """Unit normal (3,) and points of a support that holds one direction at zero and no other."""
    nodes = model.mesh.nodes_of(support.on)
    given = [value for value in (support.x, support.y, support.z, support.normal) if value is not None]
    if (
        support.axes is not None
        or len(given) != 1
        or not isinstance(given[0], (int, float))
        or given[0] != 0.0
        or not len(nodes)
    ):
        return
    for axis, value in enumerate((support.x, support.y, support.z)):
        if value is not None:
            yield np.eye(3)[axis], nodes
    if support.normal is not None and len(nodes) >= model.mesh.dim:
        away = points[nodes] - points[nodes].mean(axis=0)
        if model.mesh.dim == 2:
            away = np.vstack([away, [0.0, 0.0, np.abs(away).max()]])
        yield np.linalg.svd(away, full_matrices=True)[2][2], nodes
