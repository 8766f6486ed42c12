"""Metal that yields over temperature: heated bars by hand, tangents, unloading, rows between which constants are linear."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.materials.places import Places
from abut.mesh.make import box, join
from abut.verify.tangents import differences

COLD = abut.Plastic(200.0, 0.2, [(0.0, 2.0), (0.05, 3.0)], expansion=1e-4)
HOT = abut.Plastic(100.0, 0.4, [(0.0, 1.0), (0.1, 2.0)], expansion=3e-4)
STEEL = abut.OverTemperature([0.0, 100.0], [COLD, HOT], initial_temperature=20.0, zero=-50.0)
BACK = abut.OverTemperature(
    [0.0, 100.0],
    [
        abut.Plastic(200.0, 0.3, 2.0, backstresses=[(40.0, 0.0)]),
        abut.Plastic(100.0, 0.3, 1.0, backstresses=[(10.0, 0.0)]),
    ],
)
FADING = abut.OverTemperature(
    [0.0, 100.0],
    [
        abut.Plastic(200.0, 0.3, 2.0, 1.0, 0.5, 20.0, [(40.0, 30.0)]),
        abut.Plastic(100.0, 0.3, 1.0, 2.0, 0.2, 10.0, [(10.0, 5.0)]),
    ],
)


def constants(now: float) -> tuple[float, float, float]:
    """Young's modulus, Poisson's ratio and thermal strain since the beginning of ``STEEL``."""
    share = min(max(now / 100.0, 0.0), 1.0)
    return 200.0 - 100.0 * share, 0.2 + 0.2 * share, (1e-4 + 2e-4 * share) * (now + 50.0) - 1.4e-4 * 70.0


def yield_stress(now: float, x: float) -> float:
    """Of ``STEEL``."""
    share = min(max(now / 100.0, 0.0), 1.0)
    cold, hot = np.interp(x, [0.0, 0.05], [2.0, 3.0]), np.interp(x, [0.0, 0.1], [1.0, 2.0])
    return float((1.0 - share) * cold + share * hot)


def _root(falling: Callable[[float], float], high: float) -> float:
    """Where a function falls through zero between 0, where it may be below already, and high, by bisection."""
    low = 0.0
    for _ in range(200):
        middle = (low + high) / 2.0
        low, high = (middle, high) if falling(middle) > 0.0 else (low, middle)
    return low


def flowed(now: float, strain: float) -> float:
    """Equivalent plastic strain x of a bar of ``STEEL`` that a strain < 0 stresses: Y(T, x) / E(T) + x = -strain."""
    return _root(lambda x: -strain - x - yield_stress(now, x) / constants(now)[0], -strain)


def bar(material: object, loads: list, held: list, times: list[float], kinematics: str = "small") -> abut.Solution:
    """Free across, with its left end held."""
    mesh = join({"bar": box((0, 2), (0, 1), (0, 1), (2, 1, 1), "hex8")})
    sides = [abut.Support("bar.left", x=0), abut.Support("bar.front", y=0), abut.Support("bar.bottom", z=0)]
    options = abut.SolveOptions(times=tuple(times))
    solid = abut.Solid("bar", material)
    return abut.solve(abut.Model(mesh, [solid], [*sides, *held], loads, kinematics=kinematics, solve=options))


def heated(times: list[float], degrees: list[float]) -> abut.Temperature:
    """All of the bar, linear between."""
    return abut.Temperature("bar", 1.0, amplitude=abut.Amplitude([(0.0, 0.0), *zip(times, degrees)]))


@pytest.mark.parametrize("degrees", [60.0, 130.0])
def test_held_bar(degrees: float) -> None:
    """Between two walls: in compression it yields as hot as it is; cooled, it is torn by what has flowed."""
    held = [abut.Support("bar.right", x=0.0)]
    solution = bar(STEEL, [heated([0.5, 1.0], [degrees, 0.0])], held, [0.25, 0.5, 0.75, 1.0])
    hot, cold = (solution.steps[i].stress[:, 0] for i in (1, 3))
    swelling = constants(20.0 + degrees)[2]
    x = flowed(20.0 + degrees, -swelling)
    assert x > 0.001
    assert hot == pytest.approx(-yield_stress(20.0 + degrees, x), rel=1e-8)
    torn = constants(20.0)[0] * x
    y = _root(lambda y: torn - constants(20.0)[0] * y - yield_stress(20.0, x + y), x)  # what it flows back
    assert (y > 0.01) == (degrees > 100.0)
    assert cold == pytest.approx(torn - constants(20.0)[0] * y, rel=1e-8)


def test_weight() -> None:
    """A weight hangs on it and it warms: it yields when Y(T) has come down to the stress, and flows (s - Y(T)) / H(T); with
    Young's modulus and the expansion of that temperature. Unloaded, it is as long as it flowed."""
    stress, degrees = 1.85, 60.0
    pulled = abut.Traction("bar.right", [stress, 0, 0], amplitude=abut.Amplitude([(0, 0), (0.2, 1), (0.8, 1), (1, 0)]))
    solution = bar(STEEL, [pulled, heated([0.2, 0.8, 1.0], [0.0, degrees, degrees])], [], [0.2, 0.5, 0.8, 1.0])
    young, poisson, swelling = constants(80.0)
    x = (stress - 1.2) / (0.2 * 20.0 + 0.8 * 10.0)
    assert x > 0.05
    x = 0.05 + (stress - yield_stress(80.0, 0.05)) / 8.0  # beyond the end of the cold table
    end = solution.model.mesh.points[:, 0] > 1.9
    side = solution.model.mesh.points[:, 1] > 0.9
    loaded, unloaded = solution.steps[2].displacement, solution.steps[3].displacement
    assert loaded[end, 0] / 2.0 == pytest.approx(stress / young + x + swelling, rel=1e-8)
    assert loaded[side, 1] == pytest.approx(-poisson * stress / young - x / 2.0 + swelling, rel=1e-8)
    assert unloaded[end, 0] / 2.0 == pytest.approx(x + swelling, rel=1e-8)


