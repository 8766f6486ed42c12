"""Integration rules on reference cells and facets, and the points where stresses are best."""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.special import roots_jacobi

from abut.cells import CELLS

Rule = tuple[NDArray[np.float64], NDArray[np.float64]]  # points (q, dim), weights (q,)


@functools.cache  # asked for again and again, and slow to find
def _line(n: int) -> Rule:
    x, w = np.polynomial.legendre.leggauss(n)
    for values in (x, w):
        values.setflags(write=False)
    return x[:, None], w


def _product(*rules: Rule) -> Rule:
    points, weights = rules[0]
    for x, w in rules[1:]:
        points = np.concatenate([np.repeat(points, len(x), axis=0), np.tile(x, (len(points), 1))], axis=1)
        weights = np.outer(weights, w).ravel()
    return points, weights


def _triangle(n: int) -> Rule:
    """Symmetric where small: 1 point (degree 1), 3 (degree 2), 6 (degree 4); else ``_simplex``."""
    if n == 1:
        return np.full((1, 2), 1 / 3), np.array([0.5])
    if n == 3:
        return np.array([[1, 1], [4, 1], [1, 4]]) / 6.0, np.full(3, 1 / 6)
    if n == 6:  # Strang and Fix: two orbits a, a, 1 - 2 a
        points, weights = [], []
        for a, w in ((0.445948490915965, 0.223381589678011), (0.091576213509771, 0.109951743655322)):
            points += [[a, a], [1 - 2 * a, a], [a, 1 - 2 * a]]
            weights += [0.5 * w] * 3
        return _polish(np.array(points), np.array(weights))
    return _simplex(n, 2)


def _polish(points: NDArray[np.float64], weights: NDArray[np.float64]) -> Rule:
    """Weights that integrate all monomials up to degree 2 exactly (the tabulated digits end at 1e-15)."""
    x, y = points.T
    powers = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y])
    exact = np.array([1 / 2, 1 / 6, 1 / 6, 1 / 12, 1 / 24, 1 / 12])
    return points, weights + np.linalg.lstsq(powers, exact - powers @ weights, rcond=None)[0]


def _tetrahedron(n: int) -> Rule:
    """1 point, 4 points (degree 2), else ``_simplex``."""
    if n == 1:
        return np.full((1, 3), 0.25), np.array([1 / 6])
    if n == 4:
        a = (5 - np.sqrt(5)) / 20
        return np.full((4, 3), a) + (1 - 4 * a) * np.vstack([np.zeros(3), np.eye(3)]), np.full(4, 1 / 24)
    return _simplex(n, 3)


def _cube(n: int, dim: int) -> Rule:
    return _product(*[_line(n)] * dim)


def _wedge(tri: int, line: int) -> Rule:
    return _product(_triangle(tri), _line(line))


def stiffness_rule(kind: str) -> Rule:
    """Exact for a constant stress on cells with straight edges in general position."""
    return {
        "tri3": lambda: _triangle(1),
        "tri6": lambda: _triangle(6),
        "quad4": lambda: _cube(2, 2),
        "quad8": lambda: _cube(3, 2),
        "quad9": lambda: _cube(3, 2),
        "tet4": lambda: _tetrahedron(1),
        "tet10": lambda: _tetrahedron(3),
        "hex8": lambda: _cube(2, 3),
        "hex20": lambda: _cube(3, 3),
        "hex27": lambda: _cube(3, 3),
        "wedge6": lambda: _wedge(3, 2),
        "wedge15": lambda: _wedge(6, 3),
    }[kind]()


# Types of second order whose smaller rule leaves no motion without energy that neighbours could share (theory (E2)).
REDUCED: dict[str, Callable[[], Rule]] = {
    "tri6": lambda: _triangle(3),
    "quad8": lambda: _cube(2, 2),
    "tet10": lambda: _tetrahedron(4),
    "hex20": lambda: _cube(2, 3),
    "wedge15": lambda: _wedge(3, 3),
}


