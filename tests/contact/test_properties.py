"""What segments conserve, whatever the facets: areas, forces and moments; also where facets nearly coincide."""

from __future__ import annotations

import itertools
from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.cells import CELLS
from abut.contact.coupling import CouplingOptions, couple, surface_degree
from abut.contact.geometry import by_kind, full_moments, nodal_normals, turning_within
from abut.contact.quadrature import moment_tolerance
from abut.mesh.surface import Surface
from models.surfaces import FACETS_2D, FACETS_3D, FLAT, PAIRS, SHAPES, grid, line, moved, opposed, planar, side

Array = NDArray[np.float64]
every_pair = pytest.mark.parametrize(("kc", "kt"), PAIRS)
seeds = st.integers(0, 2**32 - 1)
flat_shapes = st.sampled_from(FLAT)
shapes = st.sampled_from(list(SHAPES))
ROUNDING = 1e-12  # sums of some thousand products of size one, on facets stretched by up to three


def areas(surface: Surface) -> Array:
    """The facets' own areas (2D: lengths); exact for flat facets."""
    return full_moments(surface, 0)[:, 0]


def area_vectors(surface: Surface) -> Array:
    """int n dS of every facet with its own continuous normal, by 12 x 12 Gauss points in reference coordinates."""
    t, w = np.polynomial.legendre.leggauss(12)
    total = np.zeros((len(surface), surface.dim))
    normals = nodal_normals(surface)
    for kind, facets in by_kind(surface):
        cell = CELLS[kind]
        xi, weight = t[:, None], w
        if cell.dim == 2:
            a, b = (g.ravel() for g in np.meshgrid(t, t, indexing="ij"))
            xi, weight = np.stack([a, b], axis=1), np.outer(w, w).ravel()
            if cell.corners == 3:
                r, s = 0.5 * (a + 1), 0.5 * (b + 1)
                xi, weight = np.stack([r * (1 - s), r * s], axis=1), 0.25 * weight * r
        values, slopes = shape_functions(cell.code, np.ascontiguousarray(xi))
        nodes = surface.nodes[facets, : cell.nodes]
        tangents = np.einsum("pna,fnd->fpad", slopes, surface.points[nodes])
        metric = np.einsum("fpad,fpbd->fpab", tangents, tangents)
        n = np.einsum("pn,fnd->fpd", values, normals[facets, : cell.nodes])
        n /= np.linalg.norm(n, axis=-1, keepdims=True)
        total[facets] = np.einsum("p,fp,fpd->fd", weight, np.sqrt(np.linalg.det(metric)), n)
    return total


def by_point(matrix: object, n: int, dim: int) -> Array:
    """A sparse part of a coupling as an array (rows, points, dim)."""
    return np.asarray(matrix.toarray()).reshape(n, -1, dim)


@every_pair
@settings(max_examples=5, deadline=None)
@given(seed=seeds, shape=shapes)
def test_covered_facets_keep_their_area(kc: str, kt: str, seed: int, shape: str) -> None:
    """Fully opposite a larger target every contactor facet is tiled without gap or overlap: its segments add up to its
    own area. Flat: to rounding, also where edges are curved in the plane. Arched: the area element has a square root,
    which the rule meets as it meets the facet's moments, theory (Q6); tri3 is flat."""
    contactor, target = opposed(kc, kt, seed, shape, size=2.2, shift=0.1)
    covered = couple(contactor, target, surface_degree(contactor)).covered
    tolerance = np.full(len(contactor), ROUNDING)
    if shape not in FLAT:
        tolerance = 10 * moment_tolerance(contactor.dim, turning_within(contactor, nodal_normals(contactor)))
    assert np.all(np.abs(covered / areas(contactor) - 1.0) <= tolerance)


