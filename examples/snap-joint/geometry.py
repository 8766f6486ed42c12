"""Geometry and mesh of the snap-joint example (needs the gmsh package; the mesh is committed, so running the job does not).

The hook of a plastic cover, 9 mm long and 1.6 mm thick, and the catch on its counterpart; all corners that touch are round.
Units: mm.
"""

from __future__ import annotations

from pathlib import Path

import gmsh
import numpy as np

Corner = tuple[float, float, float]  # x, y, radius (0: sharp)
HOOK: list[Corner] = [
    (0.0, 0.0, 0.0), (5.4, 0.0, 0.5), (6.5, -1.0, 1.0), (7.3, -1.0, 1.0), (9.0, 0.0, 0.4), (9.0, 1.6, 0.0), (0.0, 1.6, 0.0),
]  # fmt: skip
CATCH: list[Corner] = [
    (6.8, -2.4, 0.0), (11.8, -2.4, 0.0), (11.8, -1.5, 0.0), (10.7, -1.5, 0.4), (9.4, -0.3, 1.0), (8.6, -0.3, 1.0),
    (6.8, -1.4, 0.0),
]  # fmt: skip
FINE, COARSE = 0.14, 0.6


def rounded(corners: list[Corner], fine: range) -> list[int]:
    """Curves of a polygon with round corners, from the line that ends in corner 1 on; of each corner its arc, if any, and
    the line after it. Corners in ``fine`` get small cells."""
    geo, ends, arcs = gmsh.model.geo, [], []
    for i, (x, y, radius) in enumerate(corners):
        size = FINE if i in fine else COARSE
        if not radius:
            point = geo.addPoint(x, y, 0, size)
            ends.append((point, point))
            arcs.append(None)
            continue
        here = np.array([x, y])
        before, after = (np.array(corners[(i + k) % len(corners)][:2]) - here for k in (-1, 1))
        before, after = before / np.linalg.norm(before), after / np.linalg.norm(after)
        half = 0.5 * np.arccos(before @ after)
        middle = here + radius / np.sin(half) * (before + after) / np.linalg.norm(before + after)
        length = radius / np.tan(half)
        first, last = (geo.addPoint(*(here + length * way), 0, size) for way in (before, after))
        ends.append((first, last))
        arcs.append(geo.addCircleArc(first, geo.addPoint(*middle, 0), last))
    curves = []
    for i in range(1, len(corners) + 1):
        k = i % len(corners)
        curves.append(geo.addLine(ends[i - 1][1], ends[k][0]))
        if arcs[k] is not None:
            curves.append(arcs[k])
    return curves


def body(name: str, corners: list[Corner], fine: range, named: dict[str, slice]) -> None:
    curves = rounded(corners, fine)
    surface = gmsh.model.geo.addPlaneSurface([gmsh.model.geo.addCurveLoop(curves)])
    gmsh.model.geo.synchronize()
    gmsh.model.addPhysicalGroup(2, [surface], name=name)
    for own, which in named.items():
        gmsh.model.addPhysicalGroup(1, curves[which], name=own)


def main() -> None:
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.add("snap-joint")
    body("hook", HOOK, range(1, 5), {"nose": slice(1, 9), "root": slice(10, 11)})
    body("catch", CATCH, range(2, 7), {"foot": slice(0, 1), "bump": slice(2, 9)})
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.setOrder(2)
    gmsh.write(str(Path(__file__).with_name("snap-joint.msh")))
    gmsh.finalize()


if __name__ == "__main__":
    main()
