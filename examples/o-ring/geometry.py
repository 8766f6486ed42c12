"""Geometry and mesh of the O-ring example (needs the gmsh package; the mesh is committed, so running the job does not).

The section of a ring of 3.5 mm in a groove with rounded corners, under a flat cover. Units: mm.
"""

from __future__ import annotations

from pathlib import Path

import gmsh

RADIUS, WALL, DEPTH = 1.75, 2.0, 2.25  # of the ring's section; where the groove's wall is; how deep the groove is
FILLET, LIP = 0.4, 0.3  # radii of the groove's corner and of the wall's upper edge
FINE, COARSE = 0.24, 0.8


def ring() -> None:
    """A disc of which the arc from 120 to 240 degrees takes the pressure."""
    geo, centre = gmsh.model.geo, gmsh.model.geo.addPoint(0, RADIUS, 0)
    at = [(RADIUS, 0.0), (-0.5 * RADIUS, 0.75**0.5 * RADIUS), (-0.5 * RADIUS, -(0.75**0.5) * RADIUS)]
    points = [geo.addPoint(x, RADIUS + y, 0, FINE) for x, y in at]
    arcs = [geo.addCircleArc(points[i], centre, points[(i + 1) % 3]) for i in range(3)]
    surface = geo.addPlaneSurface([geo.addCurveLoop(arcs)])
    geo.synchronize()
    gmsh.model.addPhysicalGroup(2, [surface], name="ring")
    gmsh.model.addPhysicalGroup(1, arcs, name="skin")
    gmsh.model.addPhysicalGroup(1, [arcs[1]], name="wet")


def groove() -> None:
    geo = gmsh.model.geo
    line = [
        (-3.5, -1.0, COARSE), (3.5, -1.0, COARSE), (3.5, DEPTH, COARSE), (WALL + LIP, DEPTH, 0.5 * LIP),
        (WALL, DEPTH - LIP, 0.5 * LIP), (WALL, FILLET, FINE), (WALL - FILLET, 0.0, 0.5 * FINE), (-3.5, 0.0, 2 * FINE),
    ]  # fmt: skip
    points = [geo.addPoint(x, y, 0, h) for x, y, h in line]
    centres = {3: geo.addPoint(WALL + LIP, DEPTH - LIP, 0), 5: geo.addPoint(WALL - FILLET, FILLET, 0)}
    curves = []
    for i, first in enumerate(points):
        last = points[(i + 1) % len(points)]
        curves.append(geo.addCircleArc(first, centres[i], last) if i in centres else geo.addLine(first, last))
    surface = geo.addPlaneSurface([geo.addCurveLoop(curves)])
    geo.synchronize()
    gmsh.model.addPhysicalGroup(2, [surface], name="groove")
    gmsh.model.addPhysicalGroup(1, [curves[0]], name="foot")
    gmsh.model.addPhysicalGroup(1, curves[2:7], name="inside")


def cover() -> None:
    geo = gmsh.model.geo
    top = 2 * RADIUS
    line = [(-3.5, top, 2 * FINE), (3.5, top, 2 * FINE), (3.5, top + 1, COARSE), (-3.5, top + 1, COARSE)]
    points = [geo.addPoint(x, y, 0, h) for x, y, h in line]
    curves = [geo.addLine(points[i], points[(i + 1) % 4]) for i in range(4)]
    surface = geo.addPlaneSurface([geo.addCurveLoop(curves)])
    geo.synchronize()
    gmsh.model.addPhysicalGroup(2, [surface], name="cover")
    gmsh.model.addPhysicalGroup(1, [curves[0]], name="under")
    gmsh.model.addPhysicalGroup(1, [curves[2]], name="top")


def main() -> None:
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.add("o-ring")
    ring()
    groove()
    cover()
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.setOrder(2)
    gmsh.write(str(Path(__file__).with_name("o-ring.msh")))
    gmsh.finalize()


if __name__ == "__main__":
    main()