@every_pair
@settings(max_examples=4, deadline=None)
@given(seed=seeds, shape=flat_shapes, other=st.integers(0, 4))
def test_two_half_targets_cover_the_sum(kc: str, kt: str, seed: int, shape: str, other: int) -> None:
    """A contactor across the joint of two targets, of two facet types, is covered by both together, facet by facet: a
    straight joint belongs to one of them or to the other, so that nothing is lost or counted twice, to rounding."""
    kinds = (kt, FACETS_3D[other]) if kt in FACETS_3D else (kt, ("line2", "line3")[other % 2])
    contactor = side(kc, 2, shape, up=True, seed=seed)
    place = planar(contactor.dim, seed, size=1.0, shift=0.2)
    degree = surface_degree(contactor)
    covered = np.zeros(len(contactor))
    for half, kind in enumerate(kinds):

        def stretch(x: Array, half: int = half) -> Array:
            """The unit interval or square to one half of (-1.5, 2.5) x (-1.5, 2.5)."""
            y = 4.0 * x - 1.5 * (np.arange(x.shape[1]) < x.shape[1] - 1)
            y[:, 0] = 0.5 + 2.0 * (x[:, 0] - 1.0 + half)
            return place(y)

        target = moved(side(kind, 3, shape, up=False, seed=seed + half), stretch)
        covered += couple(contactor, target, degree).covered
    assert covered / areas(contactor) == pytest.approx(1.0, abs=ROUNDING)


@every_pair
@settings(max_examples=4, deadline=None)
@given(seed=seeds, shape=flat_shapes)
def test_overlap_is_the_same_from_either_side(kc: str, kt: str, seed: int, shape: str) -> None:
    """Seen from either side, two flat surfaces overlap in the same area, also where they overhang. The curves' chords
    decide which facets meet, so that single pairs may differ; the sums over the surfaces do not, except at the rim,
    which is straight here."""
    contactor, target = opposed(kc, kt, seed, shape, size=1.2, shift=0.6)
    one = couple(contactor, target, surface_degree(contactor)).covered.sum()
    two = couple(target, contactor, surface_degree(target)).covered.sum()
    assert one == pytest.approx(two, abs=ROUNDING)


@every_pair
@settings(max_examples=4, deadline=None)
@given(seed=seeds, shape=shapes, degree=st.integers(0, 2), gap=st.sampled_from([0.0, 0.04, -0.02]))
def test_partition_of_unity(kc: str, kt: str, seed: int, shape: str, degree: int, gap: float) -> None:
    """Pressure functions add up to one and so do shape functions. Hence a constant displacement changes no gap, for each
    pressure function; a unit pressure on a facet has the facet's area vector as resultant (N = -n), on both sides; and
    the weights add up to the covered area. The sums are to rounding. The area vector is met to rounding where n is
    constant; arched facets are given the points that their moments need, which leaves 1e-4 for the curving normal."""
    contactor, target = opposed(kc, kt, seed, shape, size=2.2, shift=0.1, gap=gap)
    degree = min(degree, surface_degree(contactor))
    coupling = couple(contactor, target, degree)
    n, area = 9 * len(contactor), areas(contactor)
    assert np.abs(by_point(coupling.operator, n, contactor.dim).sum(axis=1)).max() < ROUNDING * area.max()
    assert coupling.weight.reshape(-1, 9).sum(axis=1) == pytest.approx(coupling.covered, rel=ROUNDING)
    exact = -area_vectors(contactor)
    for part in (coupling.contactor_part, coupling.target_part):
        resultant = by_point(part, n, contactor.dim).sum(axis=1).reshape(-1, 9, contactor.dim).sum(axis=1)
        assert np.abs(resultant - exact).max() < (ROUNDING if shape in FLAT else 1e-4) * area.max()


def moment(points: Array, force: Array) -> Array:
    """Moment about the origin, 3 components (2D: the last)."""
    pad = np.zeros((len(points), 3 - points.shape[1]))
    return np.cross(np.hstack([points, pad]), np.hstack([force, pad])).sum(axis=0)


