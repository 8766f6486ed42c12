"""Mesh of the pipe-clip example (needs the gmsh package; the mesh is committed, so running the job does not).

Half a clip of sheet, U-shaped with a flared end, and half a pipe of solid, above the plane y = 0. Units: mm.
"""

from __future__ import annotations

from pathlib import Path

import gmsh
import numpy as np
from numpy.typing import NDArray

OUTER, BORE = 10.0, 7.0  # radii of the pipe
THICK, WIDTH = 1.5, 10.0  # of the clip
TIGHT = 1.0  # by how much the arm's lower face is nearer to the plane than the pipe's top
KNEE, ARM = 6.0, 16.0  # where the flat arm begins at the outset, and how long it is
FLARE, TURN, END = 6.0, np.radians(25.0), 3.0  # radius of the arc that the end begins with, its angle, the rest
MIDDLE = OUTER - TIGHT + 0.5 * THICK  # height of the arm's middle line, and radius of the bend
EDGES = ((0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7))  # Gmsh's order
QUAD8, LINE3, HEX20 = 16, 8, 17  # Gmsh's types
Points, Numbers = NDArray[np.float64], NDArray[np.int64]


def profile() -> Points:
    """The clip's middle line from its end to its apex, (2 n + 1, 2): nodes of n cells and in their middles."""
    angle = np.linspace(TURN, 0.0, 7)
    arc = np.stack([KNEE - FLARE * np.sin(angle), MIDDLE + FLARE * (1.0 - np.cos(angle))], axis=1)
    way = np.linspace(END, 0.0, 7)[:-1, None] * [-np.cos(TURN), np.sin(TURN)]
    x = np.linspace(KNEE, KNEE + ARM, 33)[1:]
    turn = np.linspace(0.5 * np.pi, 0.0, 17)[1:]
    bend = np.stack([KNEE + ARM + MIDDLE * np.cos(turn), MIDDLE * np.sin(turn)], axis=1)
    return np.concatenate([arc[0] + way, arc, np.stack([x, np.full(len(x), MIDDLE)], axis=1), bend])


def clip() -> tuple[Points, Numbers, Numbers]:
    """Points, quad8 cells (two across), and the line3 cells at the apex."""
    line, z = profile(), np.linspace(0.0, WIDTH, 5)
    points = np.concatenate([np.column_stack([line, np.full(len(line), a)]) for a in z])
    at = np.arange(len(points)).reshape(len(z), len(line))
    i, j = (2 * a.ravel() for a in np.meshgrid(np.arange(len(line) // 2), np.arange(2)))
    around = ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))
    cells = np.stack([at[j + b, i + a] for a, b in around], axis=1)
    return points, cells, np.array([[at[0, -1], at[2, -1], at[1, -1]], [at[2, -1], at[4, -1], at[3, -1]]])


def pipe() -> tuple[Points, Numbers, dict[str, Numbers]]:
    """Points, hex20 cells and the quad8 faces outside, in the bore and on the plane."""
    r, angle, z = np.linspace(BORE, OUTER, 5), np.linspace(np.pi, 0.0, 57), np.linspace(-1.0, WIDTH + 1.0, 5)
    a, b, c = np.meshgrid(r, angle, z, indexing="ij")
    points = np.stack([a * np.cos(b), a * np.sin(b), c], axis=-1).reshape(-1, 3)
    at = np.arange(len(points)).reshape(a.shape)
    i, j, k = (2 * a.ravel() for a in np.meshgrid(np.arange(2), np.arange(28), np.arange(2), indexing="ij"))
    corners = np.array([(0, 0, 0), (0, 2, 0), (2, 2, 0), (2, 0, 0), (0, 0, 2), (0, 2, 2), (2, 2, 2), (2, 0, 2)])
    places = np.concatenate([corners, [(corners[m] + corners[n]) // 2 for m, n in EDGES]])
    cells = np.stack([at[i + p, j + q, k + s] for p, q, s in places], axis=1)
    faces = {}
    for name, chosen, on in (
        ("outside", i == 2, lambda p: p[:, 0] == 2), ("bore", i == 0, lambda p: p[:, 0] == 0),
        ("cut", (j == 0) | (j == 54), None),
    ):  # fmt: skip
        rows = []
        for m in np.flatnonzero(chosen):
            here = on(places) if on else places[:, 1] == (0 if j[m] == 0 else 2)
            rows.append(_in_turn(cells[m], places, np.flatnonzero(here)))
        faces[name] = np.array(rows)
    return points, cells, faces


def _in_turn(cell: Numbers, places: Numbers, here: Numbers) -> Numbers:
    """The 8 nodes of a face: corners round it, then those between."""
    flat = np.delete(places[here], np.flatnonzero(np.ptp(places[here], axis=0) == 0)[0], axis=1) - 1
    order = [int(np.flatnonzero((flat == step).all(axis=1))[0])
             for step in ((-1, -1), (1, -1), (1, 1), (-1, 1), (0, -1), (1, 0), (0, 1), (-1, 0))]  # fmt: skip
    return np.asarray(cell[here[order]])


def group(name: str, dim: int, kind: int, cells: Numbers) -> None:
    entity = gmsh.model.addDiscreteEntity(dim)
    gmsh.model.mesh.addElementsByType(entity, kind, [], (cells + 1).ravel())
    gmsh.model.addPhysicalGroup(dim, [entity], name=name)


def main() -> None:
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.add("pipe-clip")
    sheet, quads, apex = clip()
    solid, bricks, faces = pipe()
    bricks, first = bricks + len(sheet), len(sheet)
    used = np.unique(np.concatenate([quads.ravel(), bricks.ravel()]))
    entity = gmsh.model.addDiscreteEntity(3)
    gmsh.model.mesh.addNodes(3, entity, used + 1, np.concatenate([sheet, solid])[used].ravel())
    gmsh.model.mesh.addElementsByType(entity, HEX20, [], (bricks + 1).ravel())
    gmsh.model.addPhysicalGroup(3, [entity], name="pipe")
    group("clip", 2, QUAD8, quads)
    group("apex", 1, LINE3, apex)
    for name, rows in faces.items():
        group(name, 2, QUAD8, rows + first)
    gmsh.write(str(Path(__file__).parent / "pipe-clip.msh"))
    gmsh.finalize()


if __name__ == "__main__":
    main()
