"""Balls with friction: pressed and pushed along (Mindlin), and pressed on another material (Spence)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipk

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import box, join, rectangle
from abut.mesh.mesh import Mesh
from abut.model import Amplitude, Contact, Force, Model, Rigid, Solid, SolveOptions, Support
from abut.solution import Solution

YOUNG, POISSON = 200.0, 0.3
MODULUS = 0.5 * YOUNG / (1.0 - POISSON**2)  # E* of two balls
FLAT = 100.0  # radius of the balls over that of the contact
PUSH, COEFFICIENT = 0.6, 0.2  # over what friction carries
SIZE, ZONE = 4.0, 1.1  # of the blocks cut from the half spaces, and of their fine part
MINDLIN = "Mindlin 1949: c / a = (1 - Q / (mu P))^(1 / 3) (Johnson 1985, section 7.2)"


def _half(z: tuple[float, float], cells: int, cell: str, way: float) -> Mesh:
    """A block y >= 0 whose side at z = 0 is bent."""
    depth = [-0.8, 0.0] if z[1] == 0.0 else [0.0, 0.8]
    fine = {"x": [-ZONE, ZONE], "y": [0.0, ZONE], "z": depth}
    mesh = box((-SIZE, SIZE), (0.0, SIZE), z, (2 * cells, cells, cells // 2), cell, fine, 2.5)
    x, y, at = mesh.points.T
    bent = way * (x**2 + y**2) / (2.0 * FLAT) * (1.0 - np.abs(at) / SIZE)
    return replace(mesh, points=np.column_stack([x, y, at + bent]))


def _share_that_sticks(solution: Solution) -> float:
    """Radius of a circle of the area that sticks, over that of one of the area in contact."""
    friction = solution.contacts[0].friction
    assert friction is not None
    return float(np.sqrt(friction.sticking_area / (friction.sticking_area + friction.slipping_area)))


def _mindlin(cell: str, cells: int) -> Benchmark:
    force = 4.0 / 3.0 * MODULUS / (0.5 * FLAT)  # for a contact of radius one

    def model(level: int) -> Model:
        n = cells * 2**level
        parts = {
            "lower": _half((-SIZE, 0.0), n, cell, -1.0),
            "upper": _half((0.0, SIZE), n + 1, cell, 1.0),
            "plate": box((-SIZE, SIZE), (0.0, SIZE), (SIZE, SIZE + 1.0), (1, 1, 1)),
        }
        down, along = Amplitude(((0.0, 0.0), (0.5, 1.0))), Amplitude(((0.5, 0.0), (1.0, 1.0)))
        return Model(
            join(parts),
            [Solid(body, LinearElastic(YOUNG, POISSON)) for body in ("lower", "upper")],
            [Support("lower.bottom", x=0, y=0, z=0), *(Support(f"{body}.front", y=0) for body in ("lower", "upper"))],
            [
                Force("plate.top", (0.0, 0.0, -0.5 * force), down),
                Force("plate.top", (0.5 * PUSH * COEFFICIENT * force, 0.0, 0.0), along),
            ],
            [
                Contact(contactor="lower.top", target="upper.bottom", friction=COEFFICIENT),
                Contact(contactor="upper.top", target="plate.bottom", kind="tied"),
            ],
            rigid=[Rigid("plate", y=0.0, rx=0.0, ry=0.0, rz=0.0)],
            solve=SolveOptions(steps=2),
        )

    def measure(solution: Solution) -> dict[str, float]:
        contact = solution.contacts[0]
        assert contact.friction is not None
        corners = contact.contactor.nodes[:, :4]
        middle = np.argmin(np.linalg.norm(contact.contactor.points[corners, :2], axis=2))
        drag = np.abs(contact.friction.traction[:, :4, 0]).ravel()[middle]
        stick = 1.0 - float(drag / (COEFFICIENT * contact.pressure[:, :4].ravel()[middle]))
        return {"stick": stick, "area": _share_that_sticks(solution)}

    exact = (1.0 - PUSH) ** (1.0 / 3.0)
    return Benchmark(
        f"mindlin-ball-{cell}",
        f"two balls pressed together, then pushed along, half of them, {cell}",
        model,
        measure,
        {
            "stick": Reference(
                exact, 0.03, f"{MINDLIN}, q = mu p (1 - c / a) in the middle", f"blocks of {SIZE:g} a for half spaces"
            ),
            "area": Reference(
                exact, ZONE / cells / exact, MINDLIN, "of circles of the areas that stick and that touch: one facet"
            ),
        },
    )


SOFT = LinearElastic(YOUNG, 0.45)  # the half space under a rigid ball
BETA = 0.5 * (1.0 - 2.0 * 0.45) / (1.0 - 0.45)  # of Dundurs
RUB = 0.7 * BETA
FAR = 100.0  # radius and depth of the half space over the radius of the contact
SPENCE = "Spence 1975: (a / 2c) ln((a + c) / (a - c)) = (mu / beta) K'(c / a), whatever the load"


def stick_of_a_rigid_ball() -> float:
    """c / a from Spence's equation."""

    def left(k: float) -> float:
        return float(0.5 / k * np.log((1.0 + k) / (1.0 - k)) - RUB / BETA * ellipk(1.0 - k**2))

    return float(brentq(left, 1e-6, 1.0 - 1e-9))


def _spence(steps: int) -> Benchmark:
    def model(level: int) -> Model:
        n = 60 * 2**level
        space = rectangle((0.0, FAR), (-FAR, 0.0), (n, n), "quad4", {"x": [0.0, 1.2], "y": [-1.0, 0.0]}, 1.3)
        ball = rectangle((0.0, 2.0), (0.0, 1.0), (n, 1), "quad4")
        x, y = ball.points.T
        ball = replace(ball, points=np.column_stack([x, y + x**2 / (2.0 * FLAT)]))
        return Model(
            join({"space": space, "ball": ball}),
            [Solid("space", SOFT)],
            [Support("space.bottom", x=0, y=0)],
            contacts=[Contact(contactor="space.top", target="ball.bottom", friction=RUB)],
            plane="axisymmetric",
            rigid=[Rigid("ball", y=-1.0 / FLAT)],
            solve=SolveOptions(steps=steps),
        )

    return Benchmark(
        "spence-ball",
        "a rigid ball pressed on a half space with friction, axisymmetric, quad4",
        model,
        lambda solution: {"stick": _share_that_sticks(solution)},
        {
            "stick": Reference(
                stick_of_a_rigid_ball(),
                0.03,
                SPENCE,
                "shear changes the pressure by the order of beta^2, which the equation leaves out: 1 %; facets of 2 % of a, "
                "on either edge",
            )
        },
    )


BENCHMARKS = (_mindlin("hex8", 8), _mindlin("hex20", 5), _spence(16))
