"""Loads beyond what metal carries: the run ends near the limit load that theory gives, and says so."""

from __future__ import annotations

import re

import numpy as np
import pytest

import abut
from abut.mesh.make import box, join, rectangle, ring
from abut.solution import Check

YIELD, STEPS = 300.0, 10
SHORTEST = 1.0 / STEPS / 32  # of the time: parts of a step are halved down to a sixty-fourth, and taken up from there


def bar(load: float, kinematics: str = "small", **given: float) -> abut.Model:
    """Of an area of 1, pulled."""
    mesh = join({"bar": box((0, 2), (0, 1), (0, 1), (2, 1, 1), "hex8")})
    held = [abut.Support("bar.left", x=0), abut.Support("bar.front", y=0), abut.Support("bar.bottom", z=0)]
    metal = abut.Plastic(210e3, 0.3, YIELD, **given)
    pulled = abut.Traction("bar.right", [load, 0, 0])
    options = abut.SolveOptions(steps=STEPS, max_iterations=15)
    return abut.Model(mesh, [abut.Solid("bar", metal)], held, [pulled], kinematics=kinematics, solve=options)


def told(solution: abut.Solution) -> float:
    """The time that the note on the limit load names; the last step converged there."""
    found = [re.search(r"limit load near time ([\d.]+)", note) for note in solution.notes]
    (time,) = [float(match[1]) for match in found if match]
    assert not solution.converged
    assert time == pytest.approx(solution.steps[-2].factor, rel=1e-4)
    line = of_limit(solution)
    assert line.verdict == "FAIL"
    assert line.value == pytest.approx(1.0 - time, abs=1e-4)
    assert f"limit load near time {time:.5g}" in line.meaning
    return time


def of_limit(solution: abut.Solution) -> Check:
    """The certificate's line."""
    (line,) = (check for check in solution.certificate if check.name == "limit load")
    return line


@pytest.mark.long
@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_bar(kinematics: str) -> None:
    """The yield stress on the area; under finite strains on the one that elasticity leaves, (1 - nu Y / E)^2."""
    solution = abut.solve(bar(1.2 * YIELD, kinematics))
    area = (1.0 - 0.3 * YIELD / 210e3) ** 2 if kinematics == "finite" else 1.0
    time = told(solution)
    assert time <= area / 1.2 * (1.0 + 1e-6)
    assert area / 1.2 < time + SHORTEST


CARRIES = 2.0 / np.sqrt(3.0) * YIELD * np.log(2.0)  # of the cylinder, Hill 1950


def cylinder(pressure: float) -> abut.Solution:
    """A wall of radii 100 and 200 in plane strain, pressed from within."""
    mesh = join({"wall": ring((100, 200), (0, 90), cells=(6, 4), cell="quad8")})
    held = [abut.Support("wall.start", y=0), abut.Support("wall.end", x=0)]
    solid = abut.Solid("wall", abut.Plastic(210e3, 0.3, YIELD))
    load = abut.Pressure("wall.inner", pressure)
    options = abut.SolveOptions(steps=STEPS, max_iterations=15)
    return abut.solve(abut.Model(mesh, [solid], held, [load], plane="strain", solve=options))


def test_thick_cylinder() -> None:
    """2 / sqrt 3 Y ln(b / a) within, plane strain, whose meshes of cells that do not lock come close from above."""
    assert 1.1 * told(cylinder(1.1 * CARRIES)) == pytest.approx(1.0, abs=1.1 * SHORTEST + 0.003)


def test_ends_at_the_limit() -> None:
    """All of the limit load, which the mesh just carries: the last steps shrink, and metal flows far more than before."""
    solution = cylinder(CARRIES)
    assert solution.converged
    (note,) = (note for note in solution.notes if "limit load near time 1 " in note)
    assert "prescribe displacements" in note
    line = of_limit(solution)
    assert (line.verdict, line.value) == ("warn", 0.0)
    assert "limit load near time 1 " in line.meaning


def test_ends_below_the_limit() -> None:
    """0.98 of it is carried in whole steps: nothing is said."""
    solution = cylinder(0.98 * CARRIES)
    assert solution.converged
    assert not any("limit load" in note for note in solution.notes)
    assert of_limit(solution).verdict == "pass"


def beam(share: float) -> abut.Solution:
    """A beam of a height and a width of 1, 8 long, held at one end and bent by a shear force at the other: ``share`` of what
    the plastic hinge Y / 4 at its root carries. Plane stress."""
    mesh = join({"beam": rectangle((0, 8), (0, 1), (16, 6), "quad8")})
    held = [abut.Support("beam.left", x=0), abut.Support("beam.left", y=0)]
    solid = abut.Solid("beam", abut.Plastic(210e3, 0.3, YIELD))
    load = abut.Traction("beam.right", [0, -share * YIELD / 4.0 / 8.0])
    options = abut.SolveOptions(steps=STEPS, max_iterations=15)
    return abut.solve(abut.Model(mesh, [solid], held, [load], plane="stress", solve=options))


@pytest.mark.long
def test_bent_beam() -> None:
    """A plastic hinge carries Y h^2 / 4 a width. The root is held across, and half its height carries the shear force, too:
    a few percent more than the hinge of a bar. An elastic beam would yield at two thirds."""
    time = told(beam(1.3))
    assert 1.0 - SHORTEST < 1.3 * time < 1.08


def test_metal_that_hardens() -> None:
    """It goes on: stress over hardening, and nothing is said."""
    solution = abut.solve(bar(1.2 * YIELD, hardening=1000.0))
    assert solution.converged
    assert not any("limit load" in note for note in solution.notes)
    assert of_limit(solution).verdict == "pass"
    assert of_limit(solution).value == 0.0
    moved = np.abs(solution.displacement[:, 0]).max() / 2.0
    assert moved == pytest.approx(1.2 * YIELD / 210e3 + 0.2 * YIELD / 1000.0, rel=1e-8)


def test_prescribed_displacements_go_on() -> None:
    model = bar(0.0)
    held = [*model.supports, abut.Support("bar.right", x=0.02)]
    solution = abut.solve(abut.Model(model.mesh, model.solids, held, solve=model.solve))
    assert solution.converged
    assert not any(check.name == "limit load" for check in solution.certificate)
    assert solution.steps[-1].stress[:, 0] == pytest.approx(YIELD, rel=1e-9)
