"""Elasticity over temperature: bars whose stress is known, tangents, and rows between which constants are linear."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.materials.places import Places
from abut.mesh.make import box, join
from abut.verify.tangents import differences

COLD = abut.LinearElastic(200.0, 0.2, expansion=1e-4)
HOT = abut.LinearElastic(100.0, 0.4, expansion=3e-4)
STEEL = abut.OverTemperature([0.0, 100.0], [COLD, HOT], initial_temperature=20.0, zero=-50.0)


def bar(material: abut.OverTemperature, degrees: float, stretch: float, kinematics: str = "small") -> abut.Solution:
    """Held at both ends, free across."""
    mesh = join({"bar": box((0, 2), (0, 1), (0, 1), (2, 1, 1), "hex8")})
    held = [abut.Support("bar.left", x=0), abut.Support("bar.front", y=0), abut.Support("bar.bottom", z=0)]
    held.append(abut.Support("bar.right", x=2.0 * stretch))
    solid = abut.Solid("bar", material, temperature=degrees)
    return abut.solve(abut.Model(mesh, [solid], held, kinematics=kinematics))


@pytest.mark.parametrize("degrees", [-80.0, -10.0, 30.0, 80.0, 500.0])
def test_bar(degrees: float) -> None:
    """Stress E(T) (e - alpha(T) (T - zero) + alpha(T0) (T0 - zero)), constants linear between and constant beyond."""
    now = 20.0 + degrees
    share = min(max(now / 100.0, 0.0), 1.0)
    young, poisson = 200.0 - 100.0 * share, 0.2 + 0.2 * share
    swelling = (1e-4 + 2e-4 * share) * (now + 50.0) - 1.4e-4 * 70.0
    stress = young * (1e-3 - swelling)
    solution = bar(STEEL, degrees, 1e-3)
    assert solution.steps[-1].stress[:, 0] == pytest.approx(stress, rel=1e-9)
    side = np.abs(solution.model.mesh.points[:, 1] - 1.0) < 1e-9
    assert solution.displacement[side, 1] == pytest.approx(swelling - poisson * stress / young, rel=1e-8)


def test_finite_bar() -> None:
    """Heat stretches first: of a free bar the length is 1 + swelling times what it was."""
    swelling = 2e-4 * 100.0 - 1.4e-4 * 70.0
    solution = bar(STEEL, 30.0, swelling, "finite")
    assert np.abs(solution.steps[-1].stress).max() < 1e-9 * 200.0


@pytest.mark.parametrize("finite", [False, True])
def test_tangent(finite: bool) -> None:
    rng = np.random.default_rng(0)
    here = STEEL.at(Places(rng.uniform(size=(5, 3)), rng.uniform(-50, 150, 5)))
    told = here.evaluate_finite if finite else here.evaluate
    strain, none = rng.uniform(-0.1, 0.1, (5, 6)), np.zeros((5, 0))
    tangent = told(strain, none)[1]
    assert np.abs(tangent - differences(lambda e: told(e, none)[0], strain)).max() < 1e-7 * np.abs(tangent).max()


def test_one_row_is_the_material_itself() -> None:
    """A single row, and the temperature of a row: the material given there."""
    ply = abut.Orthotropic([5.0, 2.0, 1.0], [0.1, 0.1, 0.1], [1.0, 1.0, 1.0])
    warm = abut.Orthotropic([3.0, 2.0, 1.0], [0.1, 0.1, 0.1], [1.0, 0.5, 1.0])
    strain = np.random.default_rng(1).uniform(-1, 1, (3, 6))
    none, places = np.zeros((3, 0)), Places(np.zeros((3, 3)), np.full(3, 70.0))
    for material in (abut.OverTemperature([5.0], [ply]), abut.OverTemperature([70.0, 90.0], [ply, warm])):
        assert material.at(places).evaluate(strain, none)[0] == pytest.approx(ply.evaluate(strain, none)[0], rel=1e-12)


@pytest.mark.parametrize(
    ("temperatures", "materials", "said"),
    [
        ([0.0, 1.0], [COLD], "as many of both"),
        ([1.0, 1.0], [COLD, HOT], "must grow"),
        ([0.0, 1.0], [COLD, abut.Hencky(1.0, 0.3)], "Hencky does not depend on temperature"),
        (
            [0.0, 1.0],
            [COLD, abut.Orthotropic([1.0] * 3, [0.0] * 3, [1.0] * 3)],
            "all elastic, all plastic, or all with directions",
        ),
    ],
)
def test_refused(temperatures: list[float], materials: list[abut.LinearElastic], said: str) -> None:
    with pytest.raises(InputError, match=said):
        abut.OverTemperature(temperatures, materials)
