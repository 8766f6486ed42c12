"""Surfaces for the interface tests: every facet type, with distorted nodes and curved edges at will."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.mesh.surface import Surface

FACETS_3D = ("tri3", "tri6", "quad4", "quad8", "quad9")
FACETS_2D = ("line2", "line3")
PAIRS = [*itertools.product(FACETS_3D, FACETS_3D), *itertools.product(FACETS_2D, FACETS_2D)]
Map = Callable[[NDArray[np.float64]], NDArray[np.float64]]


def pack(points: NDArray[np.float64], kind: str, nodes: NDArray[np.int64], name: str = "surface") -> Surface:
    """A surface of one facet type."""
    padded = np.full((len(nodes), 9), -1, dtype=np.int32)
    padded[:, : nodes.shape[1]] = nodes
    none = np.full(len(nodes), -1, dtype=np.int64)
    return Surface(points, np.full(len(nodes), CELLS[kind].code, np.uint8), padded, none, none, name)


def grid(
    kind: str, n: tuple[int, int], *, distort: float = 0.0, up: bool = True, bulge: Map | None = None, seed: int = 0
) -> Surface:
    """The unit square z = 0 as n[0] x n[1] quadrilaterals (or twice as many triangles), normal +z or -z (``up``).

    distort: interior corners move by this share of the facet size; edges stay straight, mid nodes in the middle.
    bulge:   map applied to all nodes afterwards (for curved edges or surfaces).
    """
    rng = np.random.default_rng(seed)
    x, y = (np.linspace(0.0, 1.0, m + 1) for m in n)
    corners = np.stack([*(g.ravel() for g in np.meshgrid(x, y, indexing="ij")), np.zeros((n[0] + 1) * (n[1] + 1))], 1)
    inside = ((corners[:, :2] > 1e-9) & (corners[:, :2] < 1.0 - 1e-9)).all(axis=1)
    corners[inside, :2] += distort * rng.uniform(-1, 1, (inside.sum(), 2)) / np.array(n)
    index = np.arange(len(corners)).reshape(n[0] + 1, n[1] + 1)
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1).reshape(-1, 4)
    cell = CELLS[kind]
    facets = quads if cell.corners == 4 else np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    if not up:
        facets = facets[:, ::-1]
    points, nodes = [corners], [facets]
    if cell.degree == 2:
        edges = np.stack([facets, np.roll(facets, -1, axis=1)], axis=-1)
        unique, inverse = np.unique(np.sort(edges.reshape(-1, 2), axis=1), axis=0, return_inverse=True)
        nodes.append(len(corners) + inverse.reshape(facets.shape))
        points.append(corners[unique].mean(axis=1))
        if cell.nodes == 9:
            nodes.append((len(corners) + len(unique) + np.arange(len(facets)))[:, None])
            points.append(corners[facets].mean(axis=1))
    every = np.concatenate(points)
    return pack(every if bulge is None else bulge(every), kind, np.concatenate(nodes, axis=1))


def line(
    kind: str, n: int, *, distort: float = 0.0, up: bool = True, bulge: Map | None = None, seed: int = 0
) -> Surface:
    """The unit interval y = 0 as n line facets, normal +y or -y (``up``); distort and bulge as for ``grid``."""
    x = np.linspace(0.0, 1.0, n + 1)
    x[1:-1] += distort * np.random.default_rng(seed).uniform(-1, 1, n - 1) / n
    i = np.arange(n)
    nodes = np.stack([i + 1, i] if up else [i, i + 1], axis=1)
    if kind == "line3":
        x, nodes = np.concatenate([x, 0.5 * (x[1:] + x[:-1])]), np.column_stack([nodes, n + 1 + i])
    points = np.column_stack([x, np.zeros_like(x)])
    return pack(points if bulge is None else bulge(points), kind, nodes)


def moved(surface: Surface, place: Map) -> Surface:
    """The surface with its points mapped."""
    return replace(surface, points=np.ascontiguousarray(place(surface.points)))


def in_plane(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Moves points within the unit square (or interval), not on its rim: edges become curved in the plane, in 2D the
    map from the reference line uneven."""
    y = x.copy()
    if x.shape[1] == 2:
        y[:, 0] += 0.03 * np.sin(2 * np.pi * x[:, 0])
        return y
    inner = np.sin(np.pi * x[:, 0]) * np.sin(np.pi * x[:, 1])
    y[:, 0] += 0.06 * inner * np.cos(np.pi * x[:, 1])
    y[:, 1] += 0.05 * inner * np.cos(np.pi * (x[:, 0] - 0.3))
    return y


def arched(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Lifts the flat surface to the parabolic cylinder of height 0.1 x^2; in the plane as ``in_plane``."""
    y = in_plane(x)
    y[:, -1] += 0.1 * y[:, 0] ** 2
    return y


SHAPES: dict[str, Map | None] = {"straight": None, "curved": in_plane, "arched": arched}
FLAT = ("straight", "curved")


def side(kind: str, n: int, shape: str, *, up: bool, seed: int) -> Surface:
    """A distorted unit surface of n facets (2D) or n x n (3D)."""
    if kind.startswith("line"):
        return line(kind, n, distort=0.2, up=up, bulge=SHAPES[shape], seed=seed)
    return grid(kind, (n, n), distort=0.2, up=up, bulge=SHAPES[shape], seed=seed)


def planar(dim: int, seed: int, *, size: float, shift: float) -> Map:
    """Scaling by ``size``, in 3D a turn by any angle, and a shift by up to ``shift``, within the plane about its
    middle."""
    rng = np.random.default_rng(seed)
    angle, move = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(-shift, shift, dim - 1)
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s], [s, c]]) if dim == 3 else np.eye(1)

    def place(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.column_stack([0.5 + move + size * (x[:, :-1] - 0.5) @ turn.T, x[:, -1]])

    return place


def opposed(
    kc: str, kt: str, seed: int, shape: str, *, size: float, shift: float, gap: float = 0.0
) -> tuple[Surface, Surface]:
    """A contactor of 2 (x 2) facets and a target of 3 (x 3), placed by ``planar`` and ``gap`` away; arched ones follow
    the same parabolic cylinder as far as their facets can."""
    contactor = side(kc, 2, shape, up=True, seed=seed)
    target = side(kt, 3, "straight" if shape == "straight" else "curved", up=False, seed=seed + 1)
    place = planar(contactor.dim, seed, size=size, shift=shift)

    def lift(x: NDArray[np.float64]) -> NDArray[np.float64]:
        y = place(x)
        y[:, -1] += gap + (0.1 * y[:, 0] ** 2 if shape == "arched" else 0.0)
        return y

    return contactor, moved(target, lift)


def turned(dim: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Any proper rotation."""
    turn, _ = np.linalg.qr(rng.normal(size=(dim, dim)))
    turn[:, 0] *= np.sign(np.linalg.det(turn))
    return turn
