"""Pressure penetration: uplift under a block on a bed, which opens from its heel, and an O-ring."""

from __future__ import annotations

import numpy as np

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.anisotropic import Orthotropic
from abut.materials.hyperelastic import NeoHooke
from abut.mesh.make import box, half_disc, join, rectangle
from abut.mesh.mesh import Mesh
from abut.model import (
    Amplitude,
    Contact,
    Force,
    Model,
    Moment,
    Penetration,
    Rigid,
    Solid,
    SolveOptions,
    Support,
)
from abut.solution import Solution

BASE, WEIGHT, TOE, HEAD = (
    10.0,
    20.0,
    4.0,
    1.4,
)  # length of the base, weight, its distance from the toe, fluid's pressure
FIRST = Amplitude(((0.0, 0.0), (0.5, 1.0), (1.0, 1.0)))
THEN = Amplitude(((0.0, 0.0), (0.5, 0.0), (1.0, 1.0)))
LIGAMENT = 3.0 * (WEIGHT * TOE - HEAD * BASE**2 / 2.0) / (WEIGHT - HEAD * BASE)
UPLIFT = (
    "gravity method of dams with full uplift in the crack: what still presses does so linearly, from the fluid's pressure "
    "at the crack's tip, c = 3 (F e - p b^2 / 2) / (F - p b)"
)
RADIUS, SQUEEZE, FLUID = 2.5, 0.6, 2.0  # of an O-ring and the fluid that it seals
LITTLE = 0.1  # of the fluid's pressure while it is squeezed


