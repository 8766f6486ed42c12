"""Friction whose forces follow from statics: a wedge, a belt around a drum, a hub pressed on a shaft."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from abut.benchmarks.fits import INTERFERENCE, LAME
from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import cylinder, join, rectangle, ring
from abut.mesh.mesh import Mesh
from abut.model import Amplitude, Contact, Force, Gravity, Model, Rigid, Solid, SolveOptions, Support
from abut.solution import Solution

SLOPE = 0.1  # of the wedge
WEDGE = {0.0: 0.1, 0.1: 0.20202, 0.2: 0.30612, 0.3: 0.41237}  # coefficient: force over weight, as printed
NAFEMS = "NAFEMS CGS-4 (2D sliding wedge): F / G = (mu + tan a) / (1 - mu tan a)"


def _wedge(friction: float) -> Benchmark:
    def inclined(mesh: Mesh) -> Mesh:
        x, y = mesh.points.T
        return replace(mesh, points=np.column_stack([x, y + SLOPE * x]))

    def model(level: int) -> Model:
        n = 2**level
        parts = {
            "ground": inclined(rectangle((0.0, 6.0), (-1.0, 0.0), (12 * n, 2 * n), "quad4")),
            "wedge": inclined(rectangle((1.0, 4.0), (0.0, 1.0), (7 * n, 3 * n), "quad4")),
        }
        return Model(
            join(parts),
            [Solid(body, LinearElastic(1e6, 0.3, density=1.0)) for body in parts],
            [Support("ground.bottom", x=0, y=0), Support("wedge.left", x=0.01)],
            [Gravity((0.0, -10.0), on="wedge")],
            [Contact("wedge.bottom", "ground.top", friction=friction)],
            plane="strain",
        )

    def measure(solution: Solution) -> dict[str, float]:
        across, up = solution.contacts[0].force
        return {"force": abs(float(across / up))}

    exact = (friction + SLOPE) / (1.0 - friction * SLOPE)
    assert abs(exact - WEDGE[friction]) < 1e-5
    return Benchmark(
        f"sliding-wedge-{friction:g}",
        f"a wedge pushed up a slope of 0.1, coefficient {friction:g}",
        model,
        measure,
        {"force": Reference(exact, 1e-6, NAFEMS, "statics: whatever the pressure, all of it slips")},
    )


WRAP, BELT, THICK = (
    0.5 * np.pi,
    0.3,
    0.005,
)  # angle of the belt on the drum, coefficient, thickness over the drum's radius


def _belt(level: int) -> Model:
    n = 2**level
    parts = {
        "belt": ring((1.0, 1.0 + THICK), (0.0, 90.0), cells=(1, 40 * n)),
        "drum": ring((0.5, 1.0), (-9.0, 99.0), cells=(1, 36 * n)),
    }
    return Model(
        join(parts),
        [Solid("belt", LinearElastic(1e6, 0.3))],
        [Support("belt.start", y=0)],
        [Force("belt.end", (-1.0, 0.0))],
        [Contact("belt.inner", "drum.outer", friction=BELT)],
        plane="stress",
        rigid=[Rigid("drum", x=0.0, y=0.0, rz=0.0)],
    )


def _tension(solution: Solution) -> dict[str, float]:
    """The drum carries what pulls at both ends: at the one that is loaded along x, at the one that is held along y."""
    pulled, constraints = solution.contacts[0].force
    return {"tension": float(pulled / constraints)}


JOINT = 0.1  # coefficient of the press fit
LENGTH = 4.0  # of the axisymmetric one
RADII = (1.0, 2.0, 3.0)
FIT_MATERIAL = LinearElastic(1000.0, 0.3)
EVEN = LinearElastic(
    1000.0, 0.0
)  # holding the rings along the axis presses no more; Lame's pressure is that of any ratio


def held_fit() -> float:
    """Pressure of the press fit with bore and outside held, in plane strain: u = A r + B / r in both (Lame)."""
    bore, joint, outside = RADII
    shear = FIT_MATERIAL.young / 2.6
    bulk = shear / (1.0 - 0.6)  # lambda + mu

    def moved(fixed: float) -> float:
        """Of the joint by unit pressure on it, radially; sigma_r = 2 (lambda + mu) A - 2 mu B / r^2, u(fixed) = 0."""
        b = 1.0 / (2.0 * bulk / fixed**2 + 2.0 * shear / joint**2)
        return b * (1.0 / joint - joint / fixed**2)

    return INTERFERENCE / abs(moved(outside) - moved(bore))


def _twisted(level: int) -> Model:
    n = 2**level
    bore, joint, outside = RADII
    parts = {
        "hub": cylinder(outside, (0.0, 1.0), (2 * n, 24 * n, n), inner=joint),
        "shaft": cylinder(joint, (0.0, 1.0), (2 * n, 20 * n, n), inner=bore),
    }
    turn, later = 0.02, Amplitude(((0.5, 0.0), (1.0, 1.0)))
    return Model(
        join(parts),
        [Solid(body, FIT_MATERIAL) for body in parts],
        [
            *(Support(f"{body}.{side}", z=0) for body in parts for side in ("bottom", "top")),
            Support("hub.round", x=0, y=0),
            Support("shaft.inner", x=lambda at: -turn * at[:, 1], y=lambda at: turn * at[:, 0], amplitude=later),
        ],
        contacts=[Contact("hub.inner", "shaft.round", offset=-INTERFERENCE, friction=JOINT)],
        solve=SolveOptions(steps=2),
    )


def _torque(solution: Solution) -> dict[str, float]:
    return {"torque": abs(float(solution.contacts[0].resultant.moment[2]))}


def _pushed(cell: str) -> Benchmark:
    def model(level: int) -> Model:
        n = 2**level
        bore, joint, outside = RADII
        parts = {
            "hub": rectangle((joint, outside), (0.0, LENGTH), (4 * n, 16 * n), cell),
            "shaft": rectangle((bore, joint), (0.0, LENGTH), (4 * n, 12 * n), cell),
        }
        return Model(
            join(parts),
            [Solid(body, EVEN) for body in parts],
            [
                Support("hub.right", y=0),
                Support("shaft.left", y=0.02, amplitude=Amplitude(((0.5, 0.0), (1.0, 1.0)))),
            ],
            contacts=[Contact("hub.left", "shaft.right", offset=-INTERFERENCE, friction=JOINT)],
            plane="axisymmetric",
            solve=SolveOptions(steps=2),
        )

    exact = 2.0 * np.pi * RADII[1] * LENGTH * JOINT * LAME["stress"]
    return Benchmark(
        f"push-out-{cell}",
        f"a shaft pushed out of a hub, axisymmetric, {cell}",
        model,
        lambda solution: {"force": abs(float(solution.contacts[0].force[1]))},
        {
            "force": Reference(
                exact, 0.02, "2 pi r L mu p with Lame's p", "shear bends the ends of the rings, to both sides"
            )
        },
    )


BENCHMARKS = (
    *(_wedge(friction) for friction in WEDGE),
    Benchmark(
        "belt-on-drum",
        "a belt pulled over a quarter of a drum",
        _belt,
        _tension,
        {
            "tension": Reference(
                float(np.exp(BELT * WRAP)), 0.01, "Euler and Eytelwein: exp(mu theta)", "a belt 0.005 as thick as the drum"
            )
        },
    ),
    Benchmark(
        "press-fit-torque",
        "a shaft turned in a hub that is pressed on it, hex20",
        _twisted,
        _torque,
        {
            "torque": Reference(
                2.0 * np.pi * RADII[1] ** 2 * JOINT * held_fit(), 0.02, "2 pi r^2 L mu p with Lame's p",
                "facets of 15 degrees",
            )
        },
    ),
    *(_pushed(cell) for cell in ("quad4", "quad8")),
)  # fmt: skip
