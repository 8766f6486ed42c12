"""Where the functions of a pressure space sit, the contactor's normals there, and their values at gap samples."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.cells import CELLS
from abut.contact.coupling import GapSamples
from abut.contact.geometry import by_kind, node_coordinates, pressure_kind, side_normals
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


def at_samples(contactor: Surface, degree: int, at: GapSamples) -> Array:
    """Values of the facet-wise pressure functions at gap samples, (n_samples, 9)."""
    functions = np.zeros_like(at.contactor_shapes)
    for kind, facets in by_kind(contactor):
        here = np.isin(at.facet, facets)
        if degree == 0:
            functions[here, 0] = 1.0
            continue
        carrier = CELLS[pressure_kind(kind, degree)]
        values, _ = shape_functions(carrier.code, node_coordinates(kind))
        functions[np.ix_(here, np.arange(carrier.nodes))] = at.contactor_shapes[here, : CELLS[kind].nodes] @ values
    return functions
