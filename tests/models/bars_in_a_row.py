"""Two bars in a row along x, 4 long and 1 x 1, with 2 between them."""

from __future__ import annotations

from dataclasses import replace

import abut
from abut.mesh.make import box, join


def bars_in_a_row() -> tuple[abut.Mesh, list[abut.Support]]:
    """The bars "one" and "two", with the node sets "left end" and "right end" that face each other, and supports that keep
    them from moving across."""
    bars = {"one": box([0, 4], [0, 1], [0, 1], cells=[2, 1, 1]), "two": box([6, 10], [0, 1], [0, 1], cells=[2, 1, 1])}
    mesh = join(bars)
    ends = {name: mesh.nodes_of(side) for name, side in (("left end", "one.right"), ("right end", "two.left"))}
    mesh = replace(mesh, node_sets={**mesh.node_sets, **ends})
    sides = [
        abut.Support(f"{bar}.{side}", **{axis: 0}) for bar in bars for side, axis in (("front", "y"), ("bottom", "z"))
    ]
    return mesh, sides
