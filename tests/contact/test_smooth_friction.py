"""The constraint function of friction: its solution, derivatives and limits."""

from __future__ import annotations

import numpy as np
import pytest

from abut.contact.friction_bound import FrictionBound, PressureCurve
from abut.contact.laws import Coulomb, LawState
from abut.contact.smooth_friction import SmoothCoulomb, friction_function, slip_of
from abut.verify import law_tangents

SIZES = np.concatenate([[0.0, 1e-12, 1.0], np.linspace(0.1, 3.0, 30), 1.0 + np.array([-1e-6, 1e-6]), [1e3, 1e9]])


@pytest.mark.parametrize("epsilon", [0.3, 1e-2, 1e-4, 1e-6])
def test_solution_of_the_implicit_function(epsilon: float) -> None:
    """w with tau + w = 2/pi atan((u - w) / eps) by bisection in the bracket (-1 - tau, 1 - tau): that of every split of
    s = tau + u into tau and u. The arctangent's argument has the rounding of s over eps."""
    value, _ = friction_function(SIZES, epsilon)
    for tau in (-0.7, 0.0, 0.9):
        u = SIZES - tau
        low, high = np.full(len(u), -1.0 - tau), np.full(len(u), 1.0 - tau)
        for _ in range(200):
            w = 0.5 * (low + high)
            above = tau + w > 2.0 / np.pi * np.arctan((u - w) / epsilon)
            low, high = np.where(above, low, w), np.where(above, w, high)
        near = SIZES < 10.0  # beyond, u has lost digits
        assert np.abs(value - tau - w)[near].max() < 1e-15 / epsilon + 1e-14


def test_limit() -> None:
    """epsilon -> 0: min(s, 1), at a distance of the order of epsilon away from the corner."""
    away = np.abs(SIZES - 1.0) > 0.05
    for epsilon in (1e-3, 1e-5):
        value, slope = friction_function(SIZES[away], epsilon)
        assert np.abs(value - np.minimum(SIZES[away], 1.0)).max() < 15.0 * epsilon
        assert np.abs(slope - (SIZES[away] < 1.0)).max() < 300.0 * epsilon


@pytest.mark.parametrize("epsilon", [0.3, 1e-2, 1e-4])
def test_slope(epsilon: float) -> None:
    """Against central differences of a step far below epsilon."""
    s, step = np.linspace(0.05, 2.0, 40), 1e-5 * epsilon
    above, below = (friction_function(s + d, epsilon)[0] for d in (step, -step))
    assert np.abs((above - below) / (2.0 * step) - friction_function(s, epsilon)[1]).max() < 1e-5


def test_slip_under_a_traction() -> None:
    """The way back: s = u + tau, and all of it is slip where the law is met, tau = f."""
    tau, epsilon = np.linspace(0.0, 0.99, 50), 1e-2
    assert friction_function(slip_of(2.0 * tau, np.full(50, 2.0), epsilon) / 2.0 + tau, epsilon)[0] == pytest.approx(
        tau
    )


def points(components: int) -> tuple[np.ndarray, np.ndarray, LawState]:
    rng, n = np.random.default_rng(2), 60
    jump, traction = 0.3 * rng.standard_normal((n, components)), 3.0 * rng.standard_normal((n, components))
    traction[:, 0] = rng.choice([0.5, 2.0, 6.0], n)
    jump[0, 1:], traction[0, 1:] = 0.0, 0.0  # nothing drags and nothing slips
    return jump, traction, LawState(np.ones(n, bool), slipping=np.ones(n, bool))


@pytest.mark.parametrize("components", [2, 3])
@pytest.mark.parametrize("curve", [None, PressureCurve(np.array([1.0, 4.0]), np.array([1.0, 0.5]))])
def test_law_against_differences(components: int, curve: PressureCurve | None) -> None:
    """Central differences with a step of 1e-6: 1e-8 of the largest entry with functions as smooth as epsilon = 0.1."""
    jump, traction, state = points(components)
    law = SmoothCoulomb(3.0, FrictionBound(np.linspace(0.1, 0.9, 60), curve), 0.1, 4.0)
    assert law_tangents(law, jump, traction, state) < 1e-8


@pytest.mark.parametrize("components", [2, 3])
def test_residual_tends_to_that_of_coulomb(components: int) -> None:
    """In contact, with the status that Coulomb's law itself asks for there."""
    jump, traction, state = points(components)
    jump[:, 0] = 0.0
    size = np.linalg.norm(traction[:, 1:] - 3.0 * jump[:, 1:], axis=1)
    state = LawState(state.closed, slipping=size > 0.4 * traction[:, 0])
    exact = Coulomb(3.0, 0.4).evaluate(jump, traction, state).residual
    near = [
        np.abs(SmoothCoulomb(3.0, FrictionBound(0.4), e, 6.0).evaluate(jump, traction, state).residual - exact).max()
        for e in (1e-3, 1e-4)
    ]
    assert near[1] < 0.35 * near[0]  # the square root of epsilon at the corner, epsilon elsewhere
    assert near[1] < 0.05


def test_without_pressure_and_without_friction_nothing_drags() -> None:
    jump, traction, state = points(3)
    traction[:, 0] = np.where(np.arange(60) % 2, -1.0, 1e-13)
    law = SmoothCoulomb(3.0, FrictionBound(0.4), 1e-6, 1.0)
    assert law.evaluate(jump, traction, state).residual[:, 1:] == pytest.approx(-traction[:, 1:] / 3.0)
    law = SmoothCoulomb(3.0, FrictionBound(0.0), 1e-6, 1.0)
    assert law.evaluate(jump, np.abs(traction), state).residual[:, 1:] == pytest.approx(-np.abs(traction[:, 1:]) / 3.0)


def test_rough() -> None:
    jump, traction, state = points(3)
    law = SmoothCoulomb(3.0, FrictionBound(np.full(60, np.inf)), 1e-6, 6.0)
    assert np.array_equal(law.evaluate(jump, traction, state).residual[:, 1:], -jump[:, 1:])
    assert law_tangents(law, jump, traction, state) < 1e-8
