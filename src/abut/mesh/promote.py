"""Linear cells to quadratic ones: mid nodes on edges, faces and in the middle, shared between neighbours."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.mesh.facets import row_codes

EDGES: dict[str, tuple[tuple[int, int], ...]] = {
    "tri": ((0, 1), (1, 2), (2, 0)),
    "quad": ((0, 1), (1, 2), (2, 3), (3, 0)),
    "tet": ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
    "hex": ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
    "wedge": ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)),
}
FAMILY = {"tri3": "tri", "quad4": "quad", "tet4": "tet", "hex8": "hex", "wedge6": "wedge"}


def _shared_middles(
    groups: NDArray[np.int64], first: int, points: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Numbers (cells, groups) and positions of new nodes in the middle of groups (cells, groups, k) of corners."""
    flat = np.sort(groups.reshape(-1, groups.shape[-1]), axis=1)
    _, one, inverse = np.unique(row_codes(flat), return_index=True, return_inverse=True)
    return first + inverse.reshape(groups.shape[:2]), points[flat[one]].mean(axis=1)


def middles(points: NDArray[np.float64], nodes: NDArray[np.int32], kind: str, fixed: NDArray[np.int64]) -> None:
    """Put the nodes inside faces and cells of quad9 and hex27, but those ``fixed``, where the curved edges around them lead
    (Coons); between straight edges they are in the middle already. In the mean of the corners they can lie outside their
    cell's own inside, next to a round side."""
    if kind == "quad9":
        points[nodes[:, 8]] = _coons(points, nodes[:, :4], nodes[:, 4:8])
    if kind != "hex27":
        return
    free = np.ones(len(points), dtype=bool)
    free[fixed] = False
    for _, facet_nodes in CELLS["hex27"].facets:
        face = nodes[:, facet_nodes][free[nodes[:, facet_nodes[8]]]]
        points[face[:, 8]] = _coons(points, face[:, :4], face[:, 4:8])
    corners, edges, faces = (points[nodes[:, a:b]].sum(axis=1) for a, b in ((0, 8), (8, 20), (20, 26)))
    points[nodes[:, 26]] = faces / 2 - edges / 4 + corners / 8


def _coons(points: NDArray[np.float64], corners: NDArray[np.int32], edges: NDArray[np.int32]) -> NDArray[np.float64]:
    return np.asarray(points[edges].sum(axis=1) / 2 - points[corners].sum(axis=1) / 4)


def promote(
    points: NDArray[np.float64], cells: NDArray[np.int64], linear: str, kind: str
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Points and connectivity of ``kind`` from linear cells; new nodes in the middle of edges, faces, cells."""
    cells = np.asarray(cells, dtype=np.int64)
    if kind == linear:
        return points, cells.astype(np.int32)
    family = FAMILY[linear]
    edges = np.array(EDGES[family])
    columns, parts = [cells], [points]
    numbers, middles = _shared_middles(cells[:, edges], len(points), points)
    columns.append(numbers)
    parts.append(middles)
    first = len(points) + len(middles)
    if kind == "hex27":
        faces = np.array([nodes for _, nodes in CELLS["hex8"].facets])
        numbers, middles = _shared_middles(cells[:, faces], first, points)
        columns.append(numbers)
        parts.append(middles)
        first += len(middles)
    if kind in ("quad9", "hex27"):
        columns.append(first + np.arange(len(cells))[:, None])
        parts.append(points[cells].mean(axis=1))
    return np.concatenate(parts), np.concatenate(columns, axis=1).astype(np.int32)
