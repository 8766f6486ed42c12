"""Equations that move several points of a contact together: its pressures are one of many, displacements are unique."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

import abut
from abut.mesh import make
from models.constrained import at, equal
from models.sliding import FIRST, THEN

EXACT = 1e-8
YOUNG, AREA, FORCE = 100.0, 1.0, 8.0
STEM = abut.LinearElastic(YOUNG, 0.0)


def shortened(force: float) -> float:
    """Length over the first one of a bar of unit section and Saint Venant and Kirchhoff's material, nu = 0, pressed
    together: F = E A l (1 - l^2) / 2."""
    return float(brentq(lambda stretch: 0.5 * YOUNG * stretch * (1.0 - stretch**2) - force, 0.6, 1.0, xtol=1e-15))


def level_cubes(friction: float, slide: float = 0.0) -> abut.Model:
    """Two cubes of four cells, faces in contact kept level by equations: nine nodal pressures act on one displacement."""
    mesh = make.join({
        "lower": make.box([0, 1], [0, 1], [0, 1], cells=[2, 2, 1]),
        "upper": make.box([0, 1], [0, 1], [1, 2], cells=[2, 2, 1]),
    })  # fmt: skip
    equations = []
    for surface in ("lower.top", "upper.bottom"):
        first, *others = map(int, mesh.nodes_of(surface))
        equations += [equal((node, "z"), (first, "z")) for node in others]
    return abut.Model(
        mesh, [abut.Solid("lower", STEM), abut.Solid("upper", STEM)],
        [abut.Support("lower.bottom", x=0, y=0, z=0), abut.Support("upper.top", x=slide, y=0, amplitude=THEN)],
        [abut.Traction("upper.top", (0, 0, -FORCE), amplitude=FIRST)], kinematics="finite", equations=equations,
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", friction=friction)],
    )  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_level_faces(friction: float) -> None:
    """Both cubes shorten as a bar does; of all pressures a small one is taken, the uniform one."""
    solution = abut.solve(level_cubes(friction))
    assert solution.converged
    assert sum(len(step.iterations) for step in solution.steps) <= 5 * len(solution.steps)
    stretch, z = shortened(FORCE), solution.model.mesh.points[:, 2]
    assert solution.displacement[:, 2] == pytest.approx((stretch - 1.0) * z, abs=EXACT)
    contact = solution.contacts[0]
    assert contact.force[2] == pytest.approx(FORCE, rel=EXACT)
    assert contact.max_pressure == pytest.approx(FORCE / AREA, rel=1e-6)
    assert any("one of many" in note for note in solution.notes)


@pytest.mark.long
def test_level_faces_slide() -> None:
    """One cube slides by a quarter over the other: friction is 0.3 of the force that presses."""
    solution = abut.solve(level_cubes(0.3, slide=0.25))
    assert solution.converged
    force = solution.contacts[0].force
    assert force[2] == pytest.approx(FORCE, rel=EXACT)
    assert force[0] == pytest.approx(-0.3 * FORCE, rel=1e-6)


@pytest.mark.long
def test_an_even_pressure_stays_even() -> None:
    """Without friction every pressure is one of many all the way, and an even one serves on three quarters of the area. The
    areas under functions change by an eighth or less in a step, changes of the pressure by that share of themselves."""
    contact = abut.solve(level_cubes(0.0, slide=0.25)).contacts[0]
    assert contact.force[2] == pytest.approx(FORCE, rel=EXACT)
    assert contact.max_pressure == pytest.approx(FORCE / (0.75 * AREA), rel=0.125 / 3.0)


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("cell", ["quad4", "quad8"])
def test_periodic_strips(cell: str, friction: float) -> None:
    """A period of two strips with different meshes, pressed together by 20 %: uniform, like a bar that cannot widen; with
    nu = 0 the pressure is that of the bar."""
    mesh = make.join({
        "lower": make.rectangle([0, 2], [0, 1], cells=[5, 2], cell=cell),
        "upper": make.rectangle([0, 2], [1, 2], cells=[4, 2], cell=cell),
    })  # fmt: skip
    equations = []
    for body in ("lower", "upper"):
        for far in map(int, mesh.nodes_of(f"{body}.right")):
            near = at(mesh, body, 0.0, mesh.points[far, 1])
            equations += [equal((far, "x"), (near, "x")), equal((far, "y"), (near, "y"))]
    model = abut.Model(
        mesh, [abut.Solid("lower", STEM), abut.Solid("upper", STEM)],
        [abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=0, y=-0.4)], plane="strain",
        kinematics="finite", equations=equations,
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", friction=friction)],
    )  # fmt: skip
    solution = abut.solve(model)
    assert solution.converged
    assert solution.displacement[:, 1] == pytest.approx(-0.2 * mesh.points[:, 1], abs=EXACT)
    pressure = 0.5 * YOUNG * 0.8 * (1.0 - 0.8**2)
    contact = solution.contacts[0]
    assert contact.force[1] == pytest.approx(2.0 * pressure, rel=EXACT)
    assert contact.max_pressure == pytest.approx(pressure, rel=1e-6)
    assert np.abs(contact.force[0]) < EXACT * pressure