@every_pair
@settings(max_examples=4, deadline=None)
@given(seed=seeds, shape=shapes, size=st.sampled_from([0.7, 1.2, 2.2]), gap=st.sampled_from([0.0, 0.04, -0.02]))
def test_action_is_reaction(kc: str, kt: str, seed: int, shape: str, size: float, gap: float) -> None:
    """Whatever the pressure, the forces on both sides balance. So do their moments, for any gap: with isoparametric
    facets the nodal forces have the moment of p N at x_C and at x_T = x_C - g N, on one line of action. To rounding,
    and to the tolerance of looking along the normal, whose last step is quadratically small."""
    contactor, target = opposed(kc, kt, seed, shape, size=size, shift=0.3, gap=gap)
    coupling = couple(contactor, target, surface_degree(contactor))
    pressure = np.random.default_rng(seed).normal(size=9 * len(contactor))
    own = (coupling.contactor_part.T @ pressure).reshape(-1, contactor.dim)
    other = (coupling.target_part.T @ pressure).reshape(-1, contactor.dim)
    points = np.concatenate([contactor.points, target.points])
    size = np.abs(own).sum()
    assert np.abs(own.sum(axis=0) - other.sum(axis=0)).max() < ROUNDING * size
    assert np.abs(moment(points, own) - moment(points, other)).max() < ROUNDING * size


@every_pair
@settings(max_examples=3, deadline=None)
@given(seed=seeds, shape=flat_shapes, gap=st.sampled_from([0.0, 0.04, -0.02]))
def test_tied_tractions_turn_by_the_gap(kc: str, kt: str, seed: int, shape: str, gap: float) -> None:
    """Tied surfaces carry traction along the surface too. Across a gap it acts along two lines: the moments differ by
    int (x_C - x_T) x t = N x (sum of weighted gap times t), here with one N. To rounding."""
    contactor, target = opposed(kc, kt, seed, shape, size=1.2, shift=0.3, gap=gap)
    coupling = couple(contactor, target, surface_degree(contactor), CouplingOptions(componentwise=True))
    traction = np.random.default_rng(seed).normal(size=(9 * len(contactor), contactor.dim))
    points = np.concatenate([contactor.points, target.points])
    own, other = coupling.contactor_part.T @ traction, coupling.target_part.T @ traction
    towards = np.zeros(contactor.dim)
    towards[-1] = -1.0
    turning = moment(towards[None], (coupling.gap @ traction)[None])
    size = np.abs(own).sum()
    assert np.abs(own.sum(axis=0) - other.sum(axis=0)).max() < ROUNDING * size
    assert np.abs(moment(points, own) - moment(points, other) - turning).max() < ROUNDING * size


SHIFTS = [0.0, *(sign * 10.0**-k for k in (9, 11, 13, 14, 15) for sign in (1, -1))]


@pytest.mark.parametrize("direction", [(1, 0), (0, 1), (1, 1), (1, -1)])
@pytest.mark.parametrize(("kc", "kt"), list(itertools.product(FACETS_3D, FACETS_3D)))
def test_nearly_coinciding_grids(kc: str, kt: str, direction: tuple[int, int]) -> None:
    """Nodes of one side on nodes and edges of the other (2 x 2 facets on 4 x 4), or off them by 1e-9 to 1e-15 of a
    facet: the overlap of the two unit squares is (1 - |dx|)(1 - |dy|), less what lies nearer to the line of an edge than
    1e-12 of its length, which counts as on it, and no sliver upsets the balance of forces."""
    contactor = grid(kc, (2, 2))
    for shift in SHIFTS:
        d = 0.25 * shift * np.array([*direction, 0.0])
        coupling = couple(contactor, moved(grid(kt, (4, 4), up=False), lambda x: x + d), surface_degree(contactor))  # noqa: B023
        assert coupling.covered.sum() == pytest.approx((1 - abs(d[0])) * (1 - abs(d[1])), abs=1e-12)
        balance = by_point(coupling.operator, 9 * len(contactor), 3).sum(axis=1)
        assert np.abs(balance).max() < 1e-14


