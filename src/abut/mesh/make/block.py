"""Structured grids: rectangles, boxes, and what maps them to other shapes."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from abut import checks
from abut.cells import CELLS
from abut.errors import InputError
from abut.mesh.cell_block import CellBlock
from abut.mesh.make.grading import graded_axis
from abut.mesh.mesh import Mesh
from abut.mesh.promote import promote

PLANE_CELLS = ("tri3", "tri6", "quad4", "quad8", "quad9")
SOLID_CELLS = ("tet4", "tet10", "hex8", "hex20", "hex27", "wedge6", "wedge15")
# A hexahedron as six tetrahedra around the diagonal 0-6, or two wedges: neighbours fit without turning.
TETRAHEDRA = ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6))
WEDGES = ((0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7))
TRIANGLES = ((0, 1, 2), (0, 2, 3))
LINEAR = {"tri": "tri3", "qua": "quad4", "tet": "tet4", "hex": "hex8", "wed": "wedge6"}
NAMES = {2: ("left", "right", "bottom", "top"), 3: ("left", "right", "front", "back", "bottom", "top")}
Move = Callable[[NDArray[np.float64]], NDArray[np.float64]]

MOST_POINTS = 100_000_000  # of a body that abut makes


def axis(limits: Sequence[float], cells: int | Sequence[float], name: str) -> NDArray[np.float64]:
    """Coordinates of grid lines: ``cells`` equal ones between the two limits, or the lines themselves."""
    if not isinstance(cells, int):
        if isinstance(cells, (str, float)):
            raise InputError(f"{name}: expected a whole number of cells, got {cells!r}")
        lines = checks.array(cells, f"{name}: grid lines", shape=(None,))
        if len(lines) < 2 or (np.diff(lines) <= 0).any():
            raise InputError(f"{name}: grid lines must increase, got {list(cells)}")
        return lines
    low, high = checks.array(limits, name, shape=(2,))
    if not low < high:
        raise InputError(f"{name}: expected [low, high] with low < high, got {list(limits)}")
    if isinstance(cells, bool) or not 1 <= cells <= MOST_POINTS:
        raise InputError(f"cells: expected whole numbers from 1 to {MOST_POINTS}, got {cells!r}")
    return np.linspace(low, high, cells + 1)


def grid(lines: Sequence[NDArray[np.float64]], cell: str, move: Move | None = None) -> Mesh:
    """A tensor grid of one body "body" with its sides as surfaces; ``move`` maps the corner points first, so that edges
    stay straight between them."""
    dim = len(lines)
    checks.choice(cell, "cell", PLANE_CELLS if dim == 2 else SOLID_CELLS)
    shape = [len(x) for x in lines]
    if math.prod(shape) > MOST_POINTS:
        raise InputError(f"cells: {' x '.join(str(n - 1) for n in shape)} are more than abut makes; take fewer")
    index = np.arange(int(np.prod(shape))).reshape(shape)
    points = np.stack([g.ravel() for g in np.meshgrid(*lines, indexing="ij")], axis=1)
    low, high = slice(None, -1), slice(1, None)
    if dim == 2:
        corners = [index[low, low], index[high, low], index[high, high], index[low, high]]
        pieces: tuple[tuple[int, ...], ...] | None = TRIANGLES if cell.startswith("tri") else None
    else:
        bottom = [(low, low), (high, low), (high, high), (low, high)]
        corners = [index[(*ij, k)] for k in (low, high) for ij in bottom]
        pieces = TETRAHEDRA if cell.startswith("tet") else WEDGES if cell.startswith("wedge") else None
    cells = np.stack([c.ravel() for c in corners], axis=1)
    if pieces is not None:
        cells = cells[:, np.array(pieces)].reshape(-1, len(pieces[0]))
    on_side = {}
    lattice = np.stack([g.ravel() for g in np.meshgrid(*[np.arange(n) for n in shape], indexing="ij")], axis=1)
    for a in range(dim):
        for side, value in enumerate((0, shape[a] - 1)):
            on_side[NAMES[dim][2 * a + side]] = lattice[:, a] == value
    linear = LINEAR[cell[:3]]
    surfaces = {name: _facets_on(cells, linear, flag) for name, flag in on_side.items()}
    points, nodes = promote(points if move is None else move(points), cells, linear, cell)
    body = {"body": np.arange(len(nodes), dtype=np.int64)}
    return Mesh(np.ascontiguousarray(points), (CellBlock(cell, nodes),), body, surfaces)


def _facets_on(cells: NDArray[np.int64], linear: str, flag: NDArray[np.bool_]) -> NDArray[np.int64]:
    on = flag[cells]
    near = np.flatnonzero(on.any(axis=1))
    rows = []
    for number, (_, nodes) in enumerate(CELLS[linear].facets):
        hit = near[on[near][:, nodes].all(axis=1)]
        rows.append(np.stack([hit, np.full(len(hit), number)], axis=1))
    return np.concatenate(rows).astype(np.int64)


def rectangle(
    x: Sequence[float] = (0.0, 1.0),
    y: Sequence[float] = (0.0, 1.0),
    cells: Sequence[int] = (4, 4),
    cell: str = "quad8",
    fine: Mapping[str, Sequence[float]] | None = None,
    growth: float = 1.25,
) -> Mesh:
    """A rectangle of ``cells`` = (nx, ny) quadrilaterals, or twice as many triangles.

    x, y: [low, high], or more than two values: the grid lines themselves. Surfaces left right bottom top.
    fine: zones like {x = [-1, 1]} that get the cells of that axis; outside they grow by ``growth``.
    """
    return grid(axes((x, y), cells, fine, growth, "rectangle"), cell)


def box(
    x: Sequence[float] = (0.0, 1.0),
    y: Sequence[float] = (0.0, 1.0),
    z: Sequence[float] = (0.0, 1.0),
    cells: Sequence[int] = (4, 4, 4),
    cell: str = "hex8",
    fine: Mapping[str, Sequence[float]] | None = None,
    growth: float = 1.25,
) -> Mesh:
    """A box of ``cells`` = (nx, ny, nz) hexahedra, or as many times two wedges or six tetrahedra.

    x, y, z: [low, high], or more than two values: the grid lines themselves. Surfaces left right (x), front back (y),
    bottom top (z). fine, growth: as for ``rectangle``.
    """
    return grid(axes((x, y, z), cells, fine, growth, "box"), cell)


def axes(
    limits: Sequence[Sequence[float]],
    cells: Sequence[int],
    fine: Mapping[str, Sequence[float]] | None,
    growth: float,
    what: str,
) -> list[NDArray[np.float64]]:
    """Grid lines of every axis from limits (or the lines themselves), cell counts and fine zones; ``what`` for errors."""
    if isinstance(cells, (int, str)) or len(cells) != len(limits):
        raise InputError(f"{what}: cells: expected {len(limits)} whole numbers, got {cells!r}")
    if checks.finite(growth, f"{what}: growth") <= 1.0:
        raise InputError(f"{what}: growth: expected a number > 1, got {growth!r}")
    zones = dict(fine or {})
    unknown = sorted(set(zones) - set("xyz"[: len(limits)]))
    if unknown:
        raise InputError(f"{what}: fine: no axis {unknown[0]!r}; use {', '.join('xyz'[: len(limits)])}")
    lines = []
    for pair, n, name in zip(limits, cells, "xyz"):
        if name in zones:
            axis(pair, n, f"{what}: {name}")  # checks limits and count
            lines.append(graded_axis(pair, zones[name], n, growth, f"{what}: {name}"))
        else:
            lines.append(axis(pair, pair if len(pair) > 2 else n, f"{what}: {name}"))
    return lines
