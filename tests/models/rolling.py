"""A rubber roller between two plates, which hold it by contact alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import abut
from abut.mesh import make
from models.sliding import bent

RUBBER = abut.NeoHooke(young=5.0, poisson=0.4)
STEEL = abut.LinearElastic(young=5e3, poisson=0.3)
DOWN, LENGTH = 0.08, 2.0  # in radii of the roller: together, and the upper plate along
TREAD = [f"roller.{side}" for side in ("left", "bottom", "right", "top")]


def round_(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """A square of side 2 to the unit disc."""
    return np.asarray(x * np.sqrt(1.0 - 0.5 * x[:, ::-1] ** 2))


def roller(cells: int = 8, friction: float = 0.4) -> abut.Model:
    """Pressed by the upper plate, then rolled by it."""
    mesh = make.join(
        {
            "roller": bent(make.rectangle([-1, 1], [-1, 1], cells=[cells, cells], cell="quad4"), round_),
            "road": make.rectangle([-1.5, 3.0], [-1.4, -1.0], cells=[20, 1], cell="quad4"),
            "roof": make.rectangle([-1.5, 3.0], [1.0, 1.4], cells=[20, 1], cell="quad4"),
        }
    )
    together, along = abut.Amplitude(((0.0, 0.0), (0.1, 1.0), (1.0, 1.0))), abut.Amplitude(((0.1, 0.0), (1.0, 1.0)))
    return abut.Model(
        mesh, plane="strain", kinematics="finite",
        solids=[abut.Solid("roller", RUBBER), abut.Solid("road", STEEL), abut.Solid("roof", STEEL)],
        supports=[
            abut.Support("road.bottom", x=0, y=0),
            abut.Support("roof.top", y=-DOWN, amplitude=together), abut.Support("roof.top", x=LENGTH, amplitude=along),
        ],
        contacts=[
            abut.Contact(TREAD, "road.top", name="road", friction=friction),
            abut.Contact(TREAD, "roof.bottom", name="roof", friction=friction),
        ],
    )  # fmt: skip
