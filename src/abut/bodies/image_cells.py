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
    """Images of cells. cell: (m,) of which each is one; by: (m, dim) number of the plane across each axis that made it, -1
    for none; move: (m, dim) what an image is moved by beside being turned; around: (n_patches, m) CSR, nonzero where an
    image by planes through a corner has the patch's corner; on: (n_patches, dim) number of the plane across each axis
    through the patch's corner, -1 for none."""

    cell: NDArray[np.int64]
    by: NDArray[np.int32]
    move: Array
    around: Sparse
    on: NDArray[np.int32]

    @property
    def turned(self) -> NDArray[np.bool_]:
        """(m, dim) across which axes."""
        return self.by >= 0

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
    n_patches = around.shape[0]
    on = np.full((n_patches, dim), -1, dtype=np.int32)
    for number, plane in enumerate(planes):
        on[plane.on, plane.axis] = number
    rows = np.flatnonzero((on >= 0).any(axis=1))
    touching = around[rows].tocoo()
    cell, column = np.unique(touching.col.astype(np.int64), return_inverse=True)
    row, n_own = rows[touching.row], len(cell)
    by, move = np.full((n_own, dim), -1, dtype=np.int32), np.zeros((n_own, dim))
    for number, plane in enumerate(planes):
        hit = (on[row, plane.axis] == number) & (by[column, plane.axis] < 0)
        mirrored, new = np.unique(column[hit], return_inverse=True)
        row, column = np.concatenate([row, row[hit]]), np.concatenate([column, len(cell) + new])
        across, moved = by[mirrored], move[mirrored]
        across[:, plane.axis], moved[:, plane.axis] = number, 2.0 * plane.level
        cell, by, move = (np.concatenate(pair) for pair in ((cell, cell[mirrored]), (by, across), (move, moved)))
    images = column >= n_own
    shape = n_patches, len(cell) - n_own
    of_images = sp.csr_matrix((np.ones(images.sum()), (row[images], column[images] - n_own)), shape=shape)
    return ImageCells(cell[n_own:], np.ascontiguousarray(by[n_own:]), move[n_own:], of_images, on)
