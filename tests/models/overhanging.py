"""A contactor that is wider than its target, whose edges lie within facets of it."""

from __future__ import annotations

from typing import Any

import abut
from abut.mesh import make
from models.sliding import SOFT

PRESS = abut.Amplitude(((0.0, 0.0), (0.2, 1.0), (1.0, 1.0)))
GO = abut.Amplitude(((0.0, 0.0), (0.2, 0.0), (1.0, 1.0)))


def pressed(cell: str, covered: float, kinematics: str, space: str, load: float) -> abut.Model:
    """A block of six facets, in 3D 6 x 6, on a narrower one that covers two of them and a share of the next at both ends,
    pressed by a pressure (E = 1)."""
    steel, cells, dim = abut.LinearElastic(1.0, 0.3), 6, 3 if cell[:3] in ("hex", "tet") else 2
    low, high = (2.0 - covered) / cells, (cells - 2.0 + covered) / cells
    if dim == 2:
        upper = make.rectangle([0, 1], [0.5, 1.0], (cells, 3), cell=cell)
        lower = make.rectangle([low, high], [0, 0.5], (5, 4), cell=cell)
    else:
        upper = make.box([0, 1], [0, 1], [0.5, 1.0], (cells, cells, 2), cell=cell)
        lower = make.box([low, high], [low, high], [0, 0.5], (3, 3, 2), cell=cell)
    axes = ("x", "y", "z")[:dim]
    return abut.Model(
        make.join({"lower": lower, "upper": upper}), plane="strain" if dim == 2 else None, kinematics=kinematics,
        solids=[abut.Solid("lower", steel), abut.Solid("upper", steel)],
        supports=[
            abut.Support("lower.bottom", **dict.fromkeys(axes, 0.0)),
            abut.Support("upper.top", **dict.fromkeys(axes[:-1], 0.0)),
        ],
        loads=[abut.Pressure("upper.top", load)],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", pressure=space)],
        solve=abut.SolveOptions(steps=1),
    )  # fmt: skip


def crossed(cell: str, friction: float, **options: Any) -> abut.Model:
    """A block with sharp edges pressed into a plate, the contactor, and slid over several of its facets."""
    dim = 2 if cell.startswith("quad") else 3
    if dim == 2:
        plate = make.rectangle([0, 1.6], [0, 0.6], (12, 4), cell=cell)
        block = make.rectangle([0.2, 0.6], [0.6, 0.9], (4, 3), cell=cell)
    else:
        plate = make.box([0, 1.6], [0, 0.6], [0, 0.4], (8, 4, 2), cell=cell)
        block = make.box([0.2, 0.6], [0.15, 0.52], [0.4, 0.7], (3, 3, 2), cell=cell)
    axes = ("x", "y", "z")[:dim]
    across = [abut.Support("block.top", y=0.0)] if dim == 3 else []
    return abut.Model(
        make.join({"plate": plate, "block": block}), plane="strain" if dim == 2 else None, kinematics="finite",
        solids=[abut.Solid("plate", SOFT), abut.Solid("block", SOFT)],
        supports=[
            abut.Support("plate.bottom", **dict.fromkeys(axes, 0.0)), *across,
            abut.Support("block.top", **{axes[-1]: -0.06}, amplitude=PRESS), abut.Support("block.top", x=0.8, amplitude=GO),
        ],
        contacts=[abut.Contact(contactor="plate.top", target="block.bottom", friction=friction)], **options,
    )  # fmt: skip
