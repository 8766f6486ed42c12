"""The target opposite each facet of a contactor: targets that are not connected move independently, and the pressure jumps
between them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components, dijkstra

from abut.cells import MAX_FACET_NODES
from abut.contact.coupling import Coupling
from abut.dofs import n_components, place_of
from abut.mesh.surface import Surface


def by_target(contactor: Surface, target: Surface, coupling: Coupling) -> Surface:
    """The contactor with its facets told apart by the piece of the target that covers most of each, theory (P15); as it is
    where there is one piece only. Facets that face none go with their neighbours. Both lie over one array of points."""
    if not coupling.segments.any():
        return contactor
    piece = _pieces(target)
    part = coupling.target_part.tocoo()
    width = n_components(coupling.target_part.shape[1], len(target.points))
    area = sp.csr_matrix((np.abs(part.data), (part.row // MAX_FACET_NODES, piece[place_of(part.col, width)])))
    area.resize(len(contactor), int(piece.max()) + 1)
    if (np.asarray(area.sum(axis=0)).ravel() > 0.0).sum() < 2:
        return contactor
    found = np.asarray(area.argmax(axis=1)).ravel()
    return replace(contactor, parts=_filled(contactor, found, np.asarray(area.sum(axis=1)).ravel() > 0.0))


def _pieces(surface: Surface) -> NDArray[np.int64]:
    """Number of the connected piece of a surface that each point belongs to, (n_points,); -1 where it has no facet."""
    facet, local = np.nonzero(surface.nodes >= 0)
    node = surface.nodes[facet, local]
    n = len(surface.points)
    links = sp.csr_matrix((np.ones(len(node)), (node, n + facet)), shape=(n + len(surface),) * 2)
    _, label = connected_components(links, directed=False)
    result = np.full(n, -1, dtype=np.int64)
    used, number = np.unique(node), np.unique(label[n:], return_inverse=True)
    place = np.full(int(label.max()) + 1, -1, dtype=np.int64)
    place[number[0]] = np.arange(len(number[0]))
    result[used] = place[label[used]]
    return result


def _filled(contactor: Surface, part: NDArray[np.int64], known: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Parts of all facets (n_facets,): unknown ones take that of the known facet fewest facets away, else 0."""
    if known.all():
        return part.astype(np.int64)
    facet, local = np.nonzero(contactor.nodes >= 0)
    touch = sp.csr_matrix((np.ones(len(facet)), (facet, contactor.nodes[facet, local])))
    _, _, source = dijkstra(
        (touch @ touch.T).tocsr(),
        indices=np.flatnonzero(known),
        unweighted=True,
        min_only=True,
        return_predecessors=True,
    )
    return np.where(source >= 0, part[np.maximum(source, 0)], 0).astype(np.int64)
