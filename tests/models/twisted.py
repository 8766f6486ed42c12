"""Curved surfaces a gap apart, closed by an offset and turned against each other: tractions on two lines a gap apart."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import abut
from abut.mesh import make

Array = NDArray[np.float64]
GAP, FIT, TURN = 0.04, 0.002, 0.01
TIMES = {"fit": abut.Amplitude([(0, 0), (0.5, 1)]), "turn": abut.Amplitude([(0.5, 0), (1, 1)])}
STEEL = abut.LinearElastic(1e3, 0.3)


def turned(axis: int) -> Callable[[Array], Array]:
    """Displacement by a small turn about z, along an axis."""
    return lambda x: TURN * (-x[:, 1] if axis == 0 else x[:, 0])


def twisted(dim: int, cell: str = "", friction: float = 0.3) -> abut.Model:
    """A thick ring round another one (in 2D a quarter of both), with a gap between them that the offset closes. The outer
    one is held, and pressed on by that; the inner one turns."""
    if dim == 2:
        cell = cell or "quad8"
        inner = make.ring([0.5, 1.0 - GAP], [10, 80], cells=[2, 7], cell=cell)
        outer = make.ring([1.0, 1.5], [0, 90], cells=[2, 11], cell=cell)
        bore = "inner.inner"
    else:
        cell = cell or "hex20"
        inner = make.cylinder(1.0 - GAP, [0.1, 0.9], cells=(1, 9, 2), cell=cell, inner=0.5)
        outer = make.cylinder(1.5, [0, 1], cells=(1, 12, 2), cell=cell, inner=1.0)
        bore = "inner.inner"
    held = {"x": 0, "y": 0} if dim == 2 else {"x": 0, "y": 0, "z": 0}
    side = "outer.outer" if dim == 2 else "outer.round"
    contactor = "inner.outer" if dim == 2 else "inner.round"
    supports = [
        abut.Support(side, **held),
        abut.Support(bore, x=turned(0), amplitude=TIMES["turn"]),
        abut.Support(bore, y=turned(1), amplitude=TIMES["turn"]),
    ]
    if dim == 3:
        supports.append(abut.Support(bore, z=0))
    return abut.Model(
        make.join({"inner": inner, "outer": outer}),
        [abut.Solid(name, STEEL) for name in ("inner", "outer")],
        supports,
        contacts=[
            abut.Contact(
                contactor=contactor, target="outer.inner", offset=-GAP - FIT, amplitude=TIMES["fit"], friction=friction
            )
        ],
        plane="strain" if dim == 2 else None,
        solve=abut.SolveOptions(times=[0.5, 0.75, 1.0]),
    )
