"""Depth, force and pressure of the bonded layers of ``abut.benchmarks.layers``, by an integral equation solved here.

A pressure with the cosine (Hankel) transform p(k) on a layer of thickness b, incompressible, bonded to a rigid base, moves
its surface by p(k) (sinh 2x - 2x) / (cosh 2x + 1 + 2x^2) / (2 G k), x = k b (plane strain and axial symmetry alike): for
thick layers p / (2 G k), the half space, for thin ones p k^2 b^3 / (3 G), lubrication. Pressures are sums of powers
(1 - t^2)^(m + 1/2), t = x / a, whose transforms are Bessel functions; the profile depth - x^2 / (2 R) is met at points."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.special import gamma, jv

from abut.benchmarks import BENCHMARKS, run
from abut.benchmarks.layers import LAYERS, Layer

POWERS, FARTHEST = 10, 200  # of pressures; wave number times half width
ACCURATE = 2e-3  # by twice as many wave numbers


def compliance(x: np.ndarray) -> np.ndarray:
    """2 G k times the displacement by a pressure."""
    fading = np.exp(-2.0 * x)
    whole = (0.5 * (1.0 - fading**2) - 2.0 * x * fading) / (0.5 * (1.0 + fading**2) + fading * (1.0 + 2.0 * x**2))
    return np.where(x < 1e-2, 2.0 / 3.0 * x**3, whole)


@cache
def waves() -> tuple[np.ndarray, np.ndarray]:
    """Wave numbers times the half width, and weights (Gauss, intervals of 1/2)."""
    points, weights = np.polynomial.legendre.leggauss(6)
    starts = 0.5 * np.arange(2 * FARTHEST)
    return (starts[:, None] + 0.25 * (points + 1.0)).ravel(), np.tile(0.25 * weights, 2 * FARTHEST)


def solved(body: str, a: float) -> tuple[float, float, float]:
    """Depth, force and largest pressure for the half width of contact a; thickness, shear modulus and radius 1."""
    k, weight = waves()
    gives = weight * compliance(k / a) * a / (2.0 * k)
    at = np.cos(np.pi * (np.arange(1, 3 * POWERS + 1) - 0.5) / (6 * POWERS))
    m = np.arange(POWERS)
    if body == "cylinder":
        transforms = [np.sqrt(np.pi) * gamma(i + 1.5) * (2.0 / k) ** (i + 1) * jv(i + 1, k) for i in m]
        waving, forces = np.cos(np.outer(at, k)) / np.pi, np.sqrt(np.pi) * gamma(m + 1.5) / gamma(m + 2.0) * a
    else:
        transforms = [2.0 ** (i + 0.5) * gamma(i + 1.5) * jv(i + 1.5, k) / k ** (i + 1.5) for i in m]
        waving, forces = jv(0, np.outer(at, k)) * k, np.pi * a**2 / (m + 1.5)
    columns = [waving @ (gives * transform) for transform in transforms]
    matrix = np.stack([*columns, -np.ones_like(at)], axis=1)
    size = np.linalg.norm(matrix, axis=0)
    found = np.linalg.lstsq(matrix / size, -0.5 * (a * at) ** 2, rcond=1e-13)[0] / size
    return float(found[-1]), float(forces @ found[:-1]), float(found[:-1].sum())


@pytest.mark.parametrize("known", LAYERS, ids=lambda known: f"{known.body}-{known.half_width:g}")
def test_references(known: Layer) -> None:
    assert solved(known.body, known.half_width) == pytest.approx(
        (known.depth, known.force, known.largest), rel=ACCURATE
    )


def test_thick_layers() -> None:
    """Hertz: pi a^2 E* / (4 R) of a cylinder, 4 a^3 E* / (3 R) of a ball, E* = 4 G; the layer adds (a / b)^2 about."""
    a = 0.1
    assert solved("cylinder", a)[1] == pytest.approx(np.pi * a**2, rel=2.0 * a**2)
    assert solved("ball", a)[1] == pytest.approx(16.0 / 3.0 * a**3, rel=2.0 * a**2)


def test_thin_layers() -> None:
    """Lubrication: depth a^2 / (6 R) and a^2 / (4 R) (not a^2 / (2 R), of layers that change their volume), beyond it by a
    share of order b / a: halved as a / b doubles."""
    for body, depth in (("cylinder", 1.0 / 6.0), ("ball", 0.25)):
        beyond = [solved(body, a)[0] / (depth * a**2) - 1.0 for a in (10.0, 20.0, 40.0)]
        assert 0.0 < beyond[2] < beyond[1] < beyond[0] < 0.3
        assert beyond[1] / beyond[2] == pytest.approx(2.0, rel=0.1)


@pytest.mark.parametrize("name", ["layer-cylinder-10-tri6", "layer-ball-2-quad9", "layer-ball-10-quad9"])
def test_finite_elements(name: str) -> None:
    assert all(outcome.passed for outcome in run(BENCHMARKS[name]))
