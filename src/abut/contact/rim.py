"""The contactor's boundary: where it ends on a target that extends beyond it, the pressure of a body with corners is
singular."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.contact.geometry import CREASE, by_kind, mean_normals, nodal_normals, split_at_creases
from abut.contact.node_to_segment import feet
from abut.contact.turned_images import extended
from abut.mesh.exterior import numbered, single_facets
from abut.mesh.mesh import Mesh
from abut.mesh.surface import Surface

BEYOND = 0.1  # of the distance from a facet's middle to its edge: how far outside the target is looked for


@dataclass(frozen=True)
class Rim:
    """Edges of a surface that belong to one facet only (in 2D ends of it). facet: (m,); ends: (m, 2) points, in 2D the same
    twice; out: (m, dim) from the facet's middle to the edge, square to the edge; normal: (m, dim) unit, of the facet."""

    facet: NDArray[np.int64]
    ends: NDArray[np.int64]
    out: NDArray[np.float64]
    normal: NDArray[np.float64]


def rim(surface: Surface) -> Rim:
    """The rim of a surface. Raises InputError for a facet without a normal."""
    facet, ends = _edges(surface)
    used = (surface.nodes >= 0)[facet]
    x = surface.points
    middle = (x[np.maximum(surface.nodes[facet], 0)] * used[..., None]).sum(axis=1) / used.sum(axis=1)[:, None]
    along, out = x[ends[:, 1]] - x[ends[:, 0]], x[ends].mean(axis=1) - middle
    size = np.maximum((along**2).sum(axis=1), 1e-300)
    out = out - along * ((out * along).sum(axis=1) / size)[:, None]
    normal = nodal_normals(surface)[facet].sum(axis=1)
    return Rim(facet, ends, out, normal / np.linalg.norm(normal, axis=1, keepdims=True))


def rim_of_sides(surface: Surface) -> Rim:
    """The rims of a surface's smooth sides: where it ends, and along its creases. Raises InputError as ``rim`` does."""
    smooth, owner = split_at_creases(surface)
    border = rim(smooth)
    return border if smooth is surface else replace(border, ends=owner[border.ends])


def goes_on(contactor: Surface, rim: Rim, target: Surface, reach: float) -> NDArray[np.bool_]:
    """Edges (m,) of a contactor's rim beyond which the target goes on; reach: a length."""
    if not len(rim.facet):
        return np.zeros(0, dtype=bool)
    edge = contactor.points[rim.ends].mean(axis=1)
    return np.asarray(feet(edge + BEYOND * rim.out, rim.normal, target, reach)[0] >= 0)


def body_goes_on(mesh: Mesh, contactor: Surface, rim: Rim, some: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Edges (m,) out of ``some`` (m,) beyond which the contactor's own body goes on smoothly, as beside a glued part."""
    result = np.zeros(len(rim.facet), dtype=bool)
    at = np.flatnonzero(some)
    if not len(at):
        return result
    near = np.zeros(len(mesh.points), dtype=bool)
    near[rim.ends[at]] = True
    beside = [
        (kind, nodes[keep], cells[keep]) for kind, nodes, cells in numbered(mesh) for keep in [near[nodes].any(axis=1)]
    ]
    outside = mesh.facets(single_facets(mesh, beside))
    normals = mean_normals(outside)
    edge = np.sort(rim.ends[at].astype(np.int64), axis=1) @ (len(mesh.points), 1)
    facet, ends = _all_edges(outside)
    other = np.sort(ends, axis=1) @ (len(mesh.points), 1)
    order = np.argsort(edge)
    place = np.minimum(np.searchsorted(edge[order], other), len(edge) - 1)
    met = edge[order][place] == other
    mine, theirs = at[order[place[met]]], facet[met]
    own = outside.cells[theirs] == contactor.cells[rim.facet[mine]]
    smooth = (normals[theirs] * rim.normal[mine]).sum(axis=1) > CREASE
    result[mine[smooth & ~own]] = True
    return result


def ends_on_target(contactor: Surface, rim: Rim, on: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Facets (n_facets,) with a corner on an edge of the contactor's rim (in 2D an end of it) beyond which the target goes
    on; not those at a rim where the target ends too, as flush blocks and symmetry planes have. on: (m,) as ``goes_on``."""
    touched = np.zeros(len(contactor.points), dtype=bool)
    touched[rim.ends[on]] = True
    return np.asarray((touched[np.maximum(contactor.nodes, 0)] & (contactor.nodes >= 0)).any(axis=1))


def _edges(surface: Surface) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Those of ``_all_edges`` that belong to one facet only, those beyond the sides of a sector included."""
    facet, every = _all_edges(extended(surface, 1).surface)
    _, first, count = np.unique(np.sort(every, axis=1), axis=0, return_index=True, return_counts=True)
    single = first[count == 1]
    single = single[facet[single] < len(surface)]
    return facet[single], every[single]


def _all_edges(surface: Surface) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Facet (m,) and corner points (m, 2) of every edge of every facet; in 2D the point twice."""
    facets, ends = [], []
    for kind, of_kind in by_kind(surface):
        corners, nodes = CELLS[kind].corners, surface.nodes[of_kind].astype(np.int64)
        if CELLS[kind].dim == 1:
            pairs = [(0, 0), (1, 1)]
        else:
            pairs = [(i, (i + 1) % corners) for i in range(corners)]
        facets += [of_kind] * len(pairs)
        ends += [nodes[:, list(pair)] for pair in pairs]
    return np.concatenate(facets), np.concatenate(ends)
