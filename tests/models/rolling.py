"""Bodies that contact alone holds: a rubber roller between two plates, a wheel, a block pushed across a plate."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import abut
from abut.mesh import make
from models.sliding import bent

RUBBER = abut.NeoHooke(young=5.0, poisson=0.4)
STEEL = abut.LinearElastic(young=5e3, poisson=0.3)
DOWN, LENGTH = 0.08, 2.0  # in radii of the roller: together, and the upper plate along
FRICTION, LOAD = 0.3, 4.5  # of the block: coefficient, and what presses it down
TURN = 1.5  # of the wheel
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
            abut.Contact(contactor=TREAD, target="road.top", name="road", friction=friction),
            abut.Contact(contactor=TREAD, target="roof.bottom", name="roof", friction=friction),
        ],
    )  # fmt: skip


def wheel(cells: int, friction: float) -> abut.Model:
    """A rigid wheel of radius 1, faceted all round, lowered into a slab and turned, free to roll along."""
    rim = make.cylinder(1.0, (0.0, 0.5), (cells, 1), cell="hex8")
    slab = make.box((-1, 3), (-1, 0), (0, 0.5), (40, 4, 1), "hex8")
    return abut.Model(
        make.join({"slab": slab, "wheel": bent(rim, lambda x: x + np.array([0.0, 1.0, 0.0]))}), kinematics="finite",
        solids=[abut.Solid("slab", abut.LinearElastic(young=1e3, poisson=0.3))],
        rigid=[abut.Rigid("wheel", reference=(0.0, 1.0, 0.25), y=-0.03, z=0.0, rx=0.0, ry=0.0, rz=-TURN)],
        supports=[abut.Support("slab.front", x=0, y=0, z=0)],
        contacts=[abut.Contact(contactor="slab.back", target="wheel.round", friction=friction)],
    )  # fmt: skip


def pushed_across() -> abut.Model:
    """A block under pressure, pushed along a plate by a third body without friction; it is free to move sideways."""
    mesh = make.join(
        {
            "plate": make.box((0, 6), (0, 3), (-1, 0), (8, 4, 1), "hex8"),
            "block": make.box((1, 2.5), (0.75, 2.25), (0, 1), (3, 3, 2), "hex8"),
            "pusher": make.box((0.5, 1), (0.5, 2.5), (0.1, 0.9), (1, 4, 2), "hex8"),
        }
    )
    stiff = abut.LinearElastic(young=1000.0, poisson=0.3)
    pressed, along = abut.Amplitude(((0.0, 0.0), (0.2, 1.0), (1.0, 1.0))), abut.Amplitude(((0.2, 0.0), (1.0, 1.0)))
    return abut.Model(
        mesh, kinematics="finite", solids=[abut.Solid(name, stiff) for name in ("plate", "block", "pusher")],
        supports=[
            abut.Support("plate.bottom", x=0, y=0, z=0), abut.Support("pusher.left", y=0, z=0),
            abut.Support("pusher.left", x=0.6, amplitude=along),
        ],
        loads=[abut.Pressure("block.top", value=LOAD / 2.25, amplitude=pressed)],
        contacts=[
            abut.Contact(contactor="block.bottom", target="plate.top", name="floor", friction=FRICTION),
            abut.Contact(contactor="block.left", target="pusher.right", name="push"),
        ],
    )  # fmt: skip
