"""Segments, coupling, pressure spaces and laws on surfaces alone."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from abut._core import shape_functions
from abut.cells import BY_CODE, CELLS
from abut.contact.bases import non_negative_block
from abut.contact.coupling import CouplingOptions, couple, surface_degree
from abut.contact.geometry import full_moments
from abut.contact.laws import constraint_function
from abut.contact.pressure_space import pressure_space, resolve
from abut.errors import InputError
from abut.mesh.surface import Surface
from models.surfaces import FACETS_2D, FACETS_3D, grid, in_plane, line


def nodal_areas(surface: Surface) -> np.ndarray:
    """int N_j over the surface by quadrature on its own facets."""
    total = np.zeros(len(surface.points))
    moments = full_moments(surface, 2)
    used = surface.nodes >= 0
    np.add.at(total, surface.nodes[used], moments[used])
    return total


@pytest.mark.parametrize("curved", [False, True])
@pytest.mark.parametrize(("kc", "kt"), list(itertools.product(FACETS_3D, FACETS_3D)))
def test_segments_tile_both_surfaces(kc: str, kt: str, curved: bool) -> None:
    """A unit pressure gives both sides their own consistent nodal forces: the segments leave no gap and no overlap, and
    are integrated exactly (to the 1e-12 of the moment condition), also with edges curved within the plane."""
    contactor = grid(kc, (3, 4), distort=0.15, seed=1, bulge=in_plane if curved else None)
    target = grid(kt, (4, 3), distort=0.15, up=False, seed=2, bulge=in_plane if curved else None)
    name, degree = resolve("auto", contactor)
    coupling = couple(contactor, target, degree)
    space = pressure_space(name, contactor, coupling)
    unit = space.transfer @ np.ones(len(space))
    for part, surface, first in ((coupling.contactor_part, contactor, 0), (coupling.target_part, target, None)):
        n = len(surface.points)
        force = (part.T @ unit).reshape(-1, 3)[:n] if first == 0 else (part.T @ unit).reshape(-1, 3)[-n:]
        assert force[:, 2] == pytest.approx(-nodal_areas(surface), abs=1e-11)
        assert np.abs(force[:, :2]).max() < 1e-15
    assert coupling.covered.sum() == pytest.approx(1.0, abs=1e-12)
    assert np.abs(coupling.gap).max() == 0.0


@settings(max_examples=25, deadline=None)
@given(
    shift=st.tuples(st.floats(-0.9, 0.9), st.floats(-0.9, 0.9)),
    kinds=st.tuples(st.sampled_from(FACETS_3D), st.sampled_from(FACETS_3D)),
    scale=st.sampled_from([1e-9, 1.0, 1e3]),
)
def test_partial_overlap_covers_the_exact_area(shift, kinds, scale) -> None:
    """The target hangs over or falls short: the covered area is that of two shifted unit squares, in any unit; action
    equals reaction."""
    contactor = grid(kinds[0], (3, 2), distort=0.1, seed=3)
    target = grid(kinds[1], (2, 3), distort=0.1, up=False, seed=4)
    x = (target.points + np.array([*shift, 0.0])) * scale
    contactor = Surface(contactor.points * scale, contactor.kinds, contactor.nodes, contactor.cells, contactor.local)
    target = Surface(x, target.kinds, target.nodes, target.cells, target.local)
    coupling = couple(contactor, target, surface_degree(contactor))
    exact = (1 - abs(shift[0])) * (1 - abs(shift[1]))
    assert coupling.covered.sum() / scale**2 == pytest.approx(exact, abs=1e-11)
    balance = np.asarray(coupling.operator.sum(axis=1)).ravel()
    assert np.abs(balance).max() < 1e-13 * scale**2


def test_clipping_against_brute_force() -> None:
    """Area of every pair of facets against a fine sampling of the contactor: the slow twin. 400 x 400 samples miss an
    edge of length l by about l / 400."""
    contactor, target = grid("quad4", (1, 1)), grid("tri3", (1, 1), up=False)
    angle = 0.6
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    target = Surface((target.points - 0.5) @ turn.T + 0.5, target.kinds, target.nodes, target.cells, target.local)
    coupling = couple(contactor, target, 1)
    s = (np.arange(400) + 0.5) / 400
    sample = np.stack(np.meshgrid(s, s, indexing="ij"), axis=-1).reshape(-1, 2)
    back = (sample - 0.5) @ turn[:2, :2] + 0.5
    share = ((back > 0) & (back < 1)).all(axis=1).mean()
    assert coupling.covered.sum() == pytest.approx(share, abs=0.01)


@pytest.mark.parametrize("kind", ["line3", "tri6", "quad8", "quad9"])
def test_non_negative_bases(kind: str) -> None:
    """Partition of unity, non-negative on a fine lattice, and a basis (regular change of nodal values)."""
    cell = CELLS[kind]
    block = non_negative_block(kind, 0.125 if kind == "quad8" else 0.25)
    s = np.linspace(0, 1, 21) if cell.corners == 3 else np.linspace(-1, 1, 21)
    points = np.stack(np.meshgrid(*[s] * cell.dim, indexing="ij"), axis=-1).reshape(-1, cell.dim)
    if cell.corners == 3:
        points = points[points.sum(axis=1) <= 1 + 1e-12]
    values = shape_functions(cell.code, np.ascontiguousarray(points))[0] @ block
    assert values.min() > -1e-14
    assert values.sum(axis=1) == pytest.approx(1.0, abs=1e-14)
    assert np.linalg.cond(block) < 100


def test_dual_basis_is_biorthogonal() -> None:
    contactor = grid("quad4", (3, 3), distort=0.15)
    target = grid("quad4", (4, 4), distort=0.15, up=False)
    coupling = couple(contactor, target, 1, CouplingOptions(componentwise=True))
    space = pressure_space("dual", contactor, coupling)
    product = (space.transfer.T @ coupling.contactor_part).toarray()[:, : len(contactor.points)]
    assert product == pytest.approx(np.diag(product.diagonal()), abs=1e-13)
    assert product.diagonal() == pytest.approx(space.weight, abs=1e-13)


@given(st.floats(-10, 10), st.floats(-10, 10), st.sampled_from([1e-2, 1e-6, 1e-12]))
def test_constraint_function(g: float, p: float, epsilon: float) -> None:
    """Its zero is g p = eps, its limit min(g, p); derivatives against central differences."""
    w, by_g, by_p = constraint_function(np.array(g), np.array(p), epsilon)
    assert abs(w - min(g, p)) <= np.sqrt(epsilon) * (1 + 1e-9)
    assert 0.0 <= by_g <= 1.0
    assert by_g + by_p == pytest.approx(1.0)
    if epsilon == 1e-2:
        h = 1e-6
        slope = (
            constraint_function(g + h, np.array(p), epsilon)[0] - constraint_function(g - h, np.array(p), epsilon)[0]
        ) / (2 * h)
        assert slope == pytest.approx(float(by_g), abs=1e-7)
    if g > 0.1:
        zero, _, _ = constraint_function(np.array(g), np.array(epsilon / g), epsilon)
        assert abs(zero) < 1e-12 * max(g, 1)


@pytest.mark.parametrize("cell", BY_CODE, ids=lambda c: c.name)
def test_shape_functions(cell) -> None:
    """Partition of unity and derivatives against central differences (error h^2, h = 1e-5)."""
    xi = np.random.default_rng(2).uniform(0.05, 0.3, (5, cell.dim))
    values, slopes = shape_functions(cell.code, xi)
    assert values.sum(axis=1) == pytest.approx(1.0, abs=1e-14)
    for a in range(cell.dim):
        step = np.zeros(cell.dim)
        step[a] = 1e-5
        difference = (shape_functions(cell.code, xi + step)[0] - shape_functions(cell.code, xi - step)[0]) / 2e-5
        assert slopes[:, :, a] == pytest.approx(difference, abs=1e-9)


def test_quadratic_pressure_needs_quadratic_facets() -> None:
    with pytest.raises(InputError, match="needs quadratic facets"):
        resolve("P2", grid("quad4", (1, 1)))


@pytest.mark.parametrize(("kc", "kt"), [("tri3", "quad4"), ("quad8", "tri6"), ("quad9", "quad8")])
def test_sights_do_not_change_the_integrals(kc: str, kt: str) -> None:
    """Looking at corners first leaves every integral the same bit by bit; each segment has its middle and three corners at
    least, all within the target's plane a gap of 0.1 away."""
    contactor = grid(kc, (3, 4), distort=0.15, seed=1, bulge=in_plane)
    target = grid(kt, (4, 3), distort=0.15, up=False, seed=2, bulge=in_plane)
    target = replace(target, points=target.points + np.array([0.0, 0.0, 0.1]))
    plain, seen = (couple(contactor, target, 1, CouplingOptions(keep_gap_samples=sights)) for sights in (False, True))
    assert plain.gap_samples is None
    assert (plain.operator != seen.operator).nnz == 0
    np.testing.assert_array_equal(plain.gap, seen.gap)
    at = seen.gap_samples
    assert at is not None
    assert len(at.gap) >= 4 * seen.segments.sum()
    assert at.gap == pytest.approx(0.1, rel=1e-12)
    assert at.contactor_shapes.sum(axis=1) == pytest.approx(1.0, rel=1e-12)
    assert at.target_shapes.sum(axis=1) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("gap", [0.05, 0.6, -0.4])