@pytest.mark.parametrize("kind", FACETS_3D)
@pytest.mark.parametrize("shift", SHIFTS)
def test_corners_on_edges(kind: str, shift: float) -> None:
    """A square target turned by 45 degrees whose corners lie on the middle of the contactor's sides, or off them by 1e-9
    to 1e-15: half the area. A larger one whose sides run through the contactor's corners covers all of it. The shift
    moves the area by as much at most."""
    contactor = grid(kind, (2, 2))
    middle = np.array([0.5, 0.5, 0.0])
    turn = np.array([[1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    for size, exact in ((0.5, 0.5), (1.0, 1.0)):
        for other in FACETS_3D:
            target = moved(
                grid(other, (2, 2), up=False),
                lambda x, size=size: middle + size * (x - middle) @ turn.T + np.array([shift, shift / 3, 0.0]),
            )
            coupling = couple(contactor, target, surface_degree(contactor))
            assert coupling.covered.sum() == pytest.approx(exact, abs=2 * abs(shift) + 1e-14)
            assert np.abs(by_point(coupling.operator, 9 * len(contactor), 3).sum(axis=1)).max() < 1e-14


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-6, 1e-3, 0.3, 0.5 * np.pi])
@pytest.mark.parametrize(("kc", "kt"), list(itertools.product(FACETS_3D, FACETS_3D)))
def test_needles(kc: str, kt: str, angle: float) -> None:
    """Strips of width 1e-3 and length 1, cut into facets of that length, crossing at their middle, against the area from
    half planes. Rounding of the coordinates is 1e-16 of the length, hence 1e-13 of the width, and moves a crossing of
    sides by as much over the sine of their angle, at which the strips are as much closer to each other: 1e-11."""
    width = 1e-3

    def narrow(x: Array, turn: float) -> Array:
        y = (x - [0.5, 0.5, 0.0]) * [1.0, width, 1.0]
        c, s = np.cos(turn), np.sin(turn)
        return y @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])

    contactor = moved(grid(kc, (1, 2)), lambda x: narrow(x, 0.0))
    target = moved(grid(kt, (1, 3), up=False), lambda x: narrow(x, angle))
    coupling = couple(contactor, target, surface_degree(contactor))
    exact = crossing(width, angle)
    assert coupling.covered.sum() == pytest.approx(exact, rel=1e-11)
    assert np.abs(by_point(coupling.operator, 9 * len(contactor), 3).sum(axis=1)).max() < 1e-14 * width


def crossing(width: float, angle: float) -> float:
    """Area that two rectangles 1 x width, turned by angle about their common middle, share: by half planes."""
    polygon = 0.5 * np.array([[-1, -width], [1, -width], [1, width], [-1, width]])
    c, s = np.cos(angle), np.sin(angle)
    for normal, bound in (((c, s), 0.5), ((-c, -s), 0.5), ((-s, c), 0.5 * width), ((s, -c), 0.5 * width)):
        inside = bound - polygon @ np.array(normal)
        kept = []
        for p, q, a, b in zip(polygon, np.roll(polygon, -1, axis=0), inside, np.roll(inside, -1)):
            if a >= 0:
                kept.append(p)
            if a * b < 0:
                kept.append(p + a / (a - b) * (q - p))
        polygon = np.array(kept)
    x, y = polygon.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


@pytest.mark.parametrize(("kc", "kt"), list(itertools.product(FACETS_2D, FACETS_2D)))
@pytest.mark.parametrize("gap", [0.0, 0.05])
def test_nearly_coinciding_lines(kc: str, kt: str, gap: float) -> None:
    """The same in 2D, with ends on ends or off them by little, and facets a thousandth of their neighbours' length:
    the overlap is 1 - |d|. Parts shorter than 1e-14 of a facet are left out."""
    for shift, middle in itertools.product(SHIFTS, (0.5, 1e-3)):
        place = np.array([0.25 * shift, gap])
        uneven = partial(np.interp, xp=[0.0, 0.5, 1.0], fp=[0.0, middle, 1.0])
        contactor = line(kc, 2, bulge=lambda x: np.column_stack([uneven(x[:, 0]), x[:, 1]]))  # noqa: B023
        coupling = couple(contactor, moved(line(kt, 4, up=False), lambda x: x + place), surface_degree(contactor))  # noqa: B023
        assert coupling.covered.sum() == pytest.approx(1 - abs(place[0]), abs=3e-14)
        assert np.abs(by_point(coupling.operator, 9 * len(contactor), 2).sum(axis=1)).max() < 1e-14
        assert coupling.gap.sum() == pytest.approx(gap * coupling.covered.sum(), abs=1e-14)
