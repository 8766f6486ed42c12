"""Seams of a contactor: edges along which bodies that are glued to each other carry one contact.

A point of a seam has one displacement, but a function on either side of it: two constraints, as where several contacts meet
(``shared_points``), with pressures beside each other of which one is too large by what the other one lacks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from abut.contact.coupling import Coupling
from abut.contact.geometry import CREASE, side_normals
from abut.contact.pressure_space import PressureSpace, following
from abut.contact.rim import rim
from abut.mesh.surface import Surface
from abut.types import Array, Sparse

SAME = 1e-9  # of a glued side: points nearer to each other are at one place
NEAR = 0.1  # of an edge: how far points of the other side lie off it, by its sagitta (an eighth of its angle; the test on a
# curve) and by what glue bridges

Glue = tuple[NDArray[np.int64], NDArray[np.int64]]  # points of a tie's contactor, and of its target


def along_seams(space: PressureSpace, contactor: Surface, coupling: Coupling, glue: Sequence[Glue]) -> PressureSpace:
    """The space with one pressure along seams, theory (P29): functions at points of a tie's contactor, which goes
    where the target takes it, have the value there of those on the target."""
    follow = None
    for dependent, master in glue if space.continuous else ():
        mine, theirs = (np.isin(space.node, points) for points in (dependent, master))
        if (mine & ~theirs).any() and (theirs & ~mine).any():
            follow = _followed(space, contactor, mine & ~theirs, theirs & ~mine, follow)
    if follow is None:
        return space
    pairs = follow.tocoo()
    one, other = space.side[np.stack([pairs.row, pairs.col])[:, pairs.row != pairs.col]]
    return replace(following(space, coupling, follow), seams=np.stack([one, other], axis=1))


def one_place(points: Array, glue: Sequence[Glue]) -> NDArray[np.int64]:
    """For every point (n_points, dim) the one that stands for it and those that glue holds at the same place."""
    n, rows, columns = len(points), [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
    for dependent, master in glue:
        apart, nearest = cKDTree(points[master]).query(points[dependent])
        met = apart <= SAME * np.ptp(points[master], axis=0).max()
        rows.append(dependent[met])
        columns.append(master[nearest[met]])
    row, column = np.concatenate(rows), np.concatenate(columns)
    _, label = connected_components(sp.csr_matrix((np.ones(len(row)), (row, column)), shape=(n, n)), directed=False)
    return np.unique(label, return_index=True)[1][label]


def _followed(
    space: PressureSpace, contactor: Surface, mine: NDArray[np.bool_], theirs: NDArray[np.bool_], earlier: Sparse | None
) -> Sparse | None:
    """Values of all functions from those that stay, (n, n), where functions ``mine`` (n,) of one side of a seam follow
    ``theirs``; earlier: the same of other seams."""
    n = len(space)
    now = sp.identity(n, format="csr") if earlier is None else earlier
    weights = _weights(space, contactor, np.flatnonzero(mine), np.flatnonzero(theirs))
    own = np.asarray(weights.sum(axis=1)).ravel() > 0.0
    own &= (weights @ now).diagonal() == 0.0  # bodies glued in a ring: not itself by way of others
    own &= now.diagonal() == 1.0
    if not own.any():
        return earlier
    change = sp.diags((~own).astype(float)) + sp.diags(own.astype(float)) @ weights
    return (change @ now @ change if earlier is not None else change).tocsr()


def _weights(space: PressureSpace, contactor: Surface, mine: NDArray[np.int64], theirs: NDArray[np.int64]) -> Sparse:
    """The value of functions ``mine`` of one side of a seam by those of the other, (n, n): between the ends of the edge on
    which a point lies."""
    split, normals = side_normals(contactor)
    ends = np.unique(np.sort(rim(split).ends, axis=1), axis=0)
    function = np.full(len(split.points), -1)
    function[space.side[theirs]] = theirs
    ends = ends[(function[ends] >= 0).all(axis=1)]
    n, x = len(space), split.points
    if not len(ends):
        return sp.csr_matrix((n, n))
    size = np.maximum(np.linalg.norm(x[ends[:, 1]] - x[ends[:, 0]], axis=1), _reach(split, ends))
    rows, columns, values = [], [], []
    for k in mine.tolist():
        point = space.side[k]
        along, off = _on_edges(x[point], x[ends])
        off = np.where((normals[ends] @ normals[point] > CREASE).all(axis=1), off / size, np.inf)
        best = int(off.argmin())
        if off[best] < NEAR:
            t = along[best]
            rows += [k, k]
            columns += function[ends[best]].tolist()
            values += [1.0 - t, t]
    weights = sp.csr_matrix((values, (rows, columns)), shape=(n, n))
    weights.eliminate_zeros()
    return weights


def _on_edges(point: Array, edges: Array) -> tuple[Array, Array]:
    """Where on each edge (m, 2, dim) the place nearest to a point (dim,) is, 0 to 1, and how far off, each (m,)."""
    start, along = edges[:, 0], edges[:, 1] - edges[:, 0]
    length = np.maximum((along**2).sum(axis=1), 1e-300)
    t = np.clip(((point - start) * along).sum(axis=1) / length, 0.0, 1.0)
    return t, np.linalg.norm(start + t[:, None] * along - point, axis=1)


def _reach(surface: Surface, ends: NDArray[np.int64]) -> Array:
    """Sizes (m,) of the facets at single points, which edges in 2D are; else zero."""
    if surface.dim == 3:
        return np.zeros(len(ends))
    size = np.zeros(len(surface.points))
    np.maximum.at(
        size, surface.nodes[:, :2], np.linalg.norm(np.diff(surface.points[surface.nodes[:, :2]], axis=1), axis=2)
    )
    return size[ends[:, 0]]
