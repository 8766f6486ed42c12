"""Fields beside displacements: what a user's physics puts in is solved with bodies and contact, in any kinematics. Bars held
across (uniaxial strain, no Poisson's ratio), so that everything has a closed form."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import abut
from abut.errors import InputError, SingularModelError
from abut.mesh.make import box, join, rectangle
from abut.mesh.mesh import Mesh
from abut.model.physics import TEMPERATURE
from models.conduction import Conduction, Heater
from models.inertia import Inertia

LENGTH, YOUNG, ALPHA, CONDUCTIVITY, HOT = 5.0, 200e3, 1e-3, 0.04, 80.0
MATERIAL = abut.LinearElastic(YOUNG, 0.0, expansion=ALPHA)


def bar(cell: str = "quad8", first: float = 0.0, end: float = LENGTH, cells: int = 6) -> Mesh:
    if cell.startswith(("hex", "tet")):
        return box((first, end), (0.0, 1.0), (0.0, 1.0), (cells, 1, 1), cell)
    return rectangle((first, end), (0.0, 1.0), (cells, 2), cell)


def heated(mesh: Mesh, physics: Conduction, held: dict[str, float] | None = None, **options: Any) -> abut.Model:
    mesh = replace(mesh, node_sets={"all": np.arange(len(mesh.points))})
    across = dict.fromkeys("yz"[: mesh.dim - 1], 0.0)
    supports = [
        abut.Support("all", **across),
        *(abut.Support(on, x=x) for on, x in (held or {"bar.left": 0.0}).items()),
    ]
    plane = {"plane": "strain"} if mesh.dim == 2 else {}
    solids = [abut.Solid(body, MATERIAL) for body in mesh.bodies]
    return abut.Model(mesh, solids, supports, physics=[physics], **plane, **options)


BETWEEN = Conduction(CONDUCTIVITY, (("bar.left", 0.0, None), ("bar.right", HOT, None)))


def of_end(step: abut.Step, model: abut.Model, on: str = "bar.right") -> np.ndarray:
    return step.displacement[model.mesh.surface(on).node_ids, 0]


@pytest.mark.parametrize("kinematics", ["small", "small-strain"])
@pytest.mark.parametrize("cell", ["quad4", "quad8", "hex8", "tet10"])
def test_a_bar_between_two_temperatures(cell: str, kinematics: str) -> None:
    """T = T1 x / L, u = alpha T1 x^2 / (2 L); at its end alpha T1 L / 2, and no stress. Nodal values are exact: both fields
    are in the functions of the cells, or their mean over the cell is. Linear: 1e-9 is rounding of the solution."""
    model = heated(join({"bar": bar(cell)}), BETWEEN, kinematics=kinematics)
    step = abut.solve(model).steps[-1]
    x = model.mesh.points[:, 0]
    assert step.converged
    assert step.remembered[TEMPERATURE] == pytest.approx(HOT * x / LENGTH, abs=1e-9 * HOT)
    assert step.displacement[:, 0] == pytest.approx(ALPHA * HOT * x**2 / (2.0 * LENGTH), abs=1e-9)
    assert of_end(step, model) == pytest.approx(ALPHA * HOT * LENGTH / 2.0, rel=1e-9)
    if cell != "quad4" and cell != "hex8":  # whose strains are constant along the bar
        assert np.abs(step.stress[:, 0]).max() < 1e-9 * YOUNG * ALPHA * HOT


@pytest.mark.parametrize("unit", [1.0, 1e-14])
@pytest.mark.parametrize("kinematics", ["small", "small-strain"])
def test_both_ways(kinematics: str, unit: float) -> None:
    """A heater at the end is switched off as the end moves: q = q0 (1 - u^2 / d^2), T1 = q L / k, u = alpha T1 L / 2; so
    that u = A (1 - u^2 / d^2) with A = alpha q0 L^2 / (2 k). By a whole tangent Newton's method has it in a few iterations,
    in any unit of heat: each field is judged by its own size, however small beside forces."""
    free = ALPHA * HOT * LENGTH / 2.0
    stroke = 0.5 * free
    heater = Heater("bar.right", unit * CONDUCTIVITY * HOT / LENGTH, stroke)
    physics = Conduction(unit * CONDUCTIVITY, (("bar.left", 0.0, None),), (heater,))
    model = heated(join({"bar": bar()}), physics, kinematics=kinematics)
    step = abut.solve(model).steps[-1]
    exact = stroke**2 / (2.0 * free) * (np.sqrt(1.0 + 4.0 * free**2 / stroke**2) - 1.0)
    assert of_end(step, model) == pytest.approx(exact, rel=1e-9)
    assert len(step.iterations) <= 8


@pytest.mark.parametrize("coupled", [True, False])
@pytest.mark.parametrize("kinematics", ["small", "small-strain"])
def test_contact_stops_the_bar(kinematics: str, coupled: bool) -> None:
    """A bar heated over half the way to a cold block of the same length: p (L + L) / E = alpha T1 L / 2 - gap. Without the
    derivative of bodies' forces by the temperature it takes iterations more and ends at the same."""
    gap = ALPHA * HOT * LENGTH / 4.0
    both = join({"bar": bar("quad4"), "block": bar("quad4", LENGTH + gap, 2.0 * LENGTH + gap, 4)})
    cold = (("block.left", 0.0, None), ("block.right", 0.0, None))
    model = heated(
        both,
        replace(BETWEEN, surfaces=(*BETWEEN.surfaces, *cold), coupled=coupled),
        {"bar.left": 0.0, "block.right": 0.0},
        contacts=[abut.Contact(contactor="bar.right", target="block.left")],
        kinematics=kinematics,
    )
    solution = abut.solve(model)
    step, contact = solution.steps[-1], solution.contacts[0]
    pressure = YOUNG * (ALPHA * HOT * LENGTH / 2.0 - gap) / (2.0 * LENGTH)
    tolerance = 1e-8 if kinematics == "small" else 2e-2  # pressures on what the sides have become, points moved by 1 %
    assert contact.pressure[~np.isnan(contact.pressure)] == pytest.approx(pressure, rel=tolerance)
    assert of_end(step, model) == pytest.approx(gap + pressure * LENGTH / YOUNG, rel=tolerance)
    assert step.reactions["bar.left"][0] == pytest.approx(pressure, rel=tolerance)
    assert all(check.passed for check in solution.certificate)