def test_finite_held_bar() -> None:
    """Logarithmic strain less that of heat: -ln(1 + s) = -(Y(T, x) / E + x); Cauchy's stress is that over the volume."""
    solution = bar(STEEL, [heated([1.0], [130.0])], [abut.Support("bar.right", x=0.0)], [0.5, 1.0], "finite")
    young, poisson, swelling = constants(150.0)
    x = flowed(150.0, -np.log1p(swelling))
    stress = -yield_stress(150.0, x)
    volume = np.exp((1.0 - 2.0 * poisson) * stress / young)
    assert x > 0.03
    assert solution.steps[-1].stress[:, 0] == pytest.approx(stress / volume, rel=1e-8)


def test_back_stress_follows_its_modulus() -> None:
    """Flow at 0 degrees, then 100: the back stress is C(T) times the plastic strain; compression yields at C x - Y."""
    x = 0.05
    at = [BACK.at(Places(np.zeros((1, 3)), np.array([degrees]))) for degrees in (0.0, 100.0)]
    stress = 2.0 + 40.0 * x
    strain = np.array([[stress / 200.0 + x, *[-0.3 * stress / 200.0 - x / 2.0] * 2, 0, 0, 0]])
    told, _, history = at[0].evaluate(strain, BACK.initial(1))
    assert told[0, 0] == pytest.approx(stress, rel=1e-10)
    y, back = 0.01, x - 0.01
    stress = -1.0 + 10.0 * back
    strain = np.array([[stress / 100.0 + back, *[-0.3 * stress / 100.0 - back / 2.0] * 2, 0, 0, 0]])
    told, _, after = at[1].evaluate(strain, history)
    assert told[0] == pytest.approx([stress, 0, 0, 0, 0, 0], abs=1e-10)
    assert after[0, 6] == pytest.approx(x + y, rel=1e-10)


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("law", [STEEL, BACK, FADING])
def test_tangent(law: abut.OverTemperature, finite: bool) -> None:
    rng = np.random.default_rng(0)
    first, second = (law.at(Places(rng.uniform(size=(20, 3)), rng.uniform(-50, 150, 20))) for _ in range(2))
    strain = rng.uniform(-0.1, 0.1, (20, 6))
    history = (first.evaluate_finite if finite else first.evaluate)(strain, law.initial(20))[2]
    told = second.evaluate_finite if finite else second.evaluate
    strain = strain + rng.uniform(-0.05, 0.05, (20, 6))
    tangent = told(strain, history)[1]
    assert (told(strain, history)[2][:, 6] > history[:, 6]).sum() > 10
    assert np.abs(tangent - differences(lambda e: told(e, history)[0], strain)).max() < 1e-7 * np.abs(tangent).max()


