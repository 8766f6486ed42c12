"""The largest shear stress of Hertz's contacts, which lies below the surface: half the difference of the largest and the
smallest principal stress that nodes show.

Half spaces differ from bodies by terms of a / R, in this more than in the pressure: contact is small here (a / R = 0.016
and 0.013)."""

from __future__ import annotations

import numpy as np

from abut.benchmarks import hertz
from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.materials.invariants import max_shear
from abut.mesh.make import box, half_disc, join, quarter_disc, rectangle, sphere_octant
from abut.model import Contact, Force, Model, Solid, Support
from abut.solution import Solution
from abut.types import Array

NU = 0.3
LINE = hertz.HALF_WIDTH / 8.0, hertz.LINE_PEAK / 8.0, hertz.LINE_FORCE / 64.0  # half width, largest pressure, force
BALL = hertz.RADIUS / 10.0, hertz.BALL_PEAK / 10.0, hertz.BALL_FORCE / 1000.0
SOURCE = "Johnson, Contact Mechanics, 4.2 (McEwen) and 3.4 (Huber)"
REASON = "facets of a sixth of the half width, nodes beside the peak, finite bodies for half spaces"


def _line(cell: str, n: int) -> Model:
    """0.78 n facets on the half width."""
    disc = half_disc(50.0, (0.0, 50.0), fine=1.0, cells=n, cell=cell)
    block = rectangle((-100.0, 100.0), (-200.0, 0.0), (2 * n, n), cell, fine={"x": [-1.0, 1.0], "y": [-1.0, 0.0]})
    return Model(
        join({"cylinder": disc, "body": block}),
        [Solid("cylinder", LinearElastic(210e3, NU)), Solid("body", LinearElastic(70e3, NU))],
        [Support("body.bottom", x=0, y=0), Support("cylinder.axis", x=0)],
        [Force("cylinder.flat", (0.0, -LINE[2]))],
        [Contact("body.top", "cylinder.round")],
        plane="strain",
    )


def _ball(cell: str, n: int) -> Model:
    """0.92 n facets on the radius of contact; axisymmetric."""
    parts = {
        "body": quarter_disc(8.0, (0.0, 8.0), fine=0.11, cells=n, cell=cell),
        "plane": rectangle((0.0, 8.0), (-1.0, 0.0), (1, 1)),
    }
    return Model(
        join(parts),
        [Solid(body, LinearElastic(1000.0, NU)) for body in parts],
        [Support(f"plane.{side}", x=0, y=0) for side in ("bottom", "top")],
        [Force("body.flat", (0.0, -BALL[2]))],
        [Contact("body.round", "plane.top")],
        plane="axisymmetric",
    )


def _octant(cell: str, n: int) -> Model:
    """The same in 3D, layers growing by a quarter."""
    parts = {
        "body": sphere_octant(8.0, (0.0, 0.0, 8.0), fine=0.11, cells=n, growth=1.25, cell=cell),
        "plane": box((0.0, 8.0), (0.0, 8.0), (-1.0, 0.0), (1, 1, 1)),
    }
    held = [Support(f"plane.{side}", x=0, y=0, z=0) for side in ("bottom", "top")]
    return Model(
        join(parts),
        [Solid(body, LinearElastic(1000.0, NU)) for body in parts],
        [*held, Support("body.x0", x=0), Support("body.y0", y=0)],
        [Force("body.z0", (0.0, 0.0, -BALL[2] / 4.0))],
        [Contact("body.round", "plane.top")],
    )


def line_shear(z: Array) -> Array:
    """Largest shear stress below the middle of a line contact, over the largest pressure; z: depth over half width."""
    return np.asarray(z - z**2 / np.sqrt(1.0 + z**2))


def ball_shear(z: Array) -> Array:
    """The same of a ball, z: depth over radius of contact."""
    flat = 1.0 / (1.0 + z**2)
    return np.asarray(0.5 * np.abs((1 + NU) * (1.0 - z * np.arctan2(1.0, z)) - 1.5 * flat))


def _measure(solution: Solution, half_width: float, peak: float) -> dict[str, float]:
    x, nodes = solution.model.mesh.points, solution.model.mesh.nodes_of("body")
    shear = max_shear(solution.steps[-1].stress[nodes])
    deepest = nodes[int(shear.argmax())]
    return {"largest shear": float(shear.max()) / peak, "depth": abs(float(x[deepest, -1])) / half_width}


DEPTH = np.linspace(0.0, 2.0, 20001)


def _benchmark(name: str, title: str, cell: str, n: int) -> Benchmark:
    make, (half_width, peak, _), exact = {
        "line": (_line, LINE, line_shear), "ball": (_ball, BALL, ball_shear), "sphere": (_octant, BALL, ball_shear),
    }[name]  # fmt: skip
    curve = exact(DEPTH)
    # between those of cells as deep as they are there
    nodes = 0.25 if cell in ("quad4", "tri3", "hex8", "tet4") else 0.125
    return Benchmark(
        f"hertz-shear-{name}-{cell}",
        f"{title}, {cell}: largest shear below the surface",
        lambda level: make(cell, n * 2**level),
        lambda solution: _measure(solution, half_width, peak),
        {
            "largest shear": Reference(float(curve.max()), 0.02, SOURCE, f"over the largest pressure; {REASON}"),
            "depth": Reference(
                float(DEPTH[curve.argmax()]),
                nodes / float(DEPTH[curve.argmax()]),
                SOURCE,
                "over the half width; one cell",
            ),
        },
    )


BENCHMARKS = (
    _benchmark("line", "cylinder on a block, plane strain", "quad4", 7),
    _benchmark("line", "cylinder on a block, plane strain", "tri6", 7),
    _benchmark("ball", "ball on a rigid plane, axisymmetric", "quad4", 8),
    _benchmark("ball", "ball on a rigid plane, axisymmetric", "quad8", 6),
    _benchmark("sphere", "ball on a rigid plane, octant", "hex8", 6),
)
