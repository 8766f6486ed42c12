"""The pressure by the stresses of a contactor's cells, to compare with that of its contact: theory (P17)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.contact.geometry import side_normals
from abut.mesh.mesh import Mesh
from abut.mesh.surface import Surface
from abut.model import Force, Model, Pressure, Traction

SIMPLEX = ("tri3", "tet4")  # one stress a cell: a node's average is that at the mean of its cells' middles
ROWS = ((0, 3, 5), (3, 1, 4), (5, 4, 2))  # of a tensor, in xx yy zz xy yz zx
EVEN = 1e-6  # smallest over largest eigenvalue of a star of nodes' second moments from which on it has an extent

Array = NDArray[np.float64]


def loaded_points(model: Model) -> NDArray[np.int64]:
    """Point numbers of the mesh where loads on surfaces act."""
    on = {str(load.on) for load in model.loads if isinstance(load, (Force, Pressure, Traction))} & {
        *model.mesh.surfaces
    }
    return np.unique(np.concatenate([np.empty(0, np.int64), *(model.mesh.nodes_of(name) for name in on)]))


def cells_around(mesh: Mesh, surfaces: Sequence[Surface]) -> NDArray[np.bool_]:
    """The cells (n_cells,) from which ``normal_stress`` takes averages: those at the surfaces, and those around these."""
    found, points = np.zeros(mesh.n_cells, dtype=bool), np.zeros(len(mesh.points), dtype=bool)
    for surface in surfaces:
        points[surface.node_ids] = True
    for _ in range(2):
        for block, start, end in zip(mesh.blocks, mesh.starts, mesh.starts[1:]):
            found[start:end] = points[block.nodes].any(axis=1)
        for block, start, end in zip(mesh.blocks, mesh.starts, mesh.starts[1:]):
            points[block.nodes[found[start:end]]] = True
    return found


def normal_stress(
    mesh: Mesh, contactor: Surface, stress: Array, loaded: Sequence[int] | NDArray[np.int64] = ()
) -> Array:
    """Compression along the normals at the points of the contactor split at its creases, (n_points,), NaN where it is known
    worse than the pressure: linear quadrilaterals, hexahedra and wedges have at their surface the stress of their middle,
    and where loads act too the stress carries both.

    contactor: where it is now, with all points of the mesh; stress: (n_points, 6) nodal averages there; loaded: point
    numbers where loads on surfaces act."""
    split, normals = side_normals(contactor)
    owner, used = np.arange(len(split.points)), split.nodes >= 0
    owner[split.nodes[used]] = contactor.nodes[used]
    quadratic, simplex, other = np.zeros((3, len(mesh.points)), dtype=bool)
    for kind, facets in _kinds(mesh, contactor):
        which = simplex if kind in SIMPLEX else quadratic if CELLS[kind].degree == 2 else other
        nodes = contactor.nodes[facets]
        which[nodes[nodes >= 0]] = True
    there = np.linalg.norm(normals, axis=1) > 0.0
    there &= ~np.isin(owner, loaded)
    result = np.full(len(split.points), np.nan)
    plain = there & (quadratic & ~simplex & ~other)[owner]
    result[plain] = _compression(normals[plain], stress[owner[plain]])
    carried = there & (simplex & ~quadratic & ~other)[owner]
    if carried.any():
        result[carried] = _carried(_simplices(mesh), contactor.points, stress, owner[carried], normals[carried])
    return result


def _compression(normal: Array, stress: Array) -> Array:
    dim = normal.shape[1]
    return np.asarray(-np.einsum("na,nab,nb->n", normal, stress[:, ROWS][:, :dim, :dim], normal))


def _kinds(mesh: Mesh, contactor: Surface) -> Iterator[tuple[str, NDArray[np.bool_]]]:
    """The kinds of cells that a surface's facets are of, and which facets, (n_facets,)."""
    for block, start, end in zip(mesh.blocks, mesh.starts, mesh.starts[1:]):
        facets = (contactor.cells >= start) & (contactor.cells < end)
        if facets.any():
            yield block.kind, facets


def _simplices(mesh: Mesh) -> NDArray[np.int64]:
    """Their nodes, (n, dim + 1)."""
    return np.concatenate([block.nodes for block in mesh.blocks if block.kind in SIMPLEX]).astype(np.int64)


def _carried(cells: NDArray[np.int64], points: Array, stress: Array, nodes: NDArray[np.int64], normal: Array) -> Array:
    """Compression (n,) of simplices (m, dim + 1) at ``nodes`` (n,) along ``normal`` (n, dim): averages, each taken at the
    mean of the middles of its node's cells, are carried on from there by the slope of those of the nodes around."""
    number = np.full(len(points), -1)
    number[nodes] = np.arange(len(nodes))
    star = cells[(number[cells] >= 0).any(axis=1)]
    middle = _middles(cells, points, star)
    here, other = (part.ravel() for part in np.broadcast_arrays(star[:, :, None], star[:, None, :]))
    kept = (number[here] >= 0) & (here != other)
    here, other = here[kept], other[kept]
    i = number[here]
    away = middle[other] - middle[here]
    rise = _compression(normal[i], stress[other] - stress[here])
    close = 1.0 / np.maximum((away**2).sum(axis=1), 1e-300)
    metric, rate = np.zeros((len(nodes), *2 * points.shape[1:])), np.zeros((len(nodes), points.shape[1]))
    for a, b in np.ndindex(metric.shape[1:]):
        metric[:, a, b] = np.bincount(i, close * away[:, a] * away[:, b], len(nodes))
    for a in range(rate.shape[1]):
        rate[:, a] = np.bincount(i, close * rise * away[:, a], len(nodes))
    slope = np.einsum("nab,nb->na", np.linalg.pinv(metric, rcond=EVEN, hermitian=True), rate)
    return np.asarray(_compression(normal, stress[nodes]) + (slope * (points[nodes] - middle[nodes])).sum(axis=1))


def _middles(cells: NDArray[np.int64], points: Array, star: NDArray[np.int64]) -> Array:
    """Mean of the middles of the cells around each node of ``star``, (n_points, dim)."""
    near = np.zeros(len(points), dtype=bool)
    near[star] = True
    around = cells[near[cells].any(axis=1)]
    count = np.bincount(around.ravel(), minlength=len(points))
    means = np.repeat(points[around].mean(axis=1), around.shape[1], axis=0)
    total = np.column_stack([np.bincount(around.ravel(), mean, len(points)) for mean in means.T])
    return np.asarray(total / np.maximum(count, 1)[:, None])
