"""The contactor's rim: where it ends on a target that goes on, the pressure of a body with corners is singular."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.interface.geometry import by_kind, nodal_normals
from abut.interface.node_to_segment import feet
from abut.mesh.surface import Surface

BEYOND = 0.1  # of the distance from a facet's middle to its edge: how far outside the target is looked for


def ends_on_target(contactor: Surface, target: Surface, reach: float) -> NDArray[np.bool_]:
    """Facets (n_facets,) with a corner on an edge of the contactor's rim (in 2D an end of it) beyond which the target goes
    on; not those at a rim where the target ends too, as flush blocks and symmetry planes have. reach: a length."""
    facet, ends = _rim(contactor)
    if not len(facet):
        return np.zeros(len(contactor), dtype=bool)
    used = (contactor.nodes >= 0)[facet]
    x = contactor.points
    middle = (x[np.maximum(contactor.nodes[facet], 0)] * used[..., None]).sum(axis=1) / used.sum(axis=1)[:, None]
    edge = x[ends].mean(axis=1)
    along, out = x[ends[:, 1]] - x[ends[:, 0]], edge - middle
    size = np.maximum((along**2).sum(axis=1), 1e-300)
    out = out - along * ((out * along).sum(axis=1) / size)[:, None]
    normal = nodal_normals(contactor)[facet].sum(axis=1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    seen = feet(edge + BEYOND * out, normal, target, reach)[0] >= 0
    touched = np.zeros(len(x), dtype=bool)
    touched[ends[seen]] = True
    return np.asarray((touched[np.maximum(contactor.nodes, 0)] & (contactor.nodes >= 0)).any(axis=1))


def _rim(surface: Surface) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Facet (m,) and corner points (m, 2) of every edge that belongs to one facet only; in 2D the point twice."""
    facets, ends = [], []
    for kind, own in by_kind(surface):
        corners, nodes = CELLS[kind].corners, surface.nodes[own].astype(np.int64)
        if CELLS[kind].dim == 1:
            pairs = [(0, 0), (1, 1)]
        else:
            pairs = [(i, (i + 1) % corners) for i in range(corners)]
        facets += [own] * len(pairs)
        ends += [nodes[:, list(pair)] for pair in pairs]
    facet, every = np.concatenate(facets), np.concatenate(ends)
    _, first, count = np.unique(np.sort(every, axis=1), axis=0, return_index=True, return_counts=True)
    single = first[count == 1]
    return facet[single], every[single]
