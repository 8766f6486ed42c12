"""From coordinates back to reference coordinates, in cells and on facets of any type."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.cells import CELLS
from abut.mesh.quadrature import gauss_rule

ITERATIONS = 100  # far from a curved facet Gauss-Newton converges at a rate of distance over radius
FOUND = 1e-15  # step in reference coordinates below which nothing is left to gain
BEYOND = 0.5  # how far outside the reference cell a step may lead: maps of curved cells fold over farther out
SINGULAR = 1e-10  # directions in which a cell is flatter than that, over its longest, are left out


def nearest(
    kind: str, x: NDArray[np.float64], points: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Reference coordinates (m, cell dim) of the points of m cells that are nearest to m given ones, and the way from there
    to these (m, dim), zero for points inside.

    x: (m, nodes, dim) nodes of each cell, which may be a facet; points: (m, dim). Gauss-Newton with halved steps, from the
    nearest of 3 points in each direction; it knows of no border, and what it finds outside is moved to the border of the
    reference cell: there the way is that to a point nearby, not to the nearest.
    """
    cell = CELLS[kind]
    low, high = _limits(kind)
    xi = _start(kind, x, points)
    miss = points - _at(kind, x, xi)
    scale = np.ones(len(x))
    moving = np.arange(len(x))
    for _ in range(ITERATIONS):
        if not len(moving):
            break
        _, slopes = shape_functions(cell.code, np.ascontiguousarray(xi[moving]))
        tangents = np.einsum("mna,mnd->mda", slopes, x[moving])
        step = np.einsum("mad,md->ma", np.linalg.pinv(tangents, rcond=SINGULAR), miss[moving])
        step *= scale[moving, None]
        trial = np.clip(xi[moving] + step, low - BEYOND, high + BEYOND)
        left = points[moving] - _at(kind, x[moving], trial)
        better = np.linalg.norm(left, axis=1) < np.linalg.norm(miss[moving], axis=1)
        taken = moving[better]
        xi[taken], miss[taken] = trial[better], left[better]
        scale[moving] = np.where(better, np.minimum(1.0, 2.0 * scale[moving]), 0.5 * scale[moving])
        moving = moving[np.abs(step).max(axis=1) > FOUND]
    xi = within(kind, xi)
    return xi, points - _at(kind, x, xi)


def within(kind: str, xi: NDArray[np.float64]) -> NDArray[np.float64]:
    """Reference coordinates (m, cell dim) moved into the reference cell where they lie outside."""
    low, high = _limits(kind)
    xi = np.clip(xi, low, high)
    simplex = _simplex(kind)
    total = xi[:, :simplex].sum(axis=1, keepdims=True)
    xi[:, :simplex] /= np.maximum(total, 1.0)
    return xi


def _simplex(kind: str) -> int:
    """How many of the reference coordinates are those of a triangle or tetrahedron; the others run from -1 to 1."""
    cell = CELLS[kind]
    if kind.startswith("wedge"):
        return 2
    return cell.dim if cell.corners == cell.dim + 1 and cell.dim > 1 else 0


def _limits(kind: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    low = np.full(CELLS[kind].dim, -1.0)
    low[: _simplex(kind)] = 0.0
    return low, np.ones(CELLS[kind].dim)


def _at(kind: str, x: NDArray[np.float64], xi: NDArray[np.float64]) -> NDArray[np.float64]:
    shapes, _ = shape_functions(CELLS[kind].code, np.ascontiguousarray(xi))
    return np.asarray(np.einsum("mn,mnd->md", shapes, x))


def _start(kind: str, x: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    grid, _ = gauss_rule(kind, 3)
    shapes, _ = shape_functions(CELLS[kind].code, np.ascontiguousarray(grid))
    away = np.linalg.norm(shapes @ x - points[:, None], axis=2)
    return grid[np.argmin(away, axis=1)].copy()
