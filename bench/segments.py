"""Segments cut and integrated a second on one core: flat interfaces with non-matching grids, and spheres.

python bench/segments.py [--cells N]

Spheres in spheres and balls on blocks have facets of very different sizes, whose normals point everywhere: what lies within
reach is much more than what is seen; normals turn, and maps have to be inverted point by point. The last two columns are
the time a facet over that of a flat interface of as many facets, and the time of the derivatives by all coordinates
over that of the values; each is the quickest of five.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from abut.cells import BY_CODE, CELLS, MAX_FACET_NODES
from abut.contact.coupling import CouplingOptions, couple, surface_degree
from abut.contact.coupling_tangent import coupling_tangent
from abut.mesh.make import box, join, sphere_octant
from abut.mesh.surface import Surface


def flat(n: int, cell: str) -> tuple[Surface, Surface]:
    lower = box(cells=(n, n, 1), cell=cell)
    upper = box(z=(1.0, 2.0), cells=(n + 11, n + 12, 1), cell=cell)
    mesh = join({"lower": lower, "upper": upper})
    return mesh.surface("lower.top"), mesh.surface("upper.bottom")


def spheres(n: int, cell: str) -> tuple[Surface, Surface]:
    """An octant of a ball in a socket with a clearance of 0.3 %, graded toward the pole."""
    ball = sphere_octant(1.0, fine=0.2, cells=n // 3, cell=cell)
    socket = sphere_octant(1.003, fine=0.2, cells=n // 3 + 3, cell=cell)
    mesh = join({"ball": ball, "socket": socket})
    return mesh.surface("ball.round"), inside_out(mesh.surface("socket.round"))


def ball_on_block(n: int, cell: str) -> tuple[Surface, Surface]:
    """An octant of a ball, graded toward its pole, on a block graded likewise."""
    ball = sphere_octant(1.0, centre=(0.0, 0.0, 1.0), fine=0.2, cells=n // 3, cell=cell)
    fine = {"x": [0.0, 0.25], "y": [0.0, 0.25]}
    block = box(x=(0, 2), y=(0, 2), z=(-1, 0), cells=(n // 3 + 3, n // 3 + 3, 2), cell=cell, fine=fine)
    mesh = join({"ball": ball, "block": block})
    return mesh.surface("ball.round"), mesh.surface("block.top")


def inside_out(surface: Surface) -> Surface:
    """The same surface seen from its other side."""
    kind = BY_CODE[surface.kinds[0]]
    corners = kind.corners
    order = [0, *range(corners - 1, 0, -1)]
    if CELLS[kind.name].degree == 2:
        order += [*range(2 * corners - 1, corners - 1, -1), *range(2 * corners, kind.nodes)]
    nodes = surface.nodes.copy()
    nodes[:, : kind.nodes] = surface.nodes[:, order]
    return replace(surface, nodes=nodes)


def quickest(work: Callable[[], object]) -> float:
    """Seconds of CPU time, of five runs."""
    spent = []
    for _ in range(5):
        start = time.process_time()
        work()
        spent.append(time.process_time() - start)
    return min(spent)


def measure(contactor: Surface, target: Surface) -> tuple[int, float, float]:
    """Number of segments, seconds for the values and for the derivatives."""
    degree, options = surface_degree(contactor), CouplingOptions()
    rows = MAX_FACET_NODES * len(contactor)
    pressure, traction = np.ones(rows), np.zeros((rows, contactor.dim))
    count = int(couple(contactor, target, degree, options).segments.sum())
    values = quickest(lambda: couple(contactor, target, degree, options))
    derivatives = quickest(lambda: coupling_tangent(contactor, target, degree, options, pressure, traction))
    return count, values, derivatives


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", type=int, default=70, help="three times the facets along an edge of the spheres")
    n = parser.parse_args().cells
    for cell in ("tet4", "hex8", "tet10", "hex20", "hex27"):
        alone = 0.0
        along = round((len(spheres(n, cell)[0]) / (2 if cell.startswith("tet") else 1)) ** 0.5)
        cases = (("flat", flat, along), ("sphere in sphere", spheres, n), ("ball on block", ball_on_block, n))
        for name, make, size in cases:
            contactor, target = make(size, cell)
            count, spent, derivatives = measure(contactor, target)
            a_facet = spent / len(contactor)
            alone = alone or a_facet
            print(
                f"{cell:6s} {name:16s} {len(contactor):6d} facets {count:7d} segments in {spent:6.2f} s: "
                f"{count / spent:9.0f} a second; a facet {1e6 * a_facet:6.1f} us, {a_facet / alone:5.1f} times flat; "
                f"derivatives {derivatives / spent:4.1f} times"
            )


if __name__ == "__main__":
    main()
