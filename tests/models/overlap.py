"""A ball on a block and strips whose facets may be in each other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import abut
from abut.mesh.make import half_disc, join, rectangle

E, NU = 210e3, 0.3


def strip(facets: int = 3, **contact: object) -> abut.Model:
    """A round punch, ``facets`` wide, pressed on a plate: gaps up to 0.005, which is the row of facets in the middle of
    three, are adjusted away. (CalculiX's deck punch1 in the plane.)"""
    punch = rectangle((-0.192, 0.192), (0, 0.4), (facets, 2), "quad8")
    x, y = punch.points.T
    punch = replace(punch, points=np.column_stack([x, y + x * x * (1.0 - y / 0.4)]))  # radius 0.5
    mesh = join({"punch": punch, "plate": rectangle((-0.5, 0.5), (-0.5, 0), (facets, facets), "quad8")})
    return abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(E, 0.0)) for body in mesh.bodies],
        [abut.Support("plate.bottom", x=0, y=0), abut.Support("punch.left", x=0), abut.Support("punch.right", x=0)],
        [abut.Pressure("punch.top", 100.0)],
        [abut.Contact(contactor="punch.bottom", target="plate.top", **{"adjust": 0.005, **contact})],
        plane="strain",
    )


def ball_on_block(contactor: str, target: str, n: int) -> abut.Model:
    """A half cylinder of radius 1 pressed by 0.002 on a block."""
    mesh = join({"ball": half_disc(centre=[0, 1], cells=n, cell="quad8"),
                 "block": rectangle((-1, 1), (-1, 0), (2 * n + 1, n), "quad8")})  # fmt: skip
    return abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(1.0, 0.3)) for body in mesh.bodies],
        [abut.Support("block.bottom", x=0, y=0), abut.Support("ball.flat", x=0, y=-0.002)],
        contacts=[abut.Contact(contactor=contactor, target=target)],
        plane="strain",
    )
