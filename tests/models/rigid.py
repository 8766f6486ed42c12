"""A rigid tool pressed into a block."""

from __future__ import annotations

import abut
from abut.mesh.make import join, rectangle
from models.constrained import SOFT


def pressed(young: float | None = None, **rigid: object) -> abut.Model:
    """A flat tool on a wider block; rigid, or with a material."""
    block = rectangle((-2, 2), (-2, 0), (16, 6), "quad8")
    tool = rectangle((-1, 1), (0, 1), (5, 2), "quad4")
    mesh = join({"block": block, "tool": tool})
    solids = [abut.Solid("block", SOFT)]
    held = [abut.Support("block.bottom", x=0, y=0)]
    if young:
        solids.append(abut.Solid("tool", abut.LinearElastic(young, 0.0)))
    return abut.Model(
        mesh, solids, held, contacts=[abut.Contact("block.top", "tool.bottom")], plane="strain",
        rigid=() if young else [abut.Rigid("tool", **rigid)],
    )  # fmt: skip