@pytest.mark.parametrize("finite", [False, True])
def test_at_a_row(finite: bool) -> None:
    """At the temperature of a row, and beyond the last: the material given there, on the same path."""
    rng = np.random.default_rng(1)
    law = abut.OverTemperature([0.0, 100.0], [COLD, HOT], initial_temperature=20.0)
    for degrees, one in ((-60.0, COLD), (-20.0, COLD), (80.0, HOT), (500.0, HOT)):
        here = law.at(Places(np.zeros((5, 3)), np.full(5, degrees)))
        history, before = here.initial(5), one.initial(5)
        heat = one.expansion * degrees
        stretch = 1.0 + heat
        for _ in range(3):
            strain = rng.uniform(-0.05, 0.05, (5, 6))
            if finite:
                less = (strain - 0.5 * (stretch**2 - 1.0) * np.array([1, 1, 1, 0, 0, 0])) / stretch**2
                stress, _, history = here.evaluate_finite(strain, history)
                found, _, before = one.evaluate_finite(less, before)
                found = stretch * found
            else:
                stress, _, history = here.evaluate(strain, history)
                found, _, before = one.evaluate(strain - heat * np.array([1, 1, 1, 0, 0, 0]), before)
            assert stress == pytest.approx(found, abs=1e-10)
            assert history == pytest.approx(before, abs=1e-12)


def test_refused() -> None:
    one, two = abut.Plastic(1.0, 0.3, 1.0), abut.Plastic(1.0, 0.3, 1.0, backstresses=[(1.0, 0.0)])
    with pytest.raises(InputError, match="as many"):
        abut.OverTemperature([0.0, 1.0], [one, two])
    with pytest.raises(InputError, match="all elastic, all plastic"):
        abut.OverTemperature([0.0, 1.0], [one, abut.LinearElastic(1.0, 0.3)])


def unevenly_heated(steps: int) -> abut.Solution:
    """A bar of four reduced hex20 between two walls, the warmer the farther along it; where it is hot, metal flows first."""
    cold = abut.Plastic(200e3, 0.3, [(0.0, 300.0), (0.1, 500.0)], expansion=12e-6)
    hot = abut.Plastic(150e3, 0.3, [(0.0, 200.0), (0.1, 350.0)], expansion=14e-6)
    steel = abut.OverTemperature([20.0, 420.0], [cold, hot], initial_temperature=20.0)
    mesh = join({"bar": box((0, 10), (0, 2), (0, 2), (4, 1, 1), "hex20")})
    sides = [abut.Support("bar.left", x=0), abut.Support("bar.right", x=0)]
    sides += [abut.Support("bar.front", y=0), abut.Support("bar.bottom", z=0)]
    heat = abut.Temperature("bar", lambda points: 40.0 * points[:, 0])
    solid = abut.Solid("bar", steel, integration="reduced")
    return abut.solve(abut.Model(mesh, [solid], sides, [heat], solve=abut.SolveOptions(steps=steps)))


def test_unevenly_heated_bar() -> None:
    """Iterations may leave the solution so far behind that all that is out of balance is small beside the forces there: that
    is none, and steps are halved. By ten steps or by one the bar is where backward differences lead, within a percent, and
    no point moves farther than all of it would, as hot as its end, without walls."""
    ten, one = (unevenly_heated(steps).steps[-1] for steps in (10, 1))
    size = np.abs(ten.displacement).max()
    assert ten.converged
    assert one.converged
    assert 0.0 < size < 14e-6 * 400.0 * 10.0
    assert np.abs(ten.displacement - one.displacement).max() < 0.01 * size
    assert all(np.abs(step.reaction).max() < 1e-9 * step.internal for step in (ten, one))
