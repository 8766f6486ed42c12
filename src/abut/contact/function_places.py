"""Where the functions of a pressure space sit, and the contactor's normals there."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.geometry import side_normals
from abut.contact.pressure_space import PressureSpace
from abut.mesh.surface import Surface

Array = NDArray[np.float64]


def places(contactor: Surface, space: PressureSpace) -> tuple[Array, Array]:
    """Points and outward unit normals of the contactor, (n, dim) each: at the node of each function; of one that belongs to
    a facet alone, the means over its nodes."""
    split, at = side_normals(contactor)
    points, normals = split.points[space.side], at[space.side]
    own = np.flatnonzero(space.node < 0)
    if not len(own):
        return points, normals
    nodes = split.nodes.ravel()
    gather = sp.csr_matrix(
        (np.ones(int((nodes >= 0).sum())), (np.flatnonzero(nodes >= 0), nodes[nodes >= 0])),
        shape=(len(nodes), len(split.points)),
    )
    share = abs(space.plain.tocsc()[:, own]).T @ gather
    total = np.asarray(share.sum(axis=1))
    mean = share @ at
    points[own] = (share @ split.points) / total
    normals[own] = mean / np.linalg.norm(mean, axis=1, keepdims=True)
    return points, normals