def test_heated_and_cooled() -> None:
    """Over steps, along a history, and back to nothing; a run that goes on after the first step ends likewise."""
    pulse = abut.Amplitude(((0.0, 0.0), (0.5, 1.0), (1.0, 0.0)))
    physics = replace(BETWEEN, surfaces=(("bar.left", 0.0, None), ("bar.right", HOT, pulse)))
    model = heated(join({"bar": bar()}), physics, solve=abut.SolveOptions(steps=4))
    saved: list[abut.solution.Saved] = []
    solution = abut.solve(model, on_step=lambda _, step: saved.append(step))
    full = ALPHA * HOT * LENGTH / 2.0
    ends = [of_end(step, model)[0] for step in solution.steps]
    assert ends == pytest.approx([0.5 * full, full, 0.5 * full, 0.0], abs=1e-9 * full)
    again = abut.solve(model, resume=saved[:2])
    assert [of_end(step, model)[0] for step in again.steps] == pytest.approx(ends, abs=1e-12 * full)


def test_what_cannot_be_is_said() -> None:
    mesh = join({"bar": bar("quad4")})
    twice = replace(BETWEEN, surfaces=(*BETWEEN.surfaces, ("bar.bottom", 1.0, None)))
    with pytest.raises(SingularModelError, match=r"physics\[0\]: values are prescribed twice"):
        abut.solve(heated(mesh, twice))
    with pytest.raises(InputError, match=r"solve\.linear: \"amg\" knows displacements alone"):
        abut.solve(heated(mesh, BETWEEN, solve=abut.SolveOptions(linear="amg")))
    with pytest.raises(InputError, match=r"physics\[1\]: there is another field 'temperature'"):
        replace(heated(mesh, BETWEEN), physics=[BETWEEN, BETWEEN])
    with pytest.raises(InputError, match=r"physics\[1\]: a term cannot be named 'inertia'"):
        abut.solve(replace(heated(mesh, BETWEEN), physics=[Inertia("bar.right", 1.0)] * 2))
