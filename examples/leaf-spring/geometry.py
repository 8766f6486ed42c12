"""Mesh of the leaf-spring example (needs the gmsh package; the mesh is committed, so running the job does not).

Five leaves of one width on each other, the longest uppermost: half of a spring, clamped where its bolt is. Units: mm.
"""

from __future__ import annotations

from pathlib import Path

import gmsh

LENGTHS = (200.0, 160.0, 120.0, 80.0, 40.0)
THICK, WIDTH, CELL = 4.0, 20.0, 4.0


def leaf(number: int, length: float) -> None:
    """A sheet from x = 0 on, of quad4 cells, two across; its groups: all of it, its outer half, its two ends."""
    geo, z = gmsh.model.geo, -number * THICK
    below, above = ([geo.addPoint(x, y, z) for x in (0.0, 0.5 * length, length)] for y in (0.0, WIDTH))
    across = [geo.addLine(a, b) for a, b in zip(below, above)]
    sheets = []
    for i in range(2):
        first, second = geo.addLine(below[i], below[i + 1]), geo.addLine(above[i], above[i + 1])
        sheets.append(geo.addPlaneSurface([geo.addCurveLoop([first, across[i + 1], -second, -across[i]])]))
        for side in (first, second):
            geo.mesh.setTransfiniteCurve(side, round(0.5 * length / CELL) + 1)
    for side in across:
        geo.mesh.setTransfiniteCurve(side, 3)
    for sheet in sheets:
        geo.mesh.setTransfiniteSurface(sheet)
        geo.mesh.setRecombine(2, sheet)
    geo.synchronize()
    gmsh.model.addPhysicalGroup(2, sheets, name=f"leaf{number}")
    gmsh.model.addPhysicalGroup(2, sheets[1:], name=f"end{number}")
    gmsh.model.addPhysicalGroup(1, across[:1], name=f"root{number}")
    gmsh.model.addPhysicalGroup(1, across[2:], name=f"tip{number}")


def main() -> None:
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.add("leaf-spring")
    for number, length in enumerate(LENGTHS):
        leaf(number, length)
    gmsh.model.mesh.generate(2)
    gmsh.write(str(Path(__file__).parent / "leaf-spring.msh"))
    gmsh.finalize()


if __name__ == "__main__":
    main()
