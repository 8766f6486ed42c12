"""Facets of all cells by their corners: which cells own a facet, and on how many sides it has cells."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.mesh.record import MeshRecord
from abut.types import Array


def row_codes(rows: Array) -> NDArray[np.int64]:
    """A number for each row (n, k) of whole numbers >= -1: equal where the rows are, and in the rows' order. To sort and
    compare these is several times faster than the rows."""
    values = rows.astype(np.int64) + 1
    base = int(values.max(initial=0)) + 1
    code, size = np.zeros(len(values), np.int64), 1
    for column in values.T:
        if size * base > np.iinfo(np.int64).max:
            code = np.unique(code, return_inverse=True)[1]
            size = int(code.max(initial=0)) + 1
        code, size = code * base + column, size * base
    return code


def single(codes: NDArray[np.int64]) -> NDArray[np.int64]:
    """Which numbers (n,) no other one equals, in their order."""
    order = np.argsort(codes)
    new = np.ones(len(order) + 1, dtype=bool)
    new[1:-1] = np.diff(codes[order]) != 0
    return order[new[:-1] & new[1:]]


def corner_keys(corners: NDArray[np.int64]) -> NDArray[np.int64]:
    """Facets (n, corners) as sorted corner numbers (n, 4), padded at the end with -1."""
    result = np.full((len(corners), 4), -1, dtype=np.int64)
    result[:, : corners.shape[1]] = np.sort(corners, axis=1)
    return result


def facet_keys(mesh: MeshRecord, among: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Corner keys (n, 4) and rows (n, 2) = (cell, local facet) of the facets whose corners are all in ``among``.

    The filter comes first because sorting the facets of every cell is what would cost time on large meshes.
    """
    wanted = np.zeros(len(mesh.points), dtype=bool)
    wanted[among] = True
    keys, rows = [np.empty((0, 4), np.int64)], [np.empty((0, 2), np.int64)]
    for block, first in zip(mesh.blocks, mesh.starts):
        near = np.flatnonzero(wanted[block.nodes].any(axis=1))
        for local, (kind, nodes) in enumerate(CELLS[block.kind].facets):
            corners = block.nodes[near][:, nodes[: CELLS[kind].corners]].astype(np.int64)
            hit = np.flatnonzero(wanted[corners].all(axis=1))
            keys.append(corner_keys(corners[hit]))
            rows.append(np.stack([first + near[hit], np.full(len(hit), local)], axis=1))
    return np.concatenate(keys), np.concatenate(rows).astype(np.int64)


def number_keys(*keys: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """Each array of keys as numbers, equal where the keys are equal."""
    _, inverse = np.unique(row_codes(np.concatenate(keys)), return_inverse=True)
    return np.split(inverse, np.cumsum([len(k) for k in keys])[:-1])


def bodies_at(mesh: MeshRecord, cells: NDArray[np.int64]) -> list[str]:
    """Names of the bodies that hold any of the cells."""
    return [name for name, of_body in mesh.bodies.items() if np.isin(cells, of_body).any()]
