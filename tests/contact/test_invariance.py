"""What must not matter to segments: position, units, numbering, and which side is the contactor."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import abut
from abut.cells import BY_CODE, CELLS
from abut.contact.coupling import Coupling, CouplingOptions, couple, surface_degree
from abut.contact.geometry import full_moments
from abut.mesh.make import box, join, rectangle
from abut.mesh.surface import Surface
from models.surfaces import FACETS_2D, FACETS_3D, FLAT, PAIRS, SHAPES, moved, opposed, side, turned

Array = NDArray[np.float64]
every_pair = pytest.mark.parametrize(("kc", "kt"), PAIRS)
seeds = st.integers(0, 2**32 - 1)
shapes = st.sampled_from(list(SHAPES))
gaps = st.sampled_from([0.0, 0.04, -0.02])
ROUNDING = 1e-12


def differ(one: Coupling, two: Coupling) -> float:
    """Largest difference of two couplings with the same rows and columns, in facets' areas."""
    area = one.covered.max()
    parts = [(one.covered, two.covered), (one.weight, two.weight), (one.gap, two.gap), (one.mass, two.mass)]
    parts += [(getattr(one, n).toarray(), getattr(two, n).toarray()) for n in ("contactor_part", "target_part")]
    return max(float(np.abs(a - b).max()) for a, b in parts) / area


def transformed(coupling: Coupling, matrix: Array | None = None, area: float = 1.0, length: float = 1.0) -> Coupling:
    """The coupling as it should be after a rotation of space by ``matrix`` and a change of units."""

    def part(values: object) -> object:
        if matrix is None:
            return values * area
        turned_rows = values.toarray().reshape(values.shape[0], -1, len(matrix)) @ matrix.T
        return type(values)(turned_rows.reshape(values.shape))

    return replace(
        coupling,
        contactor_part=part(coupling.contactor_part),
        target_part=part(coupling.target_part),
        gap=coupling.gap * area * length,
        weight=coupling.weight * area,
        mass=coupling.mass * area,
        covered=coupling.covered * area,
    )


@every_pair
@settings(max_examples=4, deadline=None)
@given(seed=seeds, shape=shapes, gap=gaps)
def test_rigid_motion(kc: str, kt: str, seed: int, shape: str, gap: float) -> None:
    """Turned and shifted together, the surfaces keep areas, weights and gaps, and the normals turn along. The points of
    the rule are the same material points: to rounding of coordinates that are ten times the facets."""
    contactor, target = opposed(kc, kt, seed, shape, size=1.4, shift=0.4, gap=gap)
    rng = np.random.default_rng(seed)
    turn, shift = turned(contactor.dim, rng), rng.uniform(-5, 5, contactor.dim)
    degree = surface_degree(contactor)
    before = couple(contactor, target, degree)
    after = couple(*(moved(s, lambda x: x @ turn.T + shift) for s in (contactor, target)), degree)
    assert differ(transformed(before, turn), after) < ROUNDING


@every_pair
@settings(max_examples=3, deadline=None)
@given(seed=seeds, shape=shapes, gap=gaps)
def test_units(kc: str, kt: str, seed: int, shape: str, gap: float) -> None:
    """Areas go with the square of the length (2D: with the length), gaps with the length: bit by bit for powers of two,
    so that no absolute tolerance hides anywhere; to rounding for metres to nanometres or millimetres."""
    contactor, target = opposed(kc, kt, seed, shape, size=1.4, shift=0.4, gap=gap)
    degree = surface_degree(contactor)
    before = couple(contactor, target, degree)
    for unit, tolerance in ((2.0**-30, 0.0), (2.0**10, 0.0), (1e-9, ROUNDING), (1e3, ROUNDING)):
        after = couple(*(moved(s, lambda x: unit * x) for s in (contactor, target)), degree)  # noqa: B023
        area = unit ** (contactor.dim - 1)
        assert differ(transformed(before, area=area, length=unit), after) <= tolerance


def local_order(kind: str, first: int, flip: bool) -> NDArray[np.int64]:
    """A facet's nodes counted from another corner, or (``flip``) the other way round, so that its normal changes side."""
    cell = CELLS[kind]
    if cell.dim == 1:
        return np.array([1, 0, 2] if flip else [0, 1, 2])[: cell.nodes]
    n = cell.corners
    corners = (first + np.arange(n)) % n
    edges = n + corners
    if flip:
        corners = corners[::-1]
        edges = n + (corners - 1) % n
    return np.concatenate([corners, edges, [8]])[: cell.nodes]


