"""Two hubs glued end to end on one stiff shaft, with Lame's pressure."""

from __future__ import annotations

import abut
from abut.mesh import make

OUTER, BORE, INNER, OVER = 20.0, 10.0, 4.0, 0.02
YOUNG = (21e3, 210e3)


def hubs(around: tuple[int, int]) -> abut.Model:
    """around: cells of hex8 round the lower hub and the upper one, which the contact names together."""
    mesh = make.join({
        "lower": make.cylinder(OUTER, (0, 15), (4, around[0], 4), "hex8", inner=BORE),
        "upper": make.cylinder(OUTER, (15, 30), (4, around[1], 5), "hex8", inner=BORE),
        "shaft": make.cylinder(BORE + OVER, (0, 30), (4, 20, 9), "hex8", inner=INNER),
    })  # fmt: skip
    solids = [abut.Solid(body, abut.LinearElastic(YOUNG[body == "shaft"], 0.3)) for body in mesh.bodies]
    contacts = [
        abut.Contact(["lower.inner", "upper.inner"], "shaft.round"),
        abut.Contact("lower.top", "upper.bottom", kind="tied"),
    ]
    return abut.Model(mesh, solids, contacts=contacts)


def lame() -> float:
    """Of rings whose ends are free."""
    hub = (OUTER**2 + BORE**2) / (OUTER**2 - BORE**2) + 0.3
    shaft = (BORE**2 + INNER**2) / (BORE**2 - INNER**2) - 0.3
    return OVER / BORE / (hub / YOUNG[0] + shaft / YOUNG[1])
