"""Derivatives of the coupling against differences of ``couple`` itself, and what balance and rigid motions ask of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

from abut.cells import CELLS
from abut.contact.block_rows import block_rows
from abut.contact.coupling import Coupling, CouplingOptions, Plan, couple, plan_pair, point_columns
from abut.contact.coupling_tangent import CouplingTangent, coupling_tangent
from abut.contact.geometry import OnPlanes, Smoothing, by_kind, facet_sizes, nodal_normals, smoothing
from abut.contact.moving_normals import normal_pattern
from abut.contact.slip_points import SlipNow, SlipPoints, slip_now
from abut.errors import InputError
from abut.mesh.surface import Surface
from abut.types import Array, Sparse
from models.lever import couples
from models.sheets import chain, sheet, together, turn

LINES = ("line2", "line3")
FACES = ("tri3", "tri6", "quad4", "quad8", "quad9")
# Enough points that what the derivative of a rule leaves out is rounding; the number must not change between states.
FIXED = CouplingOptions(points=8)
STEP = 2e-6  # rounding of a difference is about 1e-10 with it, its error of order four nothing
TOLERANCE = 1e-7
SEEN_THROUGH = 1e-9  # rays and projections are found to 1e-12 of the reference domain, magnified by slopes


def lines(kinds: tuple[str, str], axisymmetric: bool = False) -> tuple[Surface, Surface]:
    """An arc on a bent line that ends under it, not matching, both distorted."""
    at = 2.0 if axisymmetric else 0.0
    arc = chain(kinds[0], 5, lambda s: [at + np.sin(1.1 * s - 0.5), 1 - np.cos(1.1 * s - 0.5)], 0.1, 1, axisymmetric)
    under = chain(kinds[1], 7, lambda s: [at - 0.35 + 0.75 * s, 0.1 * s**2 - 0.05], 0.1, 2, axisymmetric)
    return arc, turn(under)


def faces(kinds: tuple[str, str], offset: float = 0.25) -> tuple[Surface, Surface]:
    """A bowl on a bent sheet from which it hangs over, not matching, both distorted."""
    noise = {kind: 0.2 if kind in ("tri3", "quad4") else 0.06 for kind in kinds}
    bowl = sheet(
        kinds[0],
        2,
        lambda s, t: [s, t, 0.3 * ((s - 0.5) ** 2 + 0.7 * (t - 0.4) ** 2 + 0.3 * s * t)],
        noise[kinds[0]],
        1,
    )
    under = sheet(
        kinds[1],
        2,
        lambda s, t: [offset - 0.1 + 1.1 * s, 1.05 * t - 0.13, 0.06 * (s - 0.2) ** 2 + 0.03 * t - 0.05],
        noise[kinds[1]],
        2,
    )
    return turn(bowl), under


def load(contactor: Surface, seed: int = 3) -> tuple[Array, Array]:
    rng = np.random.default_rng(seed)
    n = 9 * len(contactor)
    return rng.uniform(0.5, 1.0, n), rng.uniform(-1.0, 1.0, (n, contactor.dim))


def force(coupling: Coupling, sides: tuple[Surface, Surface], pressure: Array, traction: Array) -> Array:
    """Sum over the integration points of couple: p N + (I - N N) t, times N_C - N_T, and what takes up the couple."""
    points, contactor = coupling.points, sides[0]
    assert points is not None
    x = np.concatenate([side.points for side in sides])
    n, t = points.normal, points.pressure @ traction
    value = (points.pressure @ pressure)[:, None] * n + t - n * (t * n).sum(axis=1, keepdims=True)
    dim = n.shape[1]
    entries = points.gap_operator.tocoo()
    shape = entries.data * n[entries.row, entries.col % dim]  # summed over the components: shape functions
    result = np.zeros((len(x), dim))
    np.add.at(result, entries.col // dim, shape[:, None] * (points.weight[:, None] * value)[entries.row])
    result[: len(contactor.points)] += couples(contactor, points, t, points.gap_operator @ x.ravel())
    return result.ravel()


Values = tuple[Array, Array, Array]


def values(
    pair: tuple[Surface, Surface],
    move: Array,
    degree: int,
    across: Smoothing,
    options: CouplingOptions = FIXED,
) -> Values:
    """Gap, weight and force with the points moved."""
    contactor, target = pair
    n = len(contactor.points)
    moved = (
        replace(contactor, points=contactor.points + move[:n]),
        replace(target, points=target.points + move[n:]),
    )
    result = couple(*moved, degree, replace(options, keep_points=True), across=across)
    return result.gap, result.weight, force(result, moved, *load(contactor))


def error(
    pair: tuple[Surface, Surface],
    degree: int = 1,
    options: CouplingOptions = FIXED,
    step: float = STEP,
    seed: int = 5,
    across: Smoothing | None = None,
) -> float:
    """Largest difference between derivatives and differences along one direction, relative."""
    contactor, target = pair
    across = across or smoothing(contactor)
    tangent = coupling_tangent(contactor, target, degree, options, *load(contactor), across=across)
    size = len(contactor.points) + len(target.points), contactor.dim
    way = np.random.default_rng(seed).uniform(-1.0, 1.0, size)
    here = values(pair, np.zeros(size), degree, across, options)
    assert np.abs(tangent.force - here[2]).max() < 1e-12 * np.abs(here[2]).max()
    far = [values(pair, k * step * way, degree, across, options) for k in (-2, -1, 1, 2)]
    found = []
    for k, matrix in enumerate((tangent.gap, tangent.weight, tangent.force_tangent)):
        expected = (far[0][k] - 8 * far[1][k] + 8 * far[2][k] - far[3][k]) / (12 * step)
        assert np.abs(expected).max() > 0
        found.append(np.abs(matrix @ way.ravel() - expected).max() / np.abs(expected).max())
    return float(max(found))


@pytest.mark.parametrize("axisymmetric", [False, True])
@pytest.mark.parametrize("target", LINES)
@pytest.mark.parametrize("contactor", LINES)
def test_lines(contactor: str, target: str, axisymmetric: bool) -> None:
    pair = lines((contactor, target), axisymmetric)
    assert max(error(pair, degree) for degree in (0, 1, 2)) < TOLERANCE


@pytest.mark.long
@pytest.mark.parametrize("target", FACES)
@pytest.mark.parametrize("contactor", FACES)
def test_faces(contactor: str, target: str) -> None:
    assert error(faces((contactor, target)), degree=2) < TOLERANCE


def bulged(surface: Surface, seed: int) -> Surface:
    """With bulges of a tenth of a facet: coefficients of the middle nodes."""
    size = 0.1 * facet_sizes(surface).mean()
    bulge = np.zeros((len(surface), 9))
    for kind, facets in by_kind(surface):
        corners = CELLS[kind].corners
        middles = slice(corners, corners + (1 if surface.dim == 2 else corners))
        shape = bulge[facets, middles].shape
        bulge[facets, middles] = np.random.default_rng(seed).uniform(0.3, 1.0, shape) * size
    return replace(surface, bulge=bulge)


@pytest.mark.long
@pytest.mark.parametrize(
    "pair", [*(lines((a, b)) for a in LINES for b in LINES), *(faces((a, b)) for a in FACES for b in FACES)]
)
def test_bulges(pair: tuple[Surface, Surface]) -> None:
    """They change the gap alone: forces, weights and what takes up couples stay those of the facets."""
    flat, bulgy = pair, (bulged(pair[0], 8), bulged(pair[1], 9))
    assert error(bulgy, seed=7) < TOLERANCE
    seen = [couple(*each, 1, replace(FIXED, keep_points=True)) for each in (flat, bulgy)]
    assert abs(seen[0].operator - seen[1].operator).max() == 0.0
    assert (seen[1].gap <= seen[0].gap).all()
    assert (seen[1].gap < seen[0].gap).any()


def mirrored(contactor: Surface) -> Smoothing:
    """Normals in the plane square to x at the points with the smallest x, as at a plane of symmetry."""
    across, used = smoothing(contactor), contactor.nodes >= 0
    x = contactor.points[contactor.nodes[used], 0]
    visits = np.flatnonzero(x < np.quantile(x, 0.2))
    inside = np.diag([0.0, 1.0, 1.0][: contactor.dim])
    return replace(across, planes=OnPlanes(visits, np.broadcast_to(inside, (len(visits), *inside.shape))))


@pytest.mark.parametrize(
    "pair",
    [*(lines((a, b)) for a in LINES for b in LINES), *(faces((a, "tri3")) for a in FACES), faces(("tri3", "quad4"))],
)
def test_planes_of_symmetry(pair: tuple[Surface, Surface]) -> None:
    """Normals that stay in a plane make another coupling, of which the derivative is as exact."""
    across = mirrored(pair[0])
    assert error(pair, across=across) < TOLERANCE
    plain, now = (couple(*pair, 1, FIXED, across=each) for each in (smoothing(pair[0]), across))
    assert np.abs(now.gap - plain.gap).max() > 1e-3 * np.abs(plain.gap).max()


@pytest.mark.long
@pytest.mark.parametrize("degree", [0, 1])
def test_pressures_of_lower_degree(degree: int) -> None:
    assert error(faces(("quad8", "tri6")), degree) < TOLERANCE


def test_facets_of_both_shapes() -> None:
    upper = together(faces(("quad4", "tri3"))[0], turn(sheet("tri3", 1, lambda s, t: [1.0 + s, t, 0.1 * s])))
    assert error((upper, together(faces(("quad4", "tri6"))[1], faces(("quad4", "quad8"), -0.9)[1]))) < TOLERANCE


@pytest.mark.parametrize("kind", LINES)
def test_hidden_lines(kind: str) -> None:
    upper = chain(kind, 4, lambda s: [s, 0.03 * s**2], 0.1, 1)
    near = chain(kind, 3, lambda s: [0.5 * s - 0.1, 0.02 * s - 0.1], 0.1, 2)
    far = chain(kind, 5, lambda s: [1.3 * s - 0.1, -0.3 - 0.05 * s**2], 0.1, 3)
    pair = upper, turn(together(near, far))
    assert error(pair, options=replace(FIXED, reach=1.0)) < TOLERANCE


@pytest.mark.long
@pytest.mark.parametrize(("contactor", "target"), [("quad4", "quad4"), ("tri3", "quad8"), ("tri6", "quad9")])
def test_hidden_faces(contactor: str, target: str) -> None:
    upper, far = faces((contactor, target), 0.0)
    near = sheet(target, 1, lambda s, t: [0.13 + 0.5 * s, 0.17 + 0.45 * t, 0.03 * s - 0.02], 0.05, 3)
    pair = upper, together(near, replace(far, points=far.points - [0.0, 0.0, 0.3]))
    assert error(pair, options=replace(FIXED, reach=1.0)) < TOLERANCE


def test_straight_edges_with_their_middle_off_the_middle() -> None:
    """On a ball edges in planes of symmetry are straight in the mean plane, until they move."""

    def ball(s: Array, t: Array) -> list[Array]:
        a, b = 1.4 * (s - 0.5), 1.4 * (t - 0.5)
        return [np.sin(a), np.sin(b), 1 - np.cos(a) * np.cos(b)]

    plane = sheet("quad4", 5, lambda s, t: [2 * s - 1.03, 2 * t - 1.02, 0 * s - 0.02], 0.1, 3)
    assert error((turn(sheet("quad8", 3, ball)), plane)) < TOLERANCE


@pytest.mark.parametrize("kinds", [("quad4", "quad4"), ("tri6", "quad8")])
def test_newton_cotes(kinds: tuple[str, str]) -> None:
    assert error(faces(kinds), options=CouplingOptions(rule="newton-cotes", points=5)) < TOLERANCE


def test_a_collapsed_target_facet() -> None:
    contactor, target = faces(("quad4", "quad4"))
    nodes = target.nodes.copy()
    nodes[0, 3] = nodes[0, 2]
    assert error((contactor, replace(target, nodes=nodes))) < TOLERANCE


@pytest.mark.parametrize("curve", [0.0, 0.3])
@pytest.mark.parametrize("kind", LINES + FACES)
def test_matching_meshes(kind: str, curve: float) -> None:
    """All cuts fall on edges. Second derivatives jump there, so differences err by their step, 1e-7, times what slopes
    jump by over facets of 1/4."""
    if kind in LINES:
        target = turn(chain(kind, 4, lambda s: [s, curve * s**2]))
        keep = np.array([False, True, True, False])
    else:
        target = sheet(kind, 4, lambda s, t: [s, t, curve * (s**2 + 0.7 * t**2 + 0.3 * s * t)])
        middle = np.array([target.points[nodes[nodes >= 0]].mean(axis=0)[:2] for nodes in target.nodes])
        keep = np.all(np.abs(middle - 0.5) < 0.25, axis=1)
    assert error((turn(target.part(keep)), replace(target, points=target.points.copy())), step=1e-7) < 1e-5


@pytest.mark.parametrize("kinds", [("line3", "line2"), ("quad8", "quad4"), ("tri6", "quad9")])
def test_values_beside_derivatives(kinds: tuple[str, str]) -> None:
    """What the derivatives come with is what ``couple`` integrates, and the rows of slips are those of its points."""
    pair = lines(kinds) if kinds[0] in LINES else faces(kinds)
    options, (pressure, traction) = CouplingOptions(keep_points=True), load(pair[0])
    tangent = coupling_tangent(*pair, 1, options, pressure, traction)
    coupling = couple(*pair, 1, options)
    dim, n_points = pair[0].dim, point_columns(*pair)[1]
    value, *places = tangent.operators
    size = np.abs(coupling.operator).max()
    assert np.abs(block_rows((value[..., :dim], *places), n_points) - coupling.operator).max() < 1e-12 * size
    assert np.abs(tangent.gap_value - coupling.gap).max() < 1e-12 * np.abs(coupling.gap).max()
    assert np.abs(tangent.weight_value - coupling.weight).max() < 1e-12 * coupling.weight.max()
    if dim == 3:
        square = block_rows((value[..., dim:].reshape(-1, dim, dim), *places), n_points).tocsr()
        pressed = block_rows((value[..., :dim], *places), n_points).T @ pressure
        assert np.abs(pressed + square.T @ traction.ravel() - tangent.force).max() < 1e-12 * np.abs(tangent.force).max()


@pytest.mark.parametrize("slid", [0.0, 0.3])
@pytest.mark.parametrize("kinds", [("line3", "line2"), ("quad8", "quad4"), ("tri6", "quad9")])
def test_slips(kinds: tuple[str, str], slid: float) -> None:
    """Of places that are held, against differences; where they are, and slid apart: then the turn of normals counts."""
    own, other = lines(kinds) if kinds[0] in LINES else faces(kinds)
    shared = np.vstack([own.points, other.points])
    target = np.where(other.nodes >= 0, other.nodes + len(own.points), -1).astype(np.int32)
    pair = replace(own, points=shared), replace(other, points=shared, nodes=target)
    normals, held = normal_pattern(pair[0]), SlipPoints.of(*pair, 1, CouplingOptions())
    shared = shared + slid * np.outer(np.arange(len(shared)) >= len(own.points), [1.0, 0.4, -0.2][: own.dim])

    def at(points: np.ndarray) -> SlipNow:
        moved = replace(pair[0], points=points)
        return slip_now(held, moved, replace(pair[1], points=points), normals.at(moved))

    way = np.random.default_rng(4).uniform(-1, 1, shared.shape)
    far = [at(shared + k * 1e-4 * way).value for k in (-2, -1, 1, 2)]
    expected = (far[0] - 8 * far[1] + 8 * far[2] - far[3]).ravel() / 12e-4
    now, dim = at(shared), pair[0].dim
    assert (np.abs(now.value).max() > 0.1 * slid * held.weight.max()) or not slid
    turning = normals.at(pair[0]).turning(len(shared))
    found = block_rows(now.by_points, len(shared)) + block_rows(now.by_normals, turning.shape[0] // dim) @ turning
    assert np.abs(found @ way.ravel() - expected).max() < 1e-9 * np.abs(expected).max()


def tangent_of(pair: tuple[Surface, Surface], with_traction: bool) -> CouplingTangent:
    pressure, traction = load(pair[0])
    return coupling_tangent(*pair, 1, CouplingOptions(), pressure, traction if with_traction else None)


@pytest.mark.parametrize("kinds", [("line3", "line2"), ("quad8", "quad4"), ("tri6", "quad9")])
def test_a_plan_is_held(kinds: tuple[str, str]) -> None:
    """With the numbers of points that another configuration asked for, few as they are, the derivative is that of the
    same rule."""
    pair = lines(kinds) if kinds[0] in LINES else faces(kinds)
    options = CouplingOptions()
    other = [replace(s, points=s.points * np.linspace(0.7, 1.2, pair[0].dim)) for s in pair]
    plan = plan_pair(other[0], other[1], options)
    assert not same_plan(plan, plan_pair(*pair, options))
    held = replace(options, points=plan)
    assert error(pair, options=held) < TOLERANCE
    only = np.arange(len(pair[0])) % 2 == 0
    some, every = couple(*pair, 1, held, only), couple(*pair, 1, held)
    assert np.array_equal(some.gap.reshape(-1, 9)[only], every.gap.reshape(-1, 9)[only])


def same_plan(a: Plan, b: Plan) -> bool:
    return all(np.array_equal(getattr(a, name), getattr(b, name)) for name in vars(a))


PAIRS = [lines(("line2", "line3")), lines(("line3", "line3")), faces(("quad4", "tri3")), faces(("quad9", "tri6"))]


@pytest.mark.parametrize("pair", PAIRS)
def test_forces_are_in_balance(pair: tuple[Surface, Surface]) -> None:
    tangent = tangent_of(pair, with_traction=True)
    dim = pair[0].dim
    nodal = tangent.force.reshape(-1, dim)
    assert np.abs(nodal.sum(axis=0)).max() < 1e-13 * np.abs(nodal).sum()
    for axis in range(dim):
        every = np.zeros_like(nodal)
        every[:, axis] = 1.0
        total = every.ravel() @ tangent.force_tangent
        assert np.abs(total).max() < 1e-12 * np.abs(tangent.force_tangent).sum()


@pytest.mark.parametrize("with_traction", [False, True])
@pytest.mark.parametrize("pair", PAIRS)
def test_moments_are_in_balance(pair: tuple[Surface, Surface], with_traction: bool) -> None:
    """The pressure at x_C and its reaction at x_T act along the line through both, and the contactor's facet takes up the
    couple of tractions, whatever the gap."""
    force = tangent_of(pair, with_traction).force.reshape(-1, pair[0].dim)
    x = np.concatenate([s.points for s in pair])
    moments = np.einsum("na,nb->nab", x, force)
    total = moments.sum(axis=0)
    assert np.abs(total - total.T).max() < 1e-12 * np.abs(moments).sum()


@pytest.mark.parametrize("pair", PAIRS)
def test_rigid_motions(pair: tuple[Surface, Surface]) -> None:
    """Gaps and areas stay, and the force of the pressure turns with the bodies."""
    tangent = tangent_of(pair, with_traction=False)
    dim = pair[0].dim
    x = np.concatenate([s.points for s in pair])
    turns = [np.array([[0.0, -1.0], [1.0, 0.0]])] if dim == 2 else [np.cross(np.eye(3), e) for e in np.eye(3)]
    motions = [(np.tile(e, (len(x), 1)), np.zeros((dim, dim))) for e in np.eye(dim)]
    motions += [(x @ w.T, w) for w in turns]
    force = tangent.force.reshape(-1, dim)
    for move, w in motions:
        for matrix in (tangent.gap, tangent.weight):
            assert np.abs(matrix @ move.ravel()).max() < SEEN_THROUGH * np.abs(matrix).max()
        change = (tangent.force_tangent @ move.ravel()).reshape(-1, dim) - force @ w.T
        assert np.abs(change).max() < SEEN_THROUGH * np.abs(tangent.force_tangent).max()


@pytest.mark.parametrize("pair", PAIRS[1:3])
def test_some_facets_and_shared_points(pair: tuple[Surface, Surface]) -> None:
    contactor, target = pair
    points = np.concatenate([contactor.points, target.points])
    nodes = np.where(target.nodes >= 0, target.nodes + len(contactor.points), -1).astype(np.int32)
    shared = replace(contactor, points=points), replace(target, points=points, nodes=nodes)
    options = CouplingOptions(points=3)
    whole = coupling_tangent(*pair, 2, options, *load(contactor))
    odd = np.arange(len(contactor)) % 2 == 1
    parts = [coupling_tangent(*shared, 2, options, *load(contactor), only=only) for only in (odd, ~odd)]
    for name in ("gap", "weight", "force_tangent"):
        both = getattr(parts[0], name) + getattr(parts[1], name) - getattr(whole, name)
        assert np.abs(both).max() < 1e-13 * np.abs(getattr(whole, name)).max()
    assert np.abs(parts[0].force + parts[1].force - whole.force).max() < 1e-13 * np.abs(whole.force).max()


def test_threads_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    upper = turn(sheet("quad4", 8, lambda s, t: [s, t, 0.1 * s**2], 0.1, 1))
    under = sheet("tri3", 7, lambda s, t: [s, t, 0.1 * s**2 - 0.01], 0.1, 2)
    found = []
    for threads in ("1", "3"):
        monkeypatch.setenv("OMP_NUM_THREADS", threads)
        found.append(tangent_of((upper, under), with_traction=True))
    assert np.array_equal(found[0].force, found[1].force)
    for name in ("gap", "weight", "force_tangent"):
        assert (getattr(found[0], name) != getattr(found[1], name)).nnz == 0


def normal_derivative(contactor: Surface, across: Smoothing | None = None) -> Sparse:
    """Derivative of ``nodal_normals(contactor, across)`` by its points, (9 n_facets dim, dim n_points), zero where padded;
    theory (T2)."""
    normals = normal_pattern(contactor, across).at(contactor)
    turning = normals.turning(len(contactor.points))
    used = np.flatnonzero(normals.numbers.ravel() >= 0)
    ones, dim = np.ones(len(used)), contactor.dim
    place = sp.csr_matrix(
        (ones, (used, normals.numbers.ravel()[used])), (normals.numbers.size, turning.shape[0] // dim)
    )
    return (sp.kron(place, sp.identity(dim), format="csr") @ turning).tocsr()


@pytest.mark.parametrize("kind", LINES + FACES)
def test_normals(kind: str) -> None:
    """Of a roof with a crease, and of a bend that becomes one: what is averaged stays as it was."""

    def surface(angle: float) -> Surface:
        roof = [lambda s: np.where(s < 0.5, s, 0.5 + (s - 0.5) * np.cos(angle)), lambda s: np.maximum(s - 0.5, 0)]
        if kind in LINES:
            return chain(kind, 4, lambda s: [roof[0](s), np.sin(angle) * roof[1](s)], 0.05, 1)
        return sheet(kind, 2, lambda s, t: [roof[0](s), t, np.sin(angle) * roof[1](s)], 0.05, 1)

    for angle in (np.deg2rad(80), np.deg2rad(40)):
        own = surface(angle)
        across = smoothing(surface(angle if angle > 1 else np.deg2rad(20)))
        way = np.random.default_rng(4).uniform(-1, 1, own.points.shape)
        far = [nodal_normals(replace(own, points=own.points + k * 1e-5 * way), across) for k in (-2, -1, 1, 2)]
        expected = (far[0] - 8 * far[1] + 8 * far[2] - far[3]).ravel() / 12e-5
        derivative = normal_derivative(own, across)
        assert derivative.shape == (9 * len(own) * own.dim, own.points.size)
        assert np.abs(derivative @ way.ravel() - expected).max() < 1e-9 * np.abs(expected).max()


def test_what_does_not_fit_is_refused() -> None:
    pair = lines(LINES)
    pressure, traction = load(pair[0])
    with pytest.raises(InputError, match="componentwise"):
        coupling_tangent(*pair, 1, CouplingOptions(componentwise=True), pressure)
    with pytest.raises(InputError, match="pressure"):
        coupling_tangent(*pair, 1, CouplingOptions(), pressure[1:])
    with pytest.raises(InputError, match="traction"):
        coupling_tangent(*pair, 1, CouplingOptions(), pressure, traction[:, :1])
