"""Logarithms of stretches in the compiled core, whose series must not lose digits where it ends."""

import numpy as np

from abut._core import hooke

BULK, SHEAR = 3.0, 2.0


def test_one_stretch_alone_has_numpys_logarithm() -> None:
    """Hooke's law of logarithms, one strain g of Green and Lagrange, the others none: the stress is
    (K + 4 G / 3) ln(1 + 2 g) / 2 / (1 + 2 g), strains of nearly nothing to stretches of three; a few roundings apart."""
    small = np.geomspace(1e-13, 0.4, 200)
    strain = np.concatenate([small, -small, [0.05, -0.05, 4.0]])
    strains = np.zeros((len(strain), 6))
    strains[:, 0] = strain
    stress, _, _ = hooke(BULK, SHEAR).evaluate(strains, np.zeros((len(strain), 0)), True)
    expected = (BULK + 4.0 / 3.0 * SHEAR) * np.log1p(2.0 * strain) / 2.0 / (1.0 + 2.0 * strain)
    np.testing.assert_allclose(stress[:, 0], expected, rtol=8.0 * np.finfo(float).eps)


def test_two_stretches_have_the_shear_modulus_between_them() -> None:
    """What turns the axes: the stress conjugate to logarithms is coaxial, and its shear tangent is the difference of the
    stresses over that of the squared stretches, here of stretches that lie apart by any ratio; the differences of the
    expectation lose a thousand roundings at the closest ones."""
    apart = np.geomspace(1e-3, 0.4, 100)
    strains = np.zeros((len(apart), 6))
    strains[:, 0], strains[:, 1] = apart, -apart
    stress, tangent, _ = hooke(BULK, SHEAR).evaluate(strains, np.zeros((len(apart), 0)), True)
    expected = (stress[:, 0] - stress[:, 1]) / (2.0 * (strains[:, 0] - strains[:, 1]))
    np.testing.assert_allclose(tangent[:, 3, 3], expected, rtol=1e-12)
