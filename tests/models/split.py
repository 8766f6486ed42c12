"""Blocks whose target is a joint of several bodies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import abut
from abut.mesh.make import box, join


def split_base(contactor_below: bool) -> abut.Model:
    """One block on two that stand side by side, meshed independently: their common edge has hanging nodes (T-junctions),
    and is crossed by facets from above. nu = 0, so that nothing expands into its neighbour."""
    left = box((0, 0.45), (0, 1), (0, 1), (2, 3, 2), "hex20")
    right = box((0.45, 1), (0, 1), (0, 1), (2, 2, 2), "hex20")
    upper = box((0, 1), (0, 1), (1, 1.5), (3, 4, 1), "hex8")
    mesh = join({"left": left, "right": right, "upper": upper})
    base = np.concatenate([mesh.surfaces["left.top"], mesh.surfaces["right.top"]])
    mesh = replace(mesh, surfaces={**mesh.surfaces, "base": base})
    soft = abut.LinearElastic(1.0, 0.0)
    pair = ("base", "upper.bottom") if contactor_below else ("upper.bottom", "base")
    return abut.Model(
        mesh,
        [abut.Solid(body, soft) for body in mesh.bodies],
        [
            *(abut.Support(f"{body}.bottom", x=0, y=0, z=0) for body in ("left", "right")),
            abut.Support("upper.left", x=0),
            abut.Support("upper.front", y=0),
        ],
        [abut.Pressure("upper.top", 1e-3)],
        [abut.Contact(contactor=pair[0], target=pair[1])],
    )
