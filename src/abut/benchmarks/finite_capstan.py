"""Large sliding: a belt bent round a fixed pulley and drawn over it; tensions and pressure by closed form.

A thin belt of thickness t slides on a circle of radius R, its middle line at r = R + t / 2. Balance of moments about the
pulley's axis and of forces along its radius give, with tension N, shear force V and pressure p, per unit width,

    N' r = mu p R^2,    V = mu p R - N',    N = p R + V',

all of them in proportion to exp(l a) along the angle a, with l + l^2 mu t / (2 r) = mu R / r. Towards its straight end the
belt's curvature falls from 1 / r to none: it leaves the pulley at an angle e before a string would, under the force F with
cos e = 1 - E I / (2 F r^2), and presses with a force there, which takes friction as well. So the forces at the ends are as

    F_2 / F_1 = exp(l (pi - e_1 - e_2)) (cos e_1 + m sin e_1) / (cos e_2 - m sin e_2),    m = mu R / r.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import join, rectangle, ring
from abut.mesh.mesh import Mesh
from abut.model import Amplitude, Contact, Model, Solid, Support
from abut.solution import ContactResult, Solution

RADIUS, THICKNESS, FRICTION = 1.0, 0.06, 0.3
MIDDLE = RADIUS + 0.5 * THICKNESS
HALF = 3.0  # half the length of the belt
YOUNG, STIFFER = 1e3, 200.0  # of the belt; how many times that the pulley is
FREE = HALF - 0.5 * np.pi * MIDDLE  # length of a straight end
DOWN = MIDDLE + FREE  # the way of an end, at half the time, when the belt lies round the pulley without tension
SLIP, STRETCH = 0.5, 0.2  # by how much the belt is drawn along, and lengthened
STIFFNESS = YOUNG * THICKNESS**3 / 12.0  # against bending, per unit width; Poisson's ratio is zero
EDGE = 0.3  # radians beside the ends of contact where the pressure is that of bending


def belt(
    level: int = 0,
    cell: str = "quad8",
    cells: int = 40,
    turned: bool = False,
    length: float = 1.0,
    young: float = YOUNG,
) -> Model:
    """The belt above the pulley. cells: along the belt at level 0; turned: whether the pulley is the contactor; length,
    young: in other units."""
    n = cells * 2**level
    strip = rectangle((-HALF, HALF), (RADIUS, RADIUS + THICKNESS), (n, 2), cell)
    parts = {"pulley": ring((0.8 * RADIUS, RADIUS), (-20.0, 200.0), cells=(2, 4 * n // 5), cell=cell), "belt": strip}
    mesh = join(parts)
    ends = {name: _nearest(mesh, (x, RADIUS + 0.5 * THICKNESS)) for name, x in (("slack", -HALF), ("tight", HALF))}
    mesh = replace(mesh, points=length * mesh.points, node_sets=ends)
    sides = ("pulley.outer", "belt.bottom") if turned else ("belt.bottom", "pulley.outer")
    return Model(
        mesh,
        [Solid("pulley", LinearElastic(STIFFER * young, 0.3)), Solid("belt", LinearElastic(young, 0.0))],
        [
            Support("pulley.inner", x=0.0, y=0.0),
            *(
                Support(name, y=-length * DOWN, amplitude=Amplitude(((0.0, 0.0), (0.5, 1.0), (1.0, 1.0 + way / DOWN))))
                for name, way in (("slack", STRETCH - SLIP), ("tight", SLIP))
            ),
        ],
        contacts=[Contact(contactor=sides[0], target=sides[1], friction=FRICTION)],
        plane="strain", kinematics="finite",
    )  # fmt: skip


def _nearest(mesh: Mesh, place: tuple[float, float]) -> NDArray[np.int64]:
    return np.array([int(np.argmin(np.linalg.norm(mesh.points - place, axis=1)))])


@dataclass(frozen=True)
class Capstan:
    """Closed form between two forces at the ends, in units of ``RADIUS`` and ``YOUNG``. leaves: angles by which the belt
    leaves before a string; rate: l; ratio: of the forces; tension: N at the slack end of contact."""

    leaves: tuple[float, float]
    rate: float
    ratio: float
    tension: float

    @classmethod
    def of(cls, slack: float, tight: float) -> Capstan:
        shear, arm = 0.5 * FRICTION * THICKNESS / MIDDLE, FRICTION * RADIUS / MIDDLE
        rate = (np.sqrt(1.0 + 4.0 * shear * arm) - 1.0) / (2.0 * shear)
        first, last = (float(np.arccos(1.0 - STIFFNESS / (2.0 * force * MIDDLE**2))) for force in (slack, tight))
        begins, ends = np.cos(first) + arm * np.sin(first), np.cos(last) - arm * np.sin(last)
        ratio = np.exp(rate * (np.pi - first - last)) * begins / ends
        return cls((first, last), float(rate), float(ratio), float(slack * begins / (1.0 + shear * rate)))

    def pressure(self, angle: NDArray[np.float64]) -> NDArray[np.float64]:
        """At angles from where a string would begin to touch at the slack end."""
        tension = self.tension * np.exp(self.rate * (angle - self.leaves[0]))
        return np.asarray(self.rate * MIDDLE / (FRICTION * RADIUS**2) * tension)


def measure(solution: Solution) -> Mapping[str, float]:
    """Of a belt in units of ``RADIUS`` and ``YOUNG``, at the end."""
    slack, tight = (-float(solution.steps[-1].reactions[end][1]) for end in ("slack", "tight"))
    exact, contact = Capstan.of(slack, tight), solution.contacts[0]
    angle, pressure = around(solution)
    inside = (angle > exact.leaves[0] + EDGE) & (angle < np.pi - exact.leaves[1] - EDGE)
    off = pressure[inside] / exact.pressure(angle[inside]) - 1.0
    assert contact.friction is not None
    return {
        "ratio of tensions over the closed form": tight / slack / exact.ratio,
        "pressure on average": float(off.mean()) + 1.0,
        "pressure at a node": float(np.abs(off).max()),
        "friction over its limit": contact.friction.force_by_area / contact.friction.force_limit,
    }


def around(solution: Solution) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Angle from the slack side and pressure at the contactor's corners, (n,), in the order of the angle."""
    contact: ContactResult = solution.contacts[0]
    corners = contact.contactor.nodes[:, :2].ravel()
    points = (contact.contactor.points + solution.displacement)[corners]
    angle, first = np.unique(np.arctan2(points[:, 1], -points[:, 0]), return_index=True)
    return angle, contact.pressure[:, :2].ravel()[first]


