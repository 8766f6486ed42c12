"""Mesh of the stiffened-panel example (needs the gmsh package; the mesh is committed, so running the job does not).

A panel of sheet, a thicker rib on it, and four square bolts of solid through holes in both. Units: mm.
"""

from __future__ import annotations

from pathlib import Path

import gmsh
import numpy as np
from numpy.typing import NDArray

PANEL, RIB = 2.0, 6.0  # thicknesses; the panel's middle is z = 0, the rib lies on it
BOLTS = (30.0, 90.0, 150.0, 210.0)  # places along x, on y = 0; the panel goes from 0 to 240
SHANK, HOLE, HEAD, HIGH = 3.0, 4.0, 8.0, 4.0  # halves of widths, height of head and nut
BESIDE = np.array([-30.0, -19.0, -8.0, -4.0, 0.0, 4.0, 8.0, 19.0, 30.0])  # lines about each bolt
X = np.unique(np.concatenate([b + BESIDE for b in BOLTS]))
INNER, OUTER = [-12.0, -8.0, -4.0, 0.0, 4.0, 8.0, 12.0], [26.0, 40.0]  # along y: of the rib, and of the panel beyond
HEX20, QUAD8, QUAD4, LINE2 = 17, 16, 3, 1  # Gmsh's types
EDGES = ((0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7))  # Gmsh's order
Points, Numbers = NDArray[np.float64], NDArray[np.int64]


def sheet(y: Points, z: float) -> tuple[Points, Numbers, dict[str, Numbers]]:
    """Points and quad4 cells with holes, and the lines at both ends."""
    a, b = np.meshgrid(X, y, indexing="ij")
    points = np.stack([a.ravel(), b.ravel(), np.full(a.size, z)], axis=1)
    at = np.arange(a.size).reshape(a.shape)
    cells = np.stack([at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]], axis=-1).reshape(-1, 4)
    middle = points[cells].mean(axis=1)
    open_ = (np.abs(middle[:, 1]) < HOLE) & (np.abs(middle[:, :1] - BOLTS).min(axis=1) < HOLE)
    ends = {name: np.stack([row[:-1], row[1:]], axis=1) for name, row in (("left", at[0]), ("right", at[-1]))}
    return points, cells[~open_], ends


def bolt(x: float) -> tuple[Points, Numbers, dict[str, Numbers]]:
    """Points and hex20 cells, and the quad8 faces under head and nut."""
    low, high = -0.5 * PANEL, 0.5 * PANEL + RIB
    wide, up = (
        np.array([-HEAD, -SHANK, SHANK, HEAD]),
        np.concatenate([[low - HIGH], np.linspace(low, high, 4), [high + HIGH]]),
    )
    cells, points = list[Points](), list[Points]()
    for k in range(len(up) - 1):
        for i in range(3):
            for j in range(3):
                if k in (0, len(up) - 2) or i == j == 1:
                    corner = np.array(
                        [
                            (wide[i + p], wide[j + q], up[k + r])
                            for r in (0, 1)
                            for p, q in ((0, 0), (1, 0), (1, 1), (0, 1))
                        ]
                    )
                    cells.append(np.concatenate([corner, [(corner[m] + corner[n]) / 2 for m, n in EDGES]]))
    every = np.concatenate(cells) + np.array([x, 0.0, 0.0])
    points, inverse = np.unique(np.round(every, 9), axis=0, return_inverse=True)
    rows = inverse.reshape(-1, 20)
    faces = {}
    for name, z, order in (("heads", high, (0, 3, 2, 1, 9, 13, 11, 8)), ("nuts", low, (4, 5, 6, 7, 16, 18, 19, 17))):
        face = rows[:, order]
        middle = points[face[:, :4]].mean(axis=1)
        under = (np.abs(middle[:, 2] - z) < 1e-6) & (np.abs(middle[:, :2] - [x, 0.0]).max(axis=1) > SHANK)
        faces[name] = face[under]
    return points, rows, faces


def main() -> None:
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.add("stiffened-panel")
    wide = np.concatenate([-np.array(OUTER[::-1]), INNER, OUTER])
    groups: list[tuple[str, int, int, Numbers]] = []
    points, quads, ends = sheet(wide, 0.0)
    parts, first = [points], len(points)
    groups += [("panel", 2, QUAD4, quads), *((name, 1, LINE2, rows) for name, rows in ends.items())]
    points, quads, _ = sheet(np.array(INNER), 0.5 * (PANEL + RIB))
    groups.append(("rib", 2, QUAD4, quads + first))
    parts, first = [*parts, points], first + len(points)
    faces: dict[str, list[Numbers]] = {"heads": [], "nuts": []}
    for number, x in enumerate(BOLTS, start=1):
        points, bricks, under = bolt(x)
        groups.append((f"bolt{number}", 3, HEX20, bricks + first))
        for name, rows in under.items():
            faces[name].append(rows + first)
        parts, first = [*parts, points], first + len(points)
    groups += [(name, 2, QUAD8, np.concatenate(rows)) for name, rows in faces.items()]
    used = np.unique(np.concatenate([rows.ravel() for _, _, _, rows in groups]))
    entities = [gmsh.model.addDiscreteEntity(dim) for _, dim, _, _ in groups]
    gmsh.model.mesh.addNodes(groups[0][1], entities[0], used + 1, np.concatenate(parts)[used].ravel())
    for entity, (name, dim, kind, rows) in zip(entities, groups):
        gmsh.model.mesh.addElementsByType(entity, kind, [], (rows + 1).ravel())
        gmsh.model.addPhysicalGroup(dim, [entity], name=name)
    gmsh.write(str(Path(__file__).parent / "stiffened-panel.msh"))
    gmsh.finalize()


if __name__ == "__main__":
    main()
