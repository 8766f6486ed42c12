"""A block that is pressed on another one, and slid over its edge until it is off."""

from __future__ import annotations

import abut
from abut.contact.sides import Names
from abut.mesh import make

PRESS, SLIDE = abut.Amplitude(((0, 0), (0.2, 1), (1, 1))), abut.Amplitude(((0, 0), (0.2, 0), (1, 1)))


def over_edge(cell: str, contactor: Names, target: Names, friction: float) -> abut.Model:
    """Both of rubber, with sharp edges; pressed by an eighth of the block's height."""
    rubber = abut.NeoHooke(young=100.0, poisson=0.3)
    ground, block = (
        make.rectangle([0, 1.5], [0, 0.6], (10, 4), cell),
        make.rectangle([0.3, 1.1], [0.6, 1.0], (5, 4), cell),
    )
    mesh = make.join({"ground": ground, "block": block})
    return abut.Model(
        mesh, [abut.Solid("ground", rubber), abut.Solid("block", rubber)],
        [
            abut.Support("ground.bottom", x=0, y=0), abut.Support("block.top", y=-0.05, amplitude=PRESS),
            abut.Support("block.top", x=1.5, amplitude=SLIDE),
        ],
        contacts=[abut.Contact(contactor=contactor, target=target, friction=friction)],
        plane="strain", kinematics="finite",
    )  # fmt: skip
