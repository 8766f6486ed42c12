"""Mesh of the belt example (needs the gmsh package; the mesh is committed, so running the job does not).

A belt of sheet half round a pulley of solid, with straight ends, all of it above the ends. Units: mm.
"""

from __future__ import annotations

from pathlib import Path

import gmsh
import numpy as np
from numpy.typing import NDArray

OUTER, BORE = 50.0, 35.0  # radii of the pulley
THICK, WIDTH, STRAIGHT = 1.0, 20.0, 20.0  # of the belt; length of its ends
CELLS, MORE = 40, 5  # of the belt round the pulley, and of each end
EDGES = ((0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7))  # Gmsh's order
QUAD8, LINE3, HEX20 = 16, 8, 17  # Gmsh's types
Points, Numbers = NDArray[np.float64], NDArray[np.int64]


def profile() -> Points:
    """The belt's middle line from its slack end at x < 0 to its tight one, (2 n + 1, 2): nodes of n cells and in their
    middles."""
    radius, y = OUTER + 0.5 * THICK, np.linspace(-STRAIGHT, 0.0, 2 * MORE + 1)[:-1]
    angle = np.linspace(np.pi, 0.0, 2 * CELLS + 1)
    slack = np.stack([np.full(len(y), -radius), y], axis=1)
    arc = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return np.concatenate([slack, arc, (slack * [-1.0, 1.0])[::-1]])


def belt() -> tuple[Points, Numbers, dict[str, Numbers]]:
    """Points, quad8 cells (two across), and the line3 cells at both ends."""
    line, z = profile(), np.linspace(0.0, WIDTH, 5)
    points = np.concatenate([np.column_stack([line, np.full(len(line), a)]) for a in z])
    at = np.arange(len(points)).reshape(len(z), len(line))
    i, j = (2 * a.ravel() for a in np.meshgrid(np.arange(len(line) // 2), np.arange(2)))
    around = ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))
    cells = np.stack([at[j + b, i + a] for a, b in around], axis=1)
    ends = {name: np.array([at[[0, 2, 1], i], at[[2, 4, 3], i]]) for name, i in (("slack", 0), ("tight", -1))}
    return points, cells, ends


def pulley() -> tuple[Points, Numbers]:
    """Points and hex20 cells."""
    r, angle, z = (
        np.linspace(BORE, OUTER, 5),
        np.linspace(1.05 * np.pi, -0.05 * np.pi, 89),
        np.linspace(-2.0, WIDTH + 2.0, 5),
    )
    a, b, c = np.meshgrid(r, angle, z, indexing="ij")
    points = np.stack([a * np.cos(b), a * np.sin(b), c], axis=-1).reshape(-1, 3)
    at = np.arange(len(points)).reshape(a.shape)
    i, j, k = (2 * a.ravel() for a in np.meshgrid(np.arange(2), np.arange(44), np.arange(2), indexing="ij"))
    corners = np.array([(0, 0, 0), (0, 2, 0), (2, 2, 0), (2, 0, 0), (0, 0, 2), (0, 2, 2), (2, 2, 2), (2, 0, 2)])
    places = np.concatenate([corners, [(corners[m] + corners[n]) // 2 for m, n in EDGES]])
    return points, np.stack([at[i + p, j + q, k + s] for p, q, s in places], axis=1)


def faces(points: Points, cells: Numbers, radius: float) -> Numbers:
    """quad8 faces whose nodes are all at a radius."""
    corner = ((0, 1, 5, 4), (3, 7, 6, 2), (0, 4, 7, 3), (1, 2, 6, 5), (0, 3, 2, 1), (4, 5, 6, 7))
    between = {frozenset(edge): 8 + n for n, edge in enumerate(EDGES)}
    every = [(*c, *(between[frozenset((c[n], c[(n + 1) % 4]))] for n in range(4))) for c in corner]
    rows = np.concatenate([cells[:, face] for face in every])
    return rows[(np.abs(np.hypot(*points[rows][..., :2].T).T - radius) < 1e-9).all(axis=1)]


def group(name: str, dim: int, kind: int, cells: Numbers) -> None:
    entity = gmsh.model.addDiscreteEntity(dim)
    gmsh.model.mesh.addElementsByType(entity, kind, [], (cells + 1).ravel())
    gmsh.model.addPhysicalGroup(dim, [entity], name=name)


def main() -> None:
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.add("belt")
    sheet, quads, ends = belt()
    solid, bricks = pulley()
    first, points = len(sheet), np.concatenate([sheet, solid])
    used = np.unique(np.concatenate([quads.ravel(), bricks.ravel() + first]))
    entity = gmsh.model.addDiscreteEntity(3)
    gmsh.model.mesh.addNodes(3, entity, used + 1, points[used].ravel())
    gmsh.model.mesh.addElementsByType(entity, HEX20, [], (bricks + first + 1).ravel())
    gmsh.model.addPhysicalGroup(3, [entity], name="pulley")
    group("belt", 2, QUAD8, quads)
    for name, lines in ends.items():
        group(name, 1, LINE3, lines)
    group("rim", 2, QUAD8, faces(solid, bricks, OUTER) + first)
    group("bore", 2, QUAD8, faces(solid, bricks, BORE) + first)
    gmsh.write(str(Path(__file__).parent / "belt.msh"))
    gmsh.finalize()


if __name__ == "__main__":
    main()