def renumbered(
    surface: Surface, rng: np.random.Generator, flip: bool = False
) -> tuple[Surface, NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Points, facets and each facet's nodes in another order; the old numbers of points, rows 9 f + k and facets."""
    points, facets = rng.permutation(len(surface.points)), rng.permutation(len(surface))
    number = np.argsort(points)
    nodes = np.full_like(surface.nodes, -1)
    rows = np.tile(np.arange(9), (len(surface), 1)) + 9 * facets[:, None]
    for i, f in enumerate(facets):
        local = local_order(BY_CODE[surface.kinds[f]].name, int(rng.integers(4)), flip)
        nodes[i, : len(local)] = number[surface.nodes[f, local]]
        rows[i, : len(local)] = 9 * f + local
    other = replace(surface, points=surface.points[points], kinds=surface.kinds[facets], nodes=nodes)
    return other, points, rows.ravel(), facets


def columns(points: NDArray[np.int64], dim: int, first: int = 0) -> NDArray[np.int64]:
    return (dim * (first + points)[:, None] + np.arange(dim)).ravel()


def points_for(shape: str) -> int | str:
    """Segments are fans from a vertex that depends on the numbering: equal only as far as the rule is exact. "auto"
    leaves 1e-11 of flat facets; of arched linear triangles, whose normals it does not count, 1e-3. Nine points leave
    less than 1e-10 of both."""
    return "auto" if shape in FLAT else 9


@every_pair
@settings(max_examples=4, deadline=None)
@given(seed=seeds, shape=shapes, gap=gaps)
def test_numbering(kc: str, kt: str, seed: int, shape: str, gap: float) -> None:
    """Other numbers of points and facets, and another first corner of each facet, permute the results and no more. Areas
    to rounding; the rest to the rule's accuracy, see ``points_for``."""
    contactor, target = opposed(kc, kt, seed, shape, size=1.4, shift=0.4, gap=gap)
    rng, dim = np.random.default_rng(seed), contactor.dim
    degree = surface_degree(contactor)
    before = couple(contactor, target, degree, CouplingOptions(points=points_for(shape)))
    contactor, mine, rows, facets = renumbered(contactor, rng)
    target, theirs, _, _ = renumbered(target, rng)
    after = couple(contactor, target, degree, CouplingOptions(points=points_for(shape)))
    column = np.concatenate([columns(mine, dim), columns(theirs, dim, len(mine))])
    local = (rows % 9).reshape(-1, 9)
    expected = replace(
        before,
        contactor_part=before.contactor_part.tocsr()[rows][:, column],
        target_part=before.target_part.tocsr()[rows][:, column],
        gap=before.gap[rows],
        weight=before.weight[rows],
        mass=np.stack([before.mass[f][np.ix_(k, k)] for f, k in zip(facets, local)]),
        covered=before.covered[facets],
    )
    assert after.covered == pytest.approx(expected.covered, abs=ROUNDING)
    assert differ(expected, after) < 1e-9


@pytest.mark.parametrize("kind", [*FACETS_3D, *FACETS_2D])
@settings(max_examples=12, deadline=None)
@given(seed=seeds, shape=shapes, gap=gaps)
def test_matching_sides_change_places(kind: str, seed: int, shape: str, gap: float) -> None:
    """With the same facets on both sides, numbered differently, int H_k N_j N is the same from either side, N apart,
    which turns round: target_part of one coupling is minus contactor_part of the other. Every edge and node lies on one
    of the other side, and slivers between neighbours must not count. Arched ones without a gap (with it, the normals of
    the two sides do not meet the same points). Accuracy as for another numbering."""
    contactor = side(kind, 2, shape, up=True, seed=seed)
    target, _, rows, facets = renumbered(contactor, np.random.default_rng(seed), flip=True)
    if shape in FLAT:
        target = moved(target, lambda x: x + gap * np.eye(contactor.dim)[-1])
    degree, n = surface_degree(contactor), contactor.points.size
    one = couple(contactor, target, degree, CouplingOptions(points=points_for(shape)))
    two = couple(target, contactor, degree, CouplingOptions(points=points_for(shape)))
    area = full_moments(contactor, 0)[:, 0]
    assert one.covered == pytest.approx(area, abs=1e-11 * area.max())
    assert two.covered == pytest.approx(area[facets], abs=1e-11 * area.max())
    assert np.abs(one.gap[rows] - two.gap).max() < 1e-9 * area.max()
    for mine, theirs, part in (("contactor", "target", slice(n)), ("target", "contactor", slice(n, None))):
        a = getattr(one, f"{mine}_part").toarray()[rows][:, part]
        b = getattr(two, f"{theirs}_part").toarray()
        b = b[:, n:] if mine == "contactor" else b[:, :n]
        # Inverse maps of quadrilaterals are no polynomials: they are integrated to theory (Q6), from either side.
        assert np.abs(a + b).max() < 5e-9 * area.max()


@pytest.mark.parametrize("cell", ["tri3", "quad4", "quad8", "quad9", "tet4", "hex8", "hex20"])
def test_same_pressure_whichever_side_carries_it(cell: str) -> None:
    """Two equal blocks with matching meshes, pressed together unevenly: the conditions are the same from either side, and
    with them pressure and displacement, to the accuracy of the solution (1e-10 of the largest)."""
    flat = cell in ("tri3", "quad4", "quad8", "quad9")
    make, span, n = (rectangle, [(0, 1)], (4, 3)) if flat else (box, [(0, 1), (0, 1)], (2, 3, 2))
    mesh = join({name: make(*span, up, n, cell) for name, up in (("lower", (0, 1)), ("upper", (1, 2)))})
    ends, across = ("lower.bottom", "upper.top"), {"x": 0.0} if flat else {"x": 0.0, "y": 0.0}
    found = []
    for pair in (("lower.top", "upper.bottom"), ("upper.bottom", "lower.top")):
        model = abut.Model(
            mesh,
            [abut.Solid(body, abut.LinearElastic(1.0, 0.3)) for body in ("lower", "upper")],
            [abut.Support("lower.bottom", normal=0.0), *(abut.Support(on, **across) for on in ends)],
            [abut.Pressure("upper.top", 1e-3), abut.Pressure("upper.right", 5e-4)],
            [abut.Contact(contactor=pair[0], target=pair[1])],
            plane="strain" if flat else None,
        )
        solution = abut.solve(model)
        assert solution.converged
        result = solution.contacts[0]
        nodes = result.contactor.nodes
        at = result.contactor.points[nodes[nodes >= 0]].round(9)
        order = np.lexsort(at.T)
        found.append((at[order], result.pressure[nodes >= 0][order], solution.displacement))
    (where, p, u), (there, q, v) = found
    assert where == pytest.approx(there)
    assert np.ptp(p) > 0.1 * p.max()
    assert q == pytest.approx(p, abs=1e-10 * p.max())
    assert v == pytest.approx(u, abs=1e-10 * np.abs(u).max())
