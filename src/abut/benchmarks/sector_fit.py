"""A press fit under a torque, of which a ninth is modelled: contact that reaches both sides of a sector."""

from __future__ import annotations

import numpy as np

from abut.axes import Axes
from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import join, ring
from abut.model import Contact, Model, Solid, Support, Traction
from abut.model.sector import Sector, add_sectors
from abut.solution import Solution

YOUNG, POISSON = 1000.0, 0.3
BORE, SEAT, RIM = 1.0, 1.5, 2.0
OVERLAP, SHEAR, FRICTION = 0.01, 0.1, 0.3
SECTORS = 9


def _fit(level: int) -> Model:
    """The outer ring is pressed on the inner one and twisted; no plane is one of symmetry."""
    n, angles = 2**level, (20.0, 20.0 + 360.0 / SECTORS)
    grid = join(
        {
            "hub": ring((SEAT, RIM), angles, cells=(2 * n, 3 * n)),
            "shaft": ring((BORE, SEAT), angles, cells=(2 * n, 3 * n)),
        }
    )
    joined = add_sectors(grid, [Sector(f"{body}.start", f"{body}.end", SECTORS) for body in ("hub", "shaft")])
    steel = LinearElastic(YOUNG, POISSON)
    return Model(
        joined.mesh,
        [Solid("hub", steel), Solid("shaft", steel)],
        [Support("shaft.inner", y=0, axes=Axes("cylindrical"))],
        [Traction("hub.outer", (0.0, SHEAR), axes=Axes("cylindrical"))],
        [Contact("hub.inner", "shaft.outer", offset=-OVERLAP, friction=FRICTION)],
        plane="strain",
        equations=joined.equations,
    )


def _seat(solution: Solution) -> dict[str, float]:
    """Pressure and traction around at all nodes of the contact, those on the sides among them."""
    contact = solution.contacts[0]
    assert contact.friction is not None
    used = contact.contactor.nodes >= 0
    x, pressure = contact.contactor.points[contact.contactor.nodes[used]], contact.pressure[used]
    frames = Axes("cylindrical").frames(x)
    around = np.abs(np.einsum("nd,nd->n", frames[:, 1], contact.friction.traction[used]))
    return {
        "pressure": float(pressure.mean()),
        "largest difference of pressures": float(np.ptp(pressure)),
        "traction around": float(around.mean()),
        "largest difference of tractions": float(np.ptp(around)),
    }


def _lame() -> float:
    """Pressure of an overlap between two thick rings of one material, held along the axis."""
    inner = (SEAT**2 + BORE**2) / (SEAT**2 - BORE**2)
    outer = (RIM**2 + SEAT**2) / (RIM**2 - SEAT**2)
    return OVERLAP * YOUNG / (1.0 - POISSON**2) / (SEAT * (inner + outer))


TORQUE = SHEAR * (RIM / SEAT) ** 2
LAME, BALANCE, WHOLE = (
    "Lame's thick rings",
    "shear stress T / (2 pi r^2) of a ring under a torque",
    "every node is as the others",
)
CURVED, ROUNDING = "quadratic cells, two through each wall", "of solving"
COMPONENTS = "components along x and y are recovered one by one"
BENCHMARKS = (
    Benchmark(
        "sector-fit", "a ninth of a press fit under a torque, its contact across both sides of the sector", _fit, _seat,
        {
            "pressure": Reference(_lame(), 5e-3, LAME, CURVED),
            "largest difference of pressures": Reference(0.0, 1e-9 * _lame(), WHOLE, ROUNDING),
            "traction around": Reference(TORQUE, 5e-3, BALANCE, CURVED),
            "largest difference of tractions": Reference(0.0, 2e-4 * TORQUE, WHOLE, COMPONENTS),
        },
    ),
)  # fmt: skip
