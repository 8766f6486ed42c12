"""The contact patch test: exact for every ordered pair of facet types, with every law.

A constant pressure lies in the pressure space and the exact displacement is linear, so with exact integration on
segments the discrete solution is the exact one. The strain is 1e-3 and coordinates are of order 1: rounding of the
coordinates alone costs 1e-13, the linear solver about as much.
"""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

import abut
from models.patch import CELL_OF, errors, exact_displacement, model, two_blocks

LAWS = {"complementarity": {}, "constraint-function": {"law": "constraint-function", "epsilon": 1e-24}}
PLANE = ("tri3", "tri6", "quad4", "quad8", "quad9")
EXACT = 1e-10


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("contactor", "target"), list(itertools.product(CELL_OF, CELL_OF)))
def test_every_facet_pair_in_3d(contactor: str, target: str, law: str) -> None:
    mesh = two_blocks(CELL_OF[contactor], CELL_OF[target], ((2, 3, 2), (3, 2, 2)))
    pressure, displacement = errors(model(mesh, **LAWS[law]))
    assert pressure < EXACT
    assert displacement < EXACT


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("target", CELL_OF)
@pytest.mark.parametrize("contactor", ["tri6", "quad8", "quad9"])
def test_linear_pressure_on_quadratic_facets(contactor: str, target: str, law: str) -> None:
    mesh = two_blocks(CELL_OF[contactor], CELL_OF[target], ((2, 3, 2), (3, 2, 2)))
    assert max(errors(model(mesh, pressure="P1", **LAWS[law]))) < EXACT


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("contactor", "target"), list(itertools.product(PLANE, PLANE)))
def test_every_cell_pair_in_2d(contactor: str, target: str, law: str) -> None:
    mesh = two_blocks(contactor, target, ((5, 3), (7, 3)))
    assert max(errors(model(mesh, **LAWS[law]))) < EXACT


@pytest.mark.parametrize("facet", ["tet4", "tet10"])
def test_tetrahedra(facet: str) -> None:
    assert max(errors(model(two_blocks(facet, facet, ((2, 3, 2), (3, 2, 2)))))) < EXACT


@pytest.mark.long
@pytest.mark.parametrize("ratio", [1e4, 1e-4])
@pytest.mark.parametrize("cells", [((1, 1, 1), (10, 10, 2)), ((10, 10, 2), (1, 1, 1))], ids=["coarse", "fine"])
@pytest.mark.parametrize("kind", ["wedge6", "hex8", "hex20", "hex27", "tet10"])
def test_size_ratio_ten_and_stiffness_ratio(kind: str, cells: tuple[tuple[int, ...], ...], ratio: float) -> None:
    """Coarse or fine contactor, soft or stiff. Condition of the equations grows with the contrast: 1e-8."""
    mesh = two_blocks(kind, kind, cells, distort=0.1)
    assert max(errors(model(mesh, young=(1.0, ratio)))) < 1e-8


@pytest.mark.parametrize("kind", ["hex20", "hex27", "wedge15", "tet10"])
def test_curved_edges_within_the_interface(kind: str) -> None:
    """Mid nodes moved within the interface plane: the edges are parabolas there, and the facets still tile it. The limit
    1e-5 is that of the stiffness, whose quadrature is not exact on curved cells."""
    mesh = two_blocks(kind, kind, ((2, 2, 1), (3, 3, 1)), distort=0.1)
    x = mesh.points.copy()
    inside = np.abs(x[:, 2] - 1.0) < 1e-9
    inside &= ((x[:, :2] > 1e-9) & (x[:, :2] < 1 - 1e-9)).all(axis=1)
    corners = np.unique(np.concatenate([b.nodes[:, : abut_corners(b.kind)].ravel() for b in mesh.blocks]))
    inside[corners] = False
    rng = np.random.default_rng(5)
    x[inside, :2] += 0.02 * rng.uniform(-1, 1, (int(inside.sum()), 2))
    built = model(replace(mesh, points=x))
    assert max(errors(built)) < 1e-5


def abut_corners(kind: str) -> int:
    from abut.cells import CELLS

    return CELLS[kind].corners


@pytest.mark.parametrize("space", ["P0", "P1", "dual"])
def test_other_spaces_hold_a_constant_pressure(space: str) -> None:
    """Unstable spaces may have spurious modes, but the coarser target here hides them: the answer is exact."""
    mesh = two_blocks("hex8", "hex8", ((3, 3, 2), (2, 2, 2)))
    built = model(mesh, pressure=space)
    assert max(errors(built)) < EXACT


@pytest.mark.parametrize("facet", CELL_OF)
def test_newton_cotes_is_exact_on_affine_facets(facet: str) -> None:
    """Closed rules of n points are exact to degree n - 1 (n, when n is odd): Simpson holds linear times linear, five
    points quadratic times quadratic, on triangles of any shape and on parallelograms."""
    points = 3 if facet in ("tri3", "quad4") else 5
    distort = 0.2 if facet.startswith("tri") else 0.0
    mesh = two_blocks(CELL_OF[facet], CELL_OF[facet], ((2, 3, 2), (3, 2, 2)), distort=distort)
    assert max(errors(model(mesh, integration=abut.Integration("newton-cotes", points)))) < EXACT


@pytest.mark.parametrize("facet", ["quad4", "quad8", "quad9"])
def test_newton_cotes_converges_on_distorted_facets(facet: str) -> None:
    """The integrand is no polynomial there; it is smooth, so that two more points win at least a decade."""
    mesh = two_blocks(CELL_OF[facet], CELL_OF[facet], ((2, 3, 2), (3, 2, 2)))
    few, many = (max(errors(model(mesh, integration=abut.Integration("newton-cotes", n)))) for n in (7, 9))
    assert many < 0.1 * few
    assert many < 1e-6


def test_too_few_points_fail() -> None:
    """The test can fail: one Gauss point on a segment does not integrate linear times linear."""
    mesh = two_blocks("hex8", "hex8", ((2, 3, 2), (3, 2, 2)))
    assert max(errors(model(mesh, integration=abut.Integration("gauss", 1)))) > 1e-4


def test_tied_blocks_are_one() -> None:
    mesh = two_blocks("hex20", "tet10", ((2, 3, 2), (3, 2, 2)))
    built = model(mesh, kind="tied")
    solution = abut.solve(built)
    exact = exact_displacement(built)
    assert np.abs(solution.displacement - exact).max() < EXACT * np.abs(exact).max()
