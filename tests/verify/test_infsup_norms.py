"""The norms of the inf-sup test against theory: H1 of displacements, H^-1/2 of pressures, the trace space."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.coupling import couple
from abut.contact.geometry import full_moments
from abut.linear.fractional import inverse_root
from abut.mesh.make import rectangle
from abut.mesh.surface import Surface
from abut.verify.norms import h1_matrix, trace_norm
from abut.verify.trace import TraceSpace, trace_space
from models.patch import ROTATION
from models.surfaces import grid, line


def whole(surface: Surface, degree: int, divisions: int) -> TraceSpace:
    return trace_space(surface, degree, np.ones(len(surface)), divisions)


def coefficients(surface: Surface, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Facet-wise nodal values, flat, of a function given at the surface's points."""
    return np.where(surface.nodes >= 0, values[np.maximum(surface.nodes, 0)], 0.0).ravel()


@pytest.mark.parametrize("accuracy", [1e-3, 1e-5])
@pytest.mark.parametrize("kind", ["line2", "line3", "tri3", "tri6", "quad4", "quad8", "quad9"])
def test_rational_approximation_of_the_trace_norm(kind: str, accuracy: float) -> None:
    """Against the eigenvectors of (M + L, M), for any pressure: the accuracy asked for."""
    surface = line(kind, 6, distort=0.2) if kind.startswith("line") else grid(kind, (3, 3), distort=0.2)
    space = whole(surface, 1, 2)
    values, vectors = scipy.linalg.eigh(space.full.toarray(), space.mass.toarray())
    q = np.random.default_rng(0).standard_normal((9 * len(surface), 5))
    c = vectors.T @ (space.moments @ q)
    exact = c.T @ np.diag(values**-0.5) @ c
    norm = trace_norm(space, sp.eye(len(q)), accuracy=accuracy)
    assert q.T @ norm(q) == pytest.approx(exact, abs=accuracy * np.abs(exact).max())
    assert values.min() == pytest.approx(1.0, abs=1e-10)  # the constant


@pytest.mark.parametrize("high", [2.0, 1e3, 1e8])
@pytest.mark.parametrize("accuracy", [1e-3, 1e-5, 1e-8])
def test_inverse_root_by_resolvents(high: float, accuracy: float) -> None:
    x = np.geomspace(1.0, high, 200)
    shifts, weights = inverse_root(1.0, high, accuracy)
    assert (weights / (x[:, None] + shifts)).sum(axis=1) * np.sqrt(x) == pytest.approx(1.0, abs=accuracy)


@pytest.mark.parametrize("k", [0, 1, 3, 6])
def test_trace_norm_of_a_cosine(k: int) -> None:
    """cos(k pi x) is an eigenfunction of the Laplacian on an interval (slope zero at its ends), with eigenvalue
    1 + (k pi)^2: the squared norm is 1/2 (1 + (k pi)^2)^-1/2 (1 for k = 0). Tolerance: the rational approximation's 1e-5;
    interpolation on 128 quadratic facets, of order h^4, is below it."""
    surface = line("line3", 128)
    q = coefficients(surface, np.cos(k * np.pi * surface.points[:, 0]))
    exact = (0.5 if k else 1.0) / np.sqrt(1.0 + (k * np.pi) ** 2)
    assert q @ trace_norm(whole(surface, 2, 1), sp.eye(len(q)))(q) == pytest.approx(exact, rel=2e-5)


def test_trace_norm_in_3d_and_turned() -> None:
    """cos(pi x) cos(2 pi y) on the unit square: 1/4 (1 + 5 pi^2)^-1/2. Interpolation on 12 x 12 quadratic facets is off
    by 1e-4, whichever way the square lies."""
    for kind in ("tri6", "quad8", "quad9"):
        surface = grid(kind, (12, 12))
        x = surface.points
        q = coefficients(surface, np.cos(np.pi * x[:, 0]) * np.cos(2 * np.pi * x[:, 1]))
        turned = replace(surface, points=x @ ROTATION.T)
        for own in (surface, turned):
            value = q @ trace_norm(whole(own, 2, 1), sp.eye(len(q)))(q)
            assert value == pytest.approx(0.25 / np.sqrt(1.0 + 5.0 * np.pi**2), rel=5e-4)


def test_trace_space_of_a_closed_curve() -> None:
    """On a circle of radius 1, cos(k t) has the eigenvalue 1 + k^2 and int cos^2 = pi: the facets join up all round.
    Interpolation on 64 quadratic arcs, of order (k h)^4, is off by 2e-5."""
    n, k = 64, 3
    t = np.arange(2 * n) * np.pi / n
    i = np.arange(n)
    nodes = np.stack([(2 * i + 2) % (2 * n), 2 * i, 2 * i + 1], axis=1)
    surface = replace(line("line3", n), points=np.column_stack([np.cos(t), np.sin(t)]))
    surface.nodes[:, :3] = nodes
    q = coefficients(surface, np.cos(k * t))
    value = q @ trace_norm(whole(surface, 2, 1), sp.eye(len(q)))(q)
    assert value == pytest.approx(np.pi / np.sqrt(1.0 + k**2), rel=1e-4)


def test_h1_norm_of_a_quadratic() -> None:
    """u = x^2 + x y on the unit square: int u^2 = 1/5 + 1/4 + 1/9, int |grad u|^2 = 4/3 + 1 + 1/3 + 1/3, exactly."""
    for cell in ("quad8", "quad9", "tri6"):
        mesh = rectangle((0, 1), (0, 1), (3, 2), cell)
        x, y = mesh.points.T
        u = x**2 + x * y
        assert u @ h1_matrix(mesh) @ u == pytest.approx(1 / 5 + 1 / 4 + 1 / 9 + 4 / 3 + 1 + 1 / 3 + 1 / 3, rel=1e-12)


def test_full_moments_are_what_the_pressure_mass_sums_to() -> None:
    """int H_k H_l summed over l is int H_k: the pressure mass that node-to-segment borrows from the trace space."""
    surface = grid("quad8", (3, 2), distort=0.2)
    space = whole(surface, 2, 2)
    assert space.pressure_mass.sum(axis=2) == pytest.approx(full_moments(surface, 2), abs=1e-12)
    coupling = couple(surface, grid("quad8", (3, 2), distort=0.2, up=False), 2)
    assert space.pressure_mass == pytest.approx(coupling.mass, abs=1e-12)
