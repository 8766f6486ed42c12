"""Vectors at the functions of a pressure space on facets beyond the side of a sector that a function stands at."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.cells import MAX_FACET_NODES
from abut.contact.turned_images import used_sides
from abut.mesh.surface import Surface
from abut.types import Array, Sparse

NEARER = 1.0 - 1e-6  # distance over another one below which a function stands there


def by_turn(contactor: Surface, node: NDArray[np.int64], facets: Sparse) -> list[tuple[Array, Sparse]]:
    """The parts of facet-wise functions ``facets`` (9 n_facets, n), functions standing at points ``node`` (n,), on facets to
    which a function's vectors come turned by (dim, dim), with that turn: a function at the partner of a facet's node has its
    vectors turned there."""
    dim, sides = contactor.dim, used_sides(contactor)
    if sides is None or not (node >= 0).any():
        return [(np.eye(dim), facets)]
    entries = facets.tocoo()
    used = (contactor.nodes >= 0)[..., None]
    middle = (contactor.points[np.maximum(contactor.nodes, 0)] * used).sum(axis=1) / used.sum(axis=1)
    at, x = middle[entries.row // MAX_FACET_NODES], contactor.points[np.maximum(node, 0)][entries.col]
    place, least = np.zeros(len(at), dtype=np.int64), np.linalg.norm(x - at, axis=1)
    moves = [sides.power(k) for k in (0, 1, -1)]
    for k, (turn, shift) in enumerate(moves[1:], start=1):
        far = np.linalg.norm(x @ turn.T + shift - at, axis=1)
        nearer = (far < NEARER * least) & (node[entries.col] >= 0)
        place[nearer], least[nearer] = k, far[nearer]
    result = []
    for k, (turn, _) in enumerate(moves):
        part = entries.copy()
        part.data = np.where(place == k, entries.data, 0.0)
        part = part.tocsr()
        part.eliminate_zeros()
        result.append((turn, part))
    return result


def spread(contactor: Surface, node: NDArray[np.int64], facets: Sparse, vectors: Array) -> NDArray[np.float64]:
    """Facet-wise coefficients (9 n_facets, dim) of the functions' vectors (n, dim); node, facets: as for ``by_turn``."""
    parts = (part @ (vectors @ turn.T) for turn, part in by_turn(contactor, node, facets))
    return np.asarray(sum(parts, np.zeros((facets.shape[0], vectors.shape[1]))))
