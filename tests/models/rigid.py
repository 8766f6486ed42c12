"""A rigid tool pressed into a block."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import abut
from abut.mesh.make import join, rectangle
from abut.mesh.mesh import Mesh
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
        mesh, solids, held, contacts=[abut.Contact(contactor="block.top", target="tool.bottom")], plane="strain",
        rigid=() if young else [abut.Rigid("tool", **rigid)],
    )  # fmt: skip


def glued(mesh: Mesh, body: str, surface: str) -> Mesh:
    """The mesh with each point of a body that lies on a surface replaced by the surface's own."""
    nodes, place = mesh.nodes_of(surface), np.arange(len(mesh.points))
    for node in mesh.nodes_of(body):
        (same,) = np.nonzero(np.abs(mesh.points[nodes] - mesh.points[node]).max(axis=1) < 1e-12)
        place[node] = nodes[same[0]] if len(same) else node
    kept, new = np.unique(place, return_inverse=True)
    blocks = [replace(block, nodes=new[block.nodes].astype(np.int32)) for block in mesh.blocks]
    return replace(mesh, points=mesh.points[kept], blocks=tuple(blocks))
