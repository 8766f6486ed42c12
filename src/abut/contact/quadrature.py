"""Rules on segments: Gauss-Legendre and closed Newton-Cotes, as tables for the compiled core.

A segment is a set of cones from an apex to its edges. Along an edge the rule lives on [0, 1]; from the apex outward it
carries the weight r of the cone, theory (Q1), so that n x n points are exact for polynomials of degree 2 n - 1 (Gauss);
theory (Q3).
"""

from __future__ import annotations

import functools

import numpy as np
from numpy.typing import NDArray
from scipy.special import roots_jacobi

from abut.types import Array

MAX_POINTS = 16
MOMENT_TOLERANCE = 1e-12  # of a plane facet's own int N_i N_j, relative to its area: theory (Q4)
CURVED_TOLERANCE = 0.1  # of a curved one's, times the fourth power of the angle by which its normals turn, and at most
MOST_TOLERANCE = 1e-5


def moment_tolerance(dim: int, turning: NDArray[np.float64]) -> NDArray[np.float64]:
    """How exactly each facet has to meet its own int N_i N_j, relative to its area, (n_facets,): theory (Q6).

    turning: (n_facets,) angle by which its normals turn."""
    curved = CURVED_TOLERANCE * turning**4 if dim == 3 else np.zeros(len(turning))
    return np.clip(curved, MOMENT_TOLERANCE, MOST_TOLERANCE)


def _gauss(n: int) -> tuple[Array, ...]:
    x, w = np.polynomial.legendre.leggauss(n)
    y, v = roots_jacobi(n, 0.0, 1.0)  # weight 1 + y
    return 0.5 * (x + 1.0), 0.5 * w, 0.5 * (y + 1.0), 0.25 * v


def _newton_cotes(n: int) -> tuple[Array, ...]:
    if n == 1:
        return _gauss(1)
    t = np.linspace(0.0, 1.0, n)
    powers = np.vander(t, n, increasing=True).T  # theory (Q2)
    order = np.arange(n)
    return t, np.linalg.solve(powers, 1.0 / (order + 1)), t, np.linalg.solve(powers, 1.0 / (order + 2))


@functools.cache  # asked for with every pair, and slow to find
def rule_tables(rule: str) -> NDArray[np.float64]:
    """Tables (4, count, width) of t, w_t, r, w_r on [0, 1] for 1..count points; ``rule`` is "gauss" or "newton-cotes".

    w_r holds the factor r of the map that collapses a square into a triangle, theory (Q1), (Q2)."""
    make, count = (_newton_cotes, 9) if rule == "newton-cotes" else (_gauss, MAX_POINTS)
    tables = np.zeros((4, count, count))
    for n in range(1, count + 1):
        tables[:, n - 1, :n] = make(n)
    tables.setflags(write=False)
    return tables
