"""Second-order cones: what their algebra must do, by definition."""

from __future__ import annotations

import numpy as np
import pytest

from abut.nonlinear.cones import depth, longest, product, quotient, scaling, times

ROUNDING = 1e-12  # of vectors no nearer to the boundary than 1e-2


def inside(d: int, seed: int, n: int = 40) -> np.ndarray:
    rng = np.random.default_rng(seed)
    x = rng.normal(size=(n, d))
    x[:, 0] = np.linalg.norm(x[:, 1:], axis=1) + np.exp(rng.uniform(-4, 2, n))
    return x


@pytest.mark.parametrize("d", [2, 3])
def test_scaling_maps_both_vectors_to_one(d: int) -> None:
    u, z = inside(d, 1), inside(d, 2)
    of = scaling(u, z)
    size = np.abs(of.middle).max(axis=1, keepdims=True)
    assert np.abs((times(of.inverse, u) - of.middle) / size).max() < 1e-9  # of matrices whose condition is up to 1e4
    assert np.abs(np.einsum("nij,njk->nik", of.matrix, of.inverse) - np.eye(d)).max() < 1e-9
    assert (depth(of.middle) > 0.0).all()
    assert np.allclose(product(of.middle, of.middle)[:, 0], np.einsum("nd,nd->n", u, z), rtol=1e-9)


@pytest.mark.parametrize("d", [2, 3])
def test_quotient_undoes_the_product(d: int) -> None:
    x, y = inside(d, 3), inside(d, 4)
    assert np.abs(quotient(x, product(x, y)) - y).max() < 1e-10 * np.abs(y).max()


@pytest.mark.parametrize("d", [2, 3])
def test_longest_step_ends_on_the_boundary(d: int) -> None:
    for seed in range(20):
        x, step = inside(d, seed, 1), np.random.default_rng(100 + seed).normal(size=(1, d))
        length = longest(x, step)
        if np.isinf(length):
            assert depth(x + 1e6 * step)[0] > 0.0
            continue
        end = x + length * step
        assert abs(depth(end)[0]) < ROUNDING * (np.abs(x) + length * np.abs(step)).max() ** 2
        assert (depth(x + np.linspace(0, 0.999, 50)[:, None] * length * step) > 0.0).all()


def test_axis_alone() -> None:
    assert longest(np.array([[1.0, 0.0]]), np.array([[-2.0, 0.0]])) == pytest.approx(0.5)
    assert np.isinf(longest(np.array([[1.0, 0.5]]), np.array([[1.0, 0.2]])))
    assert np.isinf(longest(np.zeros((0, 3)), np.zeros((0, 3))))
