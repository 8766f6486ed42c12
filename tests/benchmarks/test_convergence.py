"""Rates of convergence of the method (records smooth-* and signorini-*), and what they rest on: exact fields, error norms,
supports and loads that are functions of position."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.benchmarks import BENCHMARKS, run
from abut.benchmarks.convergence import PLANE, SOLID, edge_fields, smooth_fields
from abut.benchmarks.errors import displacement_l2, energy_norm, pressure_l2
from abut.cells import CELLS
from abut.materials.elastic import lame
from abut.mesh.make import box, rectangle
from abut.mesh.mesh import Mesh
from abut.mesh.quadrature import field_rule
from abut.problem.loads import applied_load
from models.patch import STRAIN, exact_displacement, model, two_blocks

Array = NDArray[np.float64]
SOFT = abut.LinearElastic(1.0, 0.3)
SLOW = pytest.mark.long
CONVERGENCE = [
    pytest.param(
        f"{family}-{cell}", marks=[SLOW] if cell in SOLID and (CELLS[cell].degree == 2 or cell == "tet4") else []
    )
    for family in ("smooth", "signorini")
    for cell in PLANE + SOLID
]


@pytest.mark.long
@pytest.mark.parametrize("name", CONVERGENCE)
def test_rates(name: str) -> None:
    for outcome in run(BENCHMARKS[name]):
        assert len(outcome.values) >= 4
        assert outcome.rate is not None
        assert outcome.passed, f"{outcome.quantity}: rate {outcome.rate:.2f}, errors {outcome.values}"


def slope(f: Callable[[Array], Array], x: Array, h: float = 1e-6) -> Array:
    """Derivatives by central differences, the last index the direction."""
    return np.stack([(f(x + h * e) - f(x - h * e)) / (2 * h) for e in np.eye(x.shape[1])], axis=-1)


@pytest.mark.parametrize("dim", [2, 3])
def test_smooth_fields_solve_the_contact_problem(dim: int) -> None:
    """Equilibrium inside; on the interface the same level, the same pressure > 0 and no shear."""
    x = np.random.default_rng(1).uniform(-1, 1, (40, dim))
    on = x * np.array([*[1.0] * (dim - 1), 0.0])
    fields, pressure = smooth_fields(dim)
    for field in fields.values():
        assert np.abs(slope(field.displacement, x) - field.gradient(x)).max() < 1e-9
        assert np.abs(np.trace(slope(field.stress, x), axis1=2, axis2=3) + field.body_force(x)).max() < 1e-7
        stress = field.stress(on)
        assert np.abs(stress[:, :-1, -1]).max() < 1e-14
        assert -stress[:, -1, -1] == pytest.approx(pressure(on), abs=1e-14)
    lower, upper = (field.displacement(on) for field in fields.values())
    assert lower[:, -1] == pytest.approx(upper[:, -1], abs=1e-15)
    assert np.abs(lower[:, :-1] - upper[:, :-1]).max() > 0.01  # they slide
    assert pressure(on).min() > 0.1


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("body", ["lower", "upper"])
def test_edge_fields_solve_the_contact_problem(body: str, dim: int) -> None:
    """Equilibrium inside; closed and pressed for x < 0, open and free for x > 0."""
    field = edge_fields()[body]
    sign = 1.0 if body == "upper" else -1.0
    x = np.random.default_rng(1).uniform(0.1, 1, (40, dim))
    x[::2, 0] *= -1.0
    x[:, -1] *= sign
    lambda_, mu = lame(field.material, "strain" if dim == 2 else None)

    def stress(at: Array) -> Array:
        gradient = field.gradient(at)
        trace = np.trace(gradient, axis1=1, axis2=2)[:, None, None]
        return lambda_ * trace * np.eye(dim) + mu * (gradient + np.swapaxes(gradient, 1, 2))

    assert np.abs(slope(field.displacement, x) - field.gradient(x)).max() < 1e-9
    assert np.abs(np.trace(slope(stress, x), axis1=2, axis2=3)).max() < 1e-8
    on = x * np.array([*[1.0] * (dim - 1), 0.0])
    closed = on[:, 0] < 0
    assert np.abs(stress(on)[:, :-1, -1]).max() < 1e-14
    assert -stress(on)[:, -1, -1] == pytest.approx(field.pressure(on), abs=1e-14)
    assert (field.pressure(on) > 0).tolist() == closed.tolist()
    assert np.abs(field.displacement(on)[closed, -1]).max() < 1e-15
    assert (sign * field.displacement(on)[~closed, -1]).min() > 0


@pytest.mark.parametrize("kind", [*PLANE, *SOLID, "wedge6", "wedge15", "line2", "line3"])
def test_rule_for_fields(kind: str) -> None:
    """Exact to degree 2 p + 3: compared with a rule of many more points on a random polynomial."""
    cell = CELLS[kind]
    top = 2 * cell.degree + 3
    direction = np.random.default_rng(2).uniform(-0.5, 0.5, cell.dim)
    xi, weights = field_rule(kind)
    got = weights @ (1.0 + xi @ direction) ** top
    x, w = np.polynomial.legendre.leggauss(12)
    many = np.stack([g.ravel() for g in np.meshgrid(*[x] * cell.dim, indexing="ij")], axis=1)
    scale = np.prod(np.stack([g.ravel() for g in np.meshgrid(*[w] * cell.dim, indexing="ij")], axis=1), axis=1)
    simplex = cell.dim > 1 and cell.corners == cell.dim + 1
    flat = cell.dim if simplex else 2 if kind.startswith("wedge") else 0  # coordinates that belong to a simplex
    if flat:
        many[:, :flat] = 0.5 * (many[:, :flat] + 1.0)
        scale = scale / 2.0**flat
        for a in range(1, flat):  # coordinate a takes its share of what the ones before leave
            scale = scale * (1.0 - many[:, :a].sum(axis=1))
            many[:, a] *= 1.0 - many[:, :a].sum(axis=1)
    assert got == pytest.approx(scale @ (1.0 + many @ direction) ** top, rel=1e-13)


# ---- error norms ----


@pytest.mark.parametrize("kind", ["tri3", "quad8", "tet10", "hex8", "wedge15"])
def test_error_norms_of_the_patch_test(kind: str) -> None:
    """The exact solution lies in the spaces: no error against it, and a known one against a multiple of it."""
    cells = ((3, 2), (2, 3)) if kind in PLANE else ((2, 3, 2), (3, 2, 2))
    built = model(two_blocks(kind, kind, cells), rotate=False)
    solution = abut.solve(built)
    dim = built.dim
    at, moved = built.mesh.points, exact_displacement(built, rotated=False)
    fields, gradients = {}, {}
    for body in built.mesh.bodies:
        nodes = built.mesh.nodes_of(body)
        fit, *_ = np.linalg.lstsq(np.column_stack([at[nodes], np.ones(len(nodes))]), moved[nodes], rcond=None)
        fields[body] = lambda x, fit=fit: np.column_stack([x, np.ones(len(x))]) @ fit
        gradients[body] = lambda x, fit=fit: np.tile(fit[:dim].T, (len(x), 1, 1))
    double = {body: lambda x, f=f: 2.0 * f(x) for body, f in fields.items()}
    steep = {body: lambda x, f=f: 2.0 * f(x) for body, f in gradients.items()}
    assert displacement_l2(solution, fields) < 1e-11
    assert energy_norm(solution, gradients) < 1e-10
    assert pressure_l2(solution, lambda x: np.full(len(x), STRAIN)) < 1e-10
    assert displacement_l2(solution, double) == pytest.approx(0.5, rel=1e-10)
    assert energy_norm(solution, steep) == pytest.approx(0.5, rel=1e-10)
    assert pressure_l2(solution, lambda x: np.full(len(x), 4.0 * STRAIN)) == pytest.approx(0.75, rel=1e-10)


def test_norms_are_integrals() -> None:
    """A body at rest against u = (x^2, 0) on a unit square in plane strain: the error is the field itself."""
    built = abut.Model(
        rectangle(cells=(3, 2), cell="quad4"),
        [abut.Solid("body", SOFT)],
        [abut.Support("left", x=0, y=0)],
        [abut.Traction("right", (0.1, 0.0))],
        plane="strain",
    )
    solution = abut.solve(built)

    def wanted(x: Array) -> Array:
        return np.column_stack([1e6 * x[:, 0] ** 2, np.zeros(len(x))])

    assert displacement_l2(solution, {"body": wanted}) == pytest.approx(1.0, rel=1e-5)
    with pytest.raises(abut.InputError, match=r"exact displacement of 'body'.*must return shape"):
        displacement_l2(solution, {"body": lambda x: x[:, 0]})


def test_energy_norm_needs_gradients_only() -> None:
    built = abut.Model(
        rectangle((0, 1), (0, 1), (2, 2)),
        [abut.Solid("body", SOFT)],
        [abut.Support("bottom", y=0)],
        [abut.Pressure("top", 0.1)],
        plane="axisymmetric",
    )
    with pytest.raises(abut.InputError, match="axisymmetric"):
        energy_norm(abut.solve(built), {"body": lambda x: np.zeros((len(x), 2, 2))})


# ---- supports and loads that are functions of position ----


def mesh_of(cell: str) -> Mesh:
    return rectangle((0, 2), (0, 1), (4, 3), cell) if cell in PLANE else box((0, 2), (0, 1), (0, 1), (3, 2, 2), cell)


def held(mesh: Mesh, *supports: abut.Support, loads: tuple[object, ...] = ()) -> abut.Model:
    plane = "strain" if mesh.dim == 2 else None
    return abut.Model(mesh, [abut.Solid("body", SOFT)], supports, loads, plane=plane)  # type: ignore[arg-type]


@pytest.mark.parametrize("cell", ["tri6", "quad8", "quad9", "tet10", "hex27"])
def test_supports_follow_their_function(cell: str) -> None:
    """A quadratic field without body forces, prescribed all round, lies in the space: it is the solution."""
    mesh = mesh_of(cell)
    last = "xyz"[mesh.dim - 1]

    def exact(x: Array) -> Array:  # harmonic and free of divergence
        u = np.zeros_like(x)
        u[:, 0], u[:, -1] = x[:, 0] ** 2 - x[:, -1] ** 2, -2.0 * x[:, 0] * x[:, -1]
        return u

    components = {"x": lambda x: exact(x)[:, 0], "y": 0.0, last: lambda x: exact(x)[:, -1]}
    solution = abut.solve(held(mesh, *(abut.Support(side, **components) for side in mesh.surfaces)))
    assert np.abs(solution.displacement - exact(mesh.points)).max() < 1e-12


@pytest.mark.parametrize("cell", [*PLANE, *SOLID, "wedge15"])
def test_resultants_are_the_integrals(cell: str) -> None:
    """Traction exp(y) on the side x = 2 and force x^3 exp(x) in the body, both along x; balanced by the reactions."""
    mesh = mesh_of(cell)
    first = np.eye(mesh.dim)[0]
    loads = (
        abut.Traction("right", lambda x: np.exp(x[:, 1])[:, None] * first),
        abut.BodyForce(lambda x: (x[:, 0] ** 3 * np.exp(x[:, 0]))[:, None] * first),
    )
    fixed = abut.Support("left", **dict.fromkeys("xyz"[: mesh.dim], 0.0))
    exact = np.e - 1.0, 2.0 * np.exp(2.0) + 6.0  # int of x^3 e^x is (x^3 - 3 x^2 + 6 x - 6) e^x
    sums = [applied_load(held(mesh, fixed, loads=(load,))).reshape(-1, mesh.dim).sum(axis=0) for load in loads]
    for total, wanted in zip(sums, exact):
        assert total == pytest.approx(wanted * first, rel=1e-5, abs=1e-12)
    step = abut.solve(held(mesh, fixed, loads=loads)).steps[-1]
    assert step.load == pytest.approx(sum(sums), rel=1e-12, abs=1e-12)
    assert step.balance_error < 1e-10


def test_body_force_of_numbers_is_a_function_that_is_constant() -> None:
    mesh = two_blocks("hex20", "tet10", ((2, 2, 2), (2, 3, 2)))
    for on, volume in (("upper", 0.8), (None, 1.8)):
        built = [
            abut.Model(mesh, [abut.Solid(b, SOFT) for b in mesh.bodies], loads=[abut.BodyForce(value, on)])
            for value in ((1.0, 0.0, -2.0), lambda x: np.tile([1.0, 0.0, -2.0], (len(x), 1)))
        ]
        numbers, function = (applied_load(m).reshape(-1, 3) for m in built)
        assert np.abs(numbers - function).max() < 1e-12
        assert numbers.sum(axis=0) == pytest.approx(volume * np.array([1.0, 0.0, -2.0]), abs=1e-12)


def test_functions_are_ramped() -> None:
    mesh = rectangle(cells=(2, 2))
    supports = [abut.Support("bottom", x=0, y=0), abut.Support("top", y=lambda x: 0.01 * x[:, 0])]
    loads = [abut.BodyForce(lambda x: np.ones_like(x))]
    built = abut.Model(
        mesh, [abut.Solid("body", SOFT)], supports, loads, plane="strain", solve=abut.SolveOptions(steps=2)
    )
    half, full = abut.solve(built).steps
    assert half.displacement == pytest.approx(0.5 * full.displacement, abs=1e-14)
    assert half.load == pytest.approx(0.5 * full.load)


HOLD = abut.Support("bottom", x=0, y=0)
# fmt: off
BAD = {
    "shape of a support": ([abut.Support("top", y=lambda x: x)], [],
        r"support on 'top': y: for points of shape \(9, 2\) the function must return shape \(9,\), got \(9, 2\)"),
    "number of a support": ([abut.Support("top", y=lambda x: 0.0)], [], r"must return shape \(9,\), got \(\)"),
    "nan of a support": ([abut.Support("top", x=lambda x: np.where(x[:, 0] < 1, x[:, 0], np.nan))], [],
        r"support on 'top': x: the function returns nan at \[1.0, 1.0\]"),
    "no numbers": ([abut.Support("top", x=lambda x: "up")], [], "support on 'top': x: expected a function that returns"),
    "shape of a traction": ([], [abut.Traction("top", lambda x: x[:, 0])], r"traction on 'top': value: .*, 2\), got"),
    "infinity": ([], [abut.Traction("top", lambda x: x / 0.0)], "traction on 'top': value: the function returns inf"),
    "shape of a body force": ([], [abut.BodyForce(lambda x: np.ones(3))], r"body force: value: .* got \(3,\)"),
    "nan of a body force": ([], [abut.BodyForce(lambda x: np.nan * x)], "body force: value: the function returns nan at"),
    "body": ([], [abut.BodyForce((1.0, 0.0), on="bdoy")], r"loads\[0\].on: no body named 'bdoy'.*'body'"),
    "components": ([], [abut.BodyForce((1.0, 0.0, 0.0))], r"loads\[0\].value: expected 2 components, got 3"),
}
# fmt: on


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("case", BAD)
def test_bad_functions(case: str) -> None:
    supports, loads, message = BAD[case]
    with pytest.raises(abut.InputError, match=message):
        abut.solve(held(rectangle(cells=(4, 4), cell="quad8"), HOLD, *supports, loads=tuple(loads)))


def test_bad_records() -> None:
    with pytest.raises(abut.InputError, match="body force: value: expected 2 or 3 numbers"):
        abut.BodyForce(3.0)  # type: ignore[arg-type]
    with pytest.raises(abut.InputError, match="support on 'top': normal: expected a number"):
        abut.Support("top", normal=lambda x: x[:, 0])  # type: ignore[arg-type]
