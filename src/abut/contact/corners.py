"""Sharp corners of a contactor: of the faces that meet at one, those that a target next to it lies edge-on to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.contact.coupling import Coupling
from abut.contact.geometry import area_vectors
from abut.contact.pressure_space import WEAK_SUPPORT, PressureSpace
from abut.mesh.surface import Surface

EDGE_ON = 1.0 / 3.0  # cosine of a face over that of another one at the corner, below which it sees the target edge-on


def at_corners(space: PressureSpace) -> NDArray[np.bool_]:
    """(n_functions,) that share their point with another one, on the other side of a crease."""
    held, index, count = np.unique(space.node, return_inverse=True, return_counts=True)
    return np.asarray(((count > 1) & (held >= 0))[index])


def edge_on(space: PressureSpace, target: Surface, coupling: Coupling, near: float) -> NDArray[np.bool_]:
    """(n_functions,) at corners whose face sees the target edge-on while another face there does not: theory (G22).

    coupling: of the contactor with that target, with its points; near: gap, a length, up to which the target counts."""
    seen, corner = coupling.points, np.flatnonzero(at_corners(space))
    result = np.zeros(len(space), dtype=bool)
    if seen is None or not len(corner):
        return result
    normals = area_vectors(target).sum(axis=1)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    facing = np.einsum("nd,nd->n", seen.normal, normals[seen.target_facet])
    shares = (seen.pressure @ space.plain[:, corner]).T
    area = np.where(np.abs(seen.gap) <= near, seen.weight, 0.0)
    weight, total = shares @ area, abs(shares) @ np.abs(seen.weight)  # areas of a trial state may be negative
    known = weight > WEAK_SUPPORT * total
    cosine = np.where(known, (shares @ (area * facing)) / np.where(known, weight, 1.0), 0.0)
    node = np.unique(space.node[corner], return_inverse=True)[1]
    best = np.zeros(node.max() + 1)
    np.maximum.at(best, node, cosine)
    result[corner] = known & (cosine < EDGE_ON * best[node])
    return result