BBAR = ("quad4", "hex8")  # types whose constant part of the dilatation is worth keeping alone


# Pressures of a mixed cell of each type, theory (E6), (E7): 1, or 1 and one for each coordinate. More are unstable.
PRESSURES = {"tri6": 1, "quad4": 1, "quad8": 1, "quad9": 3, "hex8": 1, "hex20": 1, "hex27": 4}


# Types whose mixed cells share a pressure at each corner with all others of their body, theory (E8): cell by cell none is
# stable.
CONTINUOUS = ("tet10",)


def cell_rule(kind: str, integration: str) -> Rule:
    """The rule of the stiffness of a cell: smaller for "reduced", else ``stiffness_rule``."""
    return REDUCED[kind]() if integration == "reduced" else stiffness_rule(kind)


def product_rule(kind: str) -> Rule:
    """Exact for products of two shape functions on cells with an affine map."""
    return {
        "tri3": lambda: _triangle(3),
        "tet4": lambda: _tetrahedron(4),
        "tet10": lambda: _tetrahedron(5),
        "wedge6": lambda: _wedge(3, 2),
    }.get(kind, lambda: stiffness_rule(kind))()


def field_rule(kind: str) -> Rule:
    """For functions of position that are no polynomials (loads, errors against exact fields): exact to degree 2 p + 3 with
    shape functions of degree p and an affine map, more than the square of the first terms that these lack."""
    return gauss_rule(kind, CELLS[kind].degree + 2)


def gauss_rule(kind: str, n: int) -> Rule:
    """n points per direction on any cell or facet type, exact to degree 2 n - 1 (on cubes: in each coordinate)."""
    cell = CELLS[kind]
    if kind.startswith("wedge"):
        return _product(_simplex(n, 2), _line(n))
    return _simplex(n, cell.dim) if cell.corners == cell.dim + 1 and cell.dim > 1 else _cube(n, cell.dim)


def _simplex(n: int, dim: int) -> Rule:
    """n^dim points on a triangle or tetrahedron, exact to degree 2 n - 1: the cube collapsed to it, with the Jacobian in
    the weights (Gauss-Jacobi; Stroud 1971, section 2.4)."""
    x = np.empty((1, 0))
    w = np.ones(1)
    for power in range(dim):  # the new coordinate takes its share of what the others leave
        z, wz = roots_jacobi(n, power, 0)
        z, wz = 0.5 * (z + 1.0), wz / 2.0 ** (power + 1)
        rest = np.tile(x, (n, 1)) * (1.0 - np.repeat(z, len(x)))[:, None]
        x, w = np.column_stack([rest, np.repeat(z, len(w))]), np.outer(wz, w).ravel()
    return x, w


def superconvergent_rule(kind: str) -> Rule:
    """The points at which stresses converge a power of h faster than elsewhere, at least where cells are alike (Barlow 1976;
    Zienkiewicz and Zhu 1992): the Gauss points of one degree less than the displacements."""
    return {
        "tri3": lambda: _triangle(1),
        "tri6": lambda: _triangle(3),
        "tet4": lambda: _tetrahedron(1),
        "tet10": lambda: _tetrahedron(4),
        "wedge6": lambda: _wedge(1, 1),
        "wedge15": lambda: _wedge(3, 2),
    }.get(kind, lambda: _cube(CELLS[kind].degree, CELLS[kind].dim))()


def error_rule(kind: str) -> Rule:
    """For the square of the difference between recovered and element stress, which is zero or small at the superconvergent
    points."""
    return {"tri3": lambda: _triangle(3), "tet4": lambda: _tetrahedron(4)}.get(kind, lambda: stiffness_rule(kind))()


def facet_rule(kind: str) -> Rule:
    """Exact for consistent loads on curved quadratic facets."""
    return gauss_rule(kind, 5 if kind.startswith("quad") else 4)