def _benchmark(
    name: str, title: str, model: Callable[[int], Model], tension: float, local: float, reason: str
) -> Benchmark:
    """tension, local: tolerances of the ratio and of the pressure at a node."""
    return Benchmark(
        name, title, model, measure,
        {
            "ratio of tensions over the closed form": Reference(1.0, tension, THEORY, reason),
            "pressure on average": Reference(1.0, tension, THEORY, reason),
            "pressure at a node": Reference(0.0, local, THEORY, reason),
            "friction over its limit": Reference(1.0, 1e-8, "Coulomb: all of the contact slides", "Newton's tolerance"),
        },
    )  # fmt: skip


THEORY = "statics of a rod on a circle (Euler and Eytelwein, with thickness and bending); pressure over the closed form"
THIN = "a belt is no rod: t / R = 0.06; it leaves within a facet"
CHORDS = "chords of belt and pulley; linear cells resist bending"
BENCHMARKS = (
    _benchmark("capstan", "a belt drawn over a pulley, friction 0.3", belt, 3e-3, 0.03, THIN),
    _benchmark(
        "capstan-tri6", "the same with triangles", lambda level: belt(level, "tri6"), 3e-3, 0.03, THIN
    ),
    _benchmark(
        "capstan-pulley", "the same, the pulley being the contactor", lambda level: belt(level, turned=True), 3e-3, 0.05,
        THIN + "; a node of the pulley may lie where the belt leaves",
    ),
    _benchmark("capstan-quad4", "the same with linear cells", lambda level: belt(level, "quad4", 120), 5e-3, 0.05, CHORDS),
)  # fmt: skip
