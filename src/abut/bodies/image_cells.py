"""Cells next to planes of symmetry with their mirror images, which patches that do not end at a plane reach beyond it:
theory (Z4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.types import Array, Sparse

SAME = 1e-6  # places of planes, over the size of all points, that are one
ENTRY = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))  # rows and columns of xx yy zz xy yz zx


@dataclass(frozen=True)
class Plane:
    """axis: it is square to; level: the coordinate; on: (n_patches,) bool, which patches' corners lie on it."""

    axis: int
    level: float
    on: NDArray[np.bool_]


@dataclass(frozen=True)
class ImageCells:
    """Images of cells, in the order of the columns of ``around`` after the cells' own. cell: (m,) of which each is one;
    turned: (m, dim) bool, across which axes; move: (m, dim) what an image is moved by beside that; around: (n_patches,
    n_cells + m) CSR, nonzero where a cell, or an image by planes through a corner, has the patch's corner; own:
    (n_patches, n_cells + m) CSR, nonzero where an image is one by a plane through the patch's corner."""

    cell: NDArray[np.int64]
    turned: NDArray[np.bool_]
    move: Array
    around: Sparse
    own: Sparse

    def places(self, x: Array, which: NDArray[np.int64]) -> Array:
        """Positions (n, dim) in the images ``which`` (n,)."""
        return np.asarray(np.where(self.turned[which], -x, x) + self.move[which])

    def tensors(self, values: Array, which: NDArray[np.int64]) -> Array:
        """Tensors xx yy zz xy (yz zx), (n, c), in the images ``which`` (n,)."""
        sign = np.ones((len(which), 3))
        sign[:, : self.turned.shape[1]] = np.where(self.turned[which], -1.0, 1.0)
        return np.asarray(np.stack([sign[:, a] * sign[:, b] for a, b in ENTRY[: values.shape[1]]], axis=1) * values)


def planes_of(planes: NDArray[np.int32], centre: Array) -> list[Plane]:
    """The planes on which patches' corners lie, by axis and place. planes: (n_patches, 3) nonnegative where one across that
    axis does; centre: (n_patches, dim)."""
    size = float(np.ptp(centre, axis=0).max()) if len(centre) else 0.0
    found = []
    for axis in range(centre.shape[1]):
        rows = np.flatnonzero(planes[:, axis] >= 0)
        order = rows[np.argsort(centre[rows, axis])]
        level = centre[order, axis]
        for part in np.split(np.arange(len(order)), np.flatnonzero(np.diff(level) > SAME * size) + 1):
            if len(part):
                on = np.zeros(len(planes), dtype=bool)
                on[order[part]] = True
                found.append(Plane(axis, float(level[part].mean()), on))
    return found


def image_cells(around: Sparse, planes: list[Plane], dim: int) -> ImageCells:
    """around: (n_patches, n_cells) as in ``Patches``. Where planes meet images have images in turn."""
    n_patches, n_cells = around.shape
    cell, turned, move = np.arange(n_cells), np.zeros((n_cells, dim), dtype=bool), np.zeros((n_cells, dim))
    own = sp.csr_matrix((n_patches, n_cells))
    for plane in planes:
        rows = np.flatnonzero(plane.on)
        touching = around[rows].tocoo()
        free = ~turned[touching.col, plane.axis]
        columns, new = np.unique(touching.col[free], return_inverse=True)
        more = sp.csr_matrix((np.ones(len(new)), (rows[touching.row[free]], new)), shape=(n_patches, len(columns)))
        of_plane = sp.csr_matrix(plane.on.astype(float)[:, None]) @ sp.csr_matrix(np.ones((1, len(columns))))
        around = sp.hstack([around, more]).tocsr()
        own = sp.hstack([own, own[:, columns] + of_plane]).tocsr()
        across = turned[columns].copy()
        across[:, plane.axis] = True
        moved = move[columns].copy()
        moved[:, plane.axis] = 2.0 * plane.level
        cell, turned, move = (np.concatenate(pair) for pair in ((cell, cell[columns]), (turned, across), (move, moved)))
    return ImageCells(cell[n_cells:], turned[n_cells:], move[n_cells:], around, own)
