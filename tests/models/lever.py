"""Forces by which contactor facets take up the couples of tractions across gaps, theory (G4)."""

from __future__ import annotations

import numpy as np

from abut.cells import CELLS
from abut.contact.coupling import IntegrationPoints
from abut.contact.geometry import by_kind
from abut.mesh.surface import Surface
from abut.types import Array

EDGES = {  # corner by corner
    2: [[-1.0], [1.0]],
    3: [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]],
    4: [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]],
}


def couples(contactor: Surface, at: IntegrationPoints, traction: Array, apart: Array) -> Array:
    """(n_points of the contactor, dim); at the integration points traction: (n, dim), apart: (n,) between the facets."""
    result = np.zeros_like(contactor.points)
    for kind, facets in by_kind(contactor):
        share = np.array(EDGES[CELLS[kind].corners])
        here = np.flatnonzero(np.isin(at.facet, facets))
        nodes = contactor.nodes[at.facet[here], : len(share)]
        edges = np.einsum("ie,nia->nea", share, contactor.points[nodes])
        frame = np.concatenate([edges, at.normal[here][:, None]], axis=1)
        dual = np.linalg.inv(frame).transpose(0, 2, 1)[:, :-1]
        size = (at.weight * apart)[here][:, None] * np.einsum("nea,na->ne", dual, traction[here])
        np.add.at(result, nodes, np.einsum("ie,ne,na->nia", share, size, at.normal[here]))
    return result
