"""Pairs of surfaces made facet by facet, distorted and curved, for what is tested without bodies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.cells import BY_CODE, CELLS
from abut.mesh.surface import Surface
from abut.types import Array

Place = Callable[..., list[Array]]  # of parameters from 0 to 1 to coordinates


def turned(kind: str) -> list[int]:
    """Order of a facet's nodes seen from its other side."""
    cell = CELLS[kind]
    n = cell.corners
    if cell.dim == 1:
        return [1, 0, 2][: cell.nodes]
    return [0, *range(n - 1, 0, -1), *range(2 * n - 1, n - 1, -1), *range(2 * n, cell.nodes)][: cell.nodes]


def turn(surface: Surface) -> Surface:
    """The surface seen from its other side."""
    nodes = surface.nodes.copy()
    for facet, code in enumerate(surface.kinds):
        order = turned(BY_CODE[code].name)
        nodes[facet, : len(order)] = surface.nodes[facet, order]
    return replace(surface, nodes=nodes)


def chain(kind: str, n: int, place: Place, noise: float = 0.0, seed: int = 0, axisymmetric: bool = False) -> Surface:
    """n facets in 2D along place(s); each coordinate is moved by up to ``noise`` of a facet."""
    step = CELLS[kind].degree
    s = np.linspace(0.0, 1.0, step * n + 1)
    first = step * np.arange(n)
    facets = np.stack([first, first + step, first + 1], axis=1)[:, : CELLS[kind].nodes]
    return _surface(kind, facets, np.stack(place(s), axis=1), noise / n, seed, axisymmetric)


def sheet(kind: str, n: int, place: Place, noise: float = 0.0, seed: int = 0) -> Surface:
    """n x n facets in 3D, or twice as many triangles, over place(s, t)."""
    f = CELLS[kind].degree
    grid = np.arange((f * n + 1) ** 2).reshape(f * n + 1, f * n + 1)
    facets = []
    for i in range(0, f * n, f):
        for j in range(0, f * n, f):
            g = grid[i : i + f + 1, j : j + f + 1]
            if kind.startswith("tri"):
                half = [g[0, 0], g[f, 0], g[0, f]], [g[f, f], g[0, f], g[f, 0]]
                middle = [g[1, 0], g[1, 1], g[0, 1]], [g[1, f], g[1, 1], g[f, 1]]
                facets += [a + b if f == 2 else a for a, b in zip(half, middle, strict=True)]
            else:
                corners = [g[0, 0], g[f, 0], g[f, f], g[0, f]]
                facets.append([*corners, g[1, 0], g[f, 1], g[1, f], g[0, 1], g[1, 1]][: CELLS[kind].nodes])
    s, t = np.meshgrid(np.linspace(0, 1, f * n + 1), np.linspace(0, 1, f * n + 1), indexing="ij")
    return _surface(kind, np.array(facets), np.stack(place(s.ravel(), t.ravel()), axis=1), noise / n, seed, False)


def _surface(
    kind: str, facets: NDArray[np.int64], points: NDArray[np.float64], noise: float, seed: int, axisymmetric: bool
) -> Surface:
    used, number = np.unique(facets, return_inverse=True)
    nodes = np.full((len(facets), 9), -1, dtype=np.int32)
    nodes[:, : facets.shape[1]] = number.reshape(facets.shape)
    points = points[used] + noise * np.random.default_rng(seed).uniform(-1.0, 1.0, (len(used), points.shape[1]))
    unknown = np.full(len(facets), -1)
    kinds = np.full(len(facets), CELLS[kind].code, dtype=np.uint8)
    return Surface(points, kinds, nodes, unknown, unknown, kind, axisymmetric)


def together(first: Surface, second: Surface) -> Surface:
    """The facets of both."""
    nodes = second.nodes.copy()
    nodes[nodes >= 0] += len(first.points)
    return replace(
        first,
        points=np.concatenate([first.points, second.points]),
        kinds=np.concatenate([first.kinds, second.kinds]),
        nodes=np.concatenate([first.nodes, nodes]),
        cells=np.concatenate([first.cells, second.cells]),
        local=np.concatenate([first.local, second.local]),
    )
