"""What friction carries under a pressure: values and derivatives."""

from __future__ import annotations

import numpy as np
import pytest

from abut.contact.friction_bound import FrictionBound, PressureCurve

CURVE = PressureCurve(np.array([1.0, 4.0, 9.0]), np.array([0.5, 0.2, 0.3]))


def test_a_curve_between_at_and_beyond_its_points() -> None:
    """Linear between, constant beyond; at a point the slope of the part above."""
    value, slope = CURVE.at(np.array([0.5, 1.0, 2.5, 4.0, 6.5, 9.0, 20.0]))
    assert value == pytest.approx([0.5, 0.5, 0.35, 0.2, 0.25, 0.3, 0.3])
    assert slope == pytest.approx([0.0, -0.1, -0.1, 0.02, 0.02, 0.0, 0.0])


@pytest.mark.parametrize("curve", [None, CURVE])
@pytest.mark.parametrize("coefficient", [0.3, np.array([0.1, 0.2, 0.3, 0.4])])
def test_the_bound_and_its_derivative(coefficient: float | np.ndarray, curve: PressureCurve | None) -> None:
    """mu(p) p, whose derivative is mu + mu' p: by differences within each part."""
    bound, pressure, step = FrictionBound(coefficient, curve), np.array([0.5, 2.0, 7.0, 30.0]), 1e-6
    value, slope = bound.at(pressure)
    assert value == pytest.approx(bound.coefficients(pressure) * pressure)
    difference = (bound.at(pressure + step)[0] - bound.at(pressure - step)[0]) / (2.0 * step)
    assert slope == pytest.approx(difference, abs=1e-8)
    over = np.ones(4) if curve is None else np.interp(pressure, curve.pressures, curve.coefficients)
    assert bound.coefficients(pressure) == pytest.approx(coefficient * over)


def test_surfaces_that_never_slip_and_those_without_friction() -> None:
    rough = FrictionBound(np.inf)
    assert rough.rough
    value, slope = rough.at(np.array([0.0, 2.0]))
    assert np.isinf(value).all()
    assert (slope == 0.0).all()
    some = FrictionBound(np.array([0.0, 0.2]))
    assert not some.rough
    assert some.none.tolist() == [True, False]
    assert FrictionBound(0.0).none
