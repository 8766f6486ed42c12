"""Whether a plane on which a body ends continues it as its mirror image: its material must be symmetric about it,
theory (A4)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.bodies.solids import Array, Solids
from abut.materials.directions import turned
from abut.materials.material import linear
from abut.materials.places import Places, placed

ALIKE = 1e-9  # change of an entry of the stiffness over the largest one that is rounding


def mirrors(solids: Solids, cells: NDArray[np.int64], points: Array, normals: Array) -> NDArray[np.bool_]:
    """Of planes through points (n, dim), undeformed, of cells (n,), with unit normals (n, dim): whether the stiffness at
    rest is its own mirror image, (n,); of bodies without a material it is."""
    dim = points.shape[1]
    result = np.ones(len(cells), dtype=bool)
    for number, material in enumerate(solids.materials.values()):
        here = np.flatnonzero(solids.body_of[cells] == number)
        if linear(material) is not None or not len(here):
            continue
        found = placed(material, Places(points[here], np.zeros(len(here))))
        tangent = found.evaluate(np.zeros((len(here), 6)), found.initial(len(here)))[1]
        image = np.broadcast_to(np.eye(3), (len(here), 3, 3)).copy()
        image[:, :dim, :dim] -= 2.0 * normals[here, :, None] * normals[here, None, :]
        turn = turned(image)
        change = np.abs(np.swapaxes(turn, 1, 2) @ tangent @ turn - tangent).max(axis=(1, 2))
        result[here] = change <= ALIKE * np.abs(tangent).max(axis=(1, 2))
    return result