@pytest.mark.parametrize("kind", FACETS_3D)
def test_nothing_in_sight_is_left_out(kind: str, gap: float) -> None:
    """Of a dome under (or over) a wider one, every facet is covered all over, though normals lean and the two lie a facet or
    more apart: candidates that are spared the cutting see nothing."""

    def dome(radius: float, width: float) -> Callable[[np.ndarray], np.ndarray]:
        def bulge(x: np.ndarray) -> np.ndarray:
            flat = width * radius * (x[:, :2] - 0.5)
            return np.column_stack([flat, np.sqrt(radius**2 - (flat**2).sum(axis=1))])

        return bulge

    contactor = grid(kind, (5, 4), bulge=dome(1.0, 0.8))
    target = grid(kind, (6, 7), up=False, bulge=dome(1.0 + gap, 1.3))
    covered = couple(contactor, target, 1, CouplingOptions(reach=2.0)).covered
    assert covered == pytest.approx(full_moments(contactor, 0)[:, 0], rel=1e-6)


@pytest.mark.parametrize("gap", [0.05, 0.6, -0.4])
@pytest.mark.parametrize("kind", FACETS_2D)
def test_nothing_in_sight_is_left_out_in_the_plane(kind: str, gap: float) -> None:
    def arch(radius: float, width: float) -> Callable[[np.ndarray], np.ndarray]:
        def bulge(x: np.ndarray) -> np.ndarray:
            angle = width * (x[:, 0] - 0.5)
            return radius * np.column_stack([np.sin(angle), np.cos(angle)])

        return bulge

    contactor = line(kind, 5, bulge=arch(1.0, 1.5))
    target = line(kind, 9, up=False, bulge=arch(1.0 + gap, 2.4))
    covered = couple(contactor, target, 1, CouplingOptions(reach=2.0)).covered
    assert covered == pytest.approx(full_moments(contactor, 0)[:, 0], rel=1e-9)
