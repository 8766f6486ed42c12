"""Where the functions of a pressure space sit, and the contactor's normals there."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.geometry import side_normals
from abut.contact.pressure_space import PressureSpace
from abut.mesh.surface import Surface

Array = NDArray[np.float64]


def places(contactor: Surface, space: PressureSpace, normals: Array | None = None) -> tuple[Array, Array]:
    """Points and outward unit normals of the contactor, (n, dim) each: at the node of each function; of one that belongs to
    a facet alone, the means over its nodes. normals: (n_facets, 9, dim) at the facets' nodes, ``nodal_normals`` where left
    out."""
    split, at = side_normals(contactor)
    if normals is not None:
        at[split.nodes[split.nodes >= 0]] = normals[split.nodes >= 0]
    points, outward = split.points[space.side], at[space.side]
    of_facets = np.flatnonzero(space.node < 0)
    if not len(of_facets):
        return points, outward
    nodes = split.nodes.ravel()
    gather = sp.csr_matrix(
        (np.ones(int((nodes >= 0).sum())), (np.flatnonzero(nodes >= 0), nodes[nodes >= 0])),
        shape=(len(nodes), len(split.points)),
    )
    share = abs(space.plain.tocsc()[:, of_facets]).T @ gather
    total = np.asarray(share.sum(axis=1))
    mean = share @ at
    points[of_facets] = (share @ split.points) / total
    outward[of_facets] = mean / np.linalg.norm(mean, axis=1, keepdims=True)
    return points, outward