def _bed(dim: int, cells: int) -> Mesh:
    """A layer and a block on it, meshed unalike: seven facets of the block face ten of the layer."""
    parts = {"layer": (cells, 2, (-1.0, 0.0)), "block": (7 * cells // 10, 3, (0.0, 5.0))}
    if dim == 2:
        return join({name: rectangle((0.0, BASE), y, (n, 1), "quad4") for name, (n, _, y) in parts.items()})
    return join({name: box((0.0, BASE), (0.0, 1.0), z, (n, deep, 1), "hex8") for name, (n, deep, z) in parts.items()})


def uplift(dim: int, cells: int, kinematics: str = "small") -> Model:
    """A rigid block on a layer of columns that do not hold on to each other, which a fluid enters from the heel."""
    soft = 1e-3 if kinematics == "small" else 10.0  # sheared columns topple at large displacements
    columns = Orthotropic((soft, 100.0, soft) if dim == 2 else (soft, soft, 100.0), (0.0,) * 3, (soft,) * 3)
    down = (0.0, -WEIGHT) if dim == 2 else (0.0, 0.0, -WEIGHT)
    turn = -WEIGHT * (BASE / 2.0 - TOE)  # about the middle, toward the toe
    block = (
        Rigid("block", reference=(BASE / 2.0, 0.0), x=0.0)
        if dim == 2
        else Rigid("block", reference=(BASE / 2.0, 0.5, 0.0), x=0.0, y=0.0, rx=0.0, rz=0.0)
    )
    moment = (turn,) if dim == 2 else (0.0, -turn, 0.0)
    return Model(
        _bed(dim, cells),
        [Solid("layer", columns)],
        [Support("layer.bottom", x=0.0, y=0.0, z=None if dim == 2 else 0.0)],
        [Force("block", down, FIRST), Moment("block", moment, FIRST)],
        [Contact(contactor="layer.top", target="block.bottom", name="joint")],
        "strain" if dim == 2 else None,
        SolveOptions(steps=10),
        rigid=[block],
        kinematics=kinematics,
        penetrations=[Penetration("joint", "layer.left", HEAD, THEN)],
    )


def _opened(solution: Solution) -> dict[str, float]:
    step = solution.steps[-1]
    fluid, contact = step.penetrations["joint"], step.contacts[0]
    pushed = np.abs(fluid.contactor + fluid.target)[-1 if len(fluid.target) == 3 else 1]
    return {
        "length that the fluid wets": fluid.area,
        "largest pressure": contact.max_pressure,
        "contact and fluid under the block": float(step.reactions["layer.bottom"][-1]),
        "what the fluid leaves on both sides together": float(pushed),
    }


def _wanted(cells: int) -> dict[str, Reference]:
    opened = BASE - LIGAMENT
    facet = f"a facet, of which {cells} make the base: the fluid's edge lies between two nodes"
    return {
        "length that the fluid wets": Reference(opened, BASE / cells / opened, UPLIFT, facet),
        "largest pressure": Reference(
            HEAD + 2.0 * (WEIGHT - HEAD * BASE) / LIGAMENT, 0.5 * BASE / cells / LIGAMENT, UPLIFT, facet
        ),
        "contact and fluid under the block": Reference(WEIGHT, 1e-9, "balance of forces", "rounding"),
        "what the fluid leaves on both sides together": Reference(
            0.0, 1e-10, "the same pressure on the same area", "rounding, whatever the meshes of both sides"
        ),
    }


def o_ring(level: int) -> Model:
    """The lower half of a ring between two lands, squeezed onto them, pressed against the groove's wall by the fluid."""
    mesh = join(
        {
            "ring": half_disc(RADIUS, fine=1.5, cells=8 * 2**level, cell="quad4"),
            "land": rectangle((-6.0, 6.0), (-RADIUS - 1.0, -RADIUS), (6, 1), "quad4"),
            "wall": rectangle((RADIUS, RADIUS + 1.0), (-RADIUS - 1.0, RADIUS), (1, 4), "quad4"),
        }
    )
    squeezed = Amplitude(((0.0, 0.0), (0.4, 1.0), (1.0, 1.0)))
    pumped = Amplitude(((0.0, 0.0), (0.4, LITTLE), (1.0, 1.0)))
    return Model(
        mesh,
        [Solid("ring", NeoHooke(young=9.0, poisson=0.48))],
        [Support("ring.flat", y=-0.5 * SQUEEZE, amplitude=squeezed)],
        contacts=[Contact(contactor="ring.round", target=["land.top", "wall.left"], name="seal")],
        plane="strain",
        rigid=[Rigid(name, x=0.0, y=0.0, rz=0.0) for name in ("land", "wall")],
        kinematics="finite",
        solve=SolveOptions(times=(0.4, 1.0)),
        penetrations=[Penetration("seal", (-RADIUS, 0.0), FLUID, pumped)],
    )


def _sealed(solution: Solution) -> dict[str, float]:
    first = next(step for step in solution.steps if abs(step.factor - 0.4) < 1e-9)
    last = solution.steps[-1]
    return {
        "thrust on the wall": float(-last.rigid["wall"].force[0]),
        "rise of the largest pressure": last.contacts[0].max_pressure - first.contacts[0].max_pressure,
    }


THRUST = FLUID * (RADIUS - 0.5 * SQUEEZE)
BENCHMARKS = (
    Benchmark(
        "uplift", "block on a bed that a fluid opens from its heel", lambda level: uplift(2, 40 * 2**level), _opened,
        _wanted(40),
    ),
    Benchmark(
        "uplift-3d", "the same of hexahedra", lambda level: uplift(3, 40 * 2**level), _opened, _wanted(40),
    ),
    Benchmark(
        "o-ring", "O-ring that a fluid presses into its groove", o_ring, _sealed,
        {
            "thrust on the wall": Reference(
                THRUST, 5e-3, "the fluid's pressure on the height between the lands, wherever its edges are",
                "quad4, eight across the contact: edges of the fluid lie on the lands up to a facet's rise",
            ),
            "rise of the largest pressure": Reference(
                FLUID * (1.0 - LITTLE), 0.03, "rubber passes pressure on as a liquid does: what seals, and the fluid's",
                "Poisson's ratio .48, not .5",
            ),
        },
    ),
)  # fmt: skip
