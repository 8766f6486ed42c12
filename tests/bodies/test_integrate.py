"""The integration over cells for any material: forces against tangents, both kernels against each other, history, plane
stress, and what a material may get wrong."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from abut._core import strains
from abut.bodies.assemble import History, internal_force, respond, stiffness, tangent, thermal_load
from abut.bodies.recovery import nodal_stress
from abut.bodies.solids import Solids, TemperatureChange
from abut.cells import CELLS
from abut.errors import ConvergenceError, InputError
from abut.materials.elastic import LinearElastic, lame
from abut.materials.material import Array, Evaluated
from abut.materials.plane_stress import in_plane_stress
from abut.mesh.make import box, rectangle
from abut.mesh.quadrature import BBAR, REDUCED, cell_rule
from models.patch import two_blocks

STEEL = LinearElastic(2.0, 0.3, expansion=1e-2)
PLANES = ("strain", "stress", "axisymmetric")
CASES = [
    (kind, plane, rule)
    for kind, cell in CELLS.items()
    if cell.dim > 1
    for plane in (PLANES if cell.dim == 2 else (None,))
    for rule in ("full", "reduced", "b-bar")
    if rule == "full" or (kind in (REDUCED if rule == "reduced" else BBAR) and (rule, plane) != ("b-bar", "stress"))
]


@dataclass(frozen=True)
class Stiffening:
    """Stress C : strain (1 + |strain|^2): nonlinear, without history, the tangent full and symmetric."""

    expansion: float = 1e-2
    constant: bool = False
    modulus: float = 2.0

    def initial(self, n: int) -> Array:
        return np.zeros((n, 0))

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        linear, c, _ = STEEL.evaluate(strain, history)
        grow = 1.0 + (strain * linear).sum(axis=1)
        slope = grow[:, None, None] * c + 2.0 * linear[:, :, None] * linear[:, None, :]
        return grow[:, None] * linear, slope, history


@dataclass(frozen=True)
class Elastic(Stiffening):
    """Hooke's law through the kernel for any tangent."""

    constant: bool = True

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        return STEEL.evaluate(strain, history)


@dataclass(frozen=True)
class Counting(Elastic):
    """Its history: how often it was evaluated and the strain along x there."""

    seen: list[int] = field(default_factory=list)

    def initial(self, n: int) -> Array:
        return np.zeros((n, 2))

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        self.seen.append(len(strain))
        stress, c, _ = STEEL.evaluate(strain * (1.0 + history[:, :1]), history)
        return stress, c * (1.0 + history[:, :1, None]), np.column_stack([history[:, 0] + 1.0, strain[:, 0]])


def solids(kind: str, plane: str | None, rule: str, material: object) -> Solids:
    mesh = two_blocks(kind, kind, ((3, 2), (2, 3)) if CELLS[kind].dim == 2 else ((1, 2, 1), (2, 1, 1)))
    points = mesh.points + (1.0 if plane == "axisymmetric" else 0.0)  # away from the axis
    mesh = replace(mesh, points=points, axisymmetric=plane == "axisymmetric")
    return Solids(mesh, dict.fromkeys(mesh.bodies, material), plane, dict.fromkeys(mesh.bodies, rule))


def random(own: Solids, seed: int = 1) -> tuple[Array, TemperatureChange]:
    numbers = np.random.default_rng(seed)
    u = 0.3 * numbers.uniform(-1, 1, own.mesh.points.shape)
    return u, TemperatureChange(dict(zip(own.mesh.bodies, (2.0, -1.0))), numbers.uniform(-1, 1, len(own.mesh.points)))


@pytest.mark.parametrize(("kind", "plane", "rule"), CASES)
def test_tangent_is_the_derivative_of_the_force(kind: str, plane: str | None, rule: str) -> None:
    """Central differences of step h: h^2 of the third derivative, and rounding over h; h = 1e-5 leaves 1e-9 of both."""
    own = solids(kind, plane, rule, Stiffening())
    u, change = random(own)
    along = np.random.default_rng(2).uniform(-1, 1, u.shape)
    matrix, h = tangent(own, u, change), 1e-5
    difference = (internal_force(own, u + h * along, change) - internal_force(own, u - h * along, change)) / (2 * h)
    assert np.abs(matrix @ along.ravel() - difference).max() < 1e-7 * np.abs(difference).max()
    assert abs(matrix - matrix.T).max() < 1e-13 * abs(matrix).max()  # work has a potential
    assert np.abs(matrix @ along.ravel() - stiffness(own) @ along.ravel()).max() > 0.1 * np.abs(difference).max()


@pytest.mark.parametrize(("kind", "plane", "rule"), CASES)
def test_full_tangents_with_lame_constants_are_the_two_constants(kind: str, plane: str | None, rule: str) -> None:
    two, full = (solids(kind, plane, rule, material) for material in (STEEL, Elastic()))
    u, change = random(two)
    assert abs(stiffness(two) - stiffness(full)).max() < 1e-13 * abs(stiffness(two)).max()
    force = internal_force(two, u, change)
    for other in (internal_force(full, u, change), stiffness(two) @ u.ravel() - thermal_load(two, change)):
        assert np.abs(force - other).max() < 1e-13 * np.abs(force).max()
    assert abs(tangent(two, u, change) - stiffness(two)).max() == 0.0


@pytest.mark.parametrize(("kind", "plane", "rule"), CASES)
def test_free_expansion_stresses_nothing(kind: str, plane: str | None, rule: str) -> None:
    """Under a uniform change of temperature, by body and at the nodes; in plane strain by 1 + nu, stressed across."""
    for material in (STEEL, Elastic()):
        own = solids(kind, plane, rule, material)
        grow = 5.0 * 1e-2 * (1.3 if plane == "strain" else 1.0)
        u, change = (
            grow * own.mesh.points,
            TemperatureChange(dict.fromkeys(own.mesh.bodies, 3.0), np.full(len(own.points), 2.0)),
        )
        assert np.abs(internal_force(own, u, change)).max() < 1e-14
        stress = nodal_stress(own, u, change)
        blocked = -2.0 * 5.0 * 1e-2 if plane == "strain" else 0.0  # -E alpha dT
        assert stress == pytest.approx(np.array([0, 0, blocked, 0, 0, 0]) * np.ones((len(stress), 1)), abs=1e-13)


@pytest.mark.parametrize(("kind", "plane", "rule"), CASES)
def test_linear_displacement_strains_all_points_alike(kind: str, plane: str | None, rule: str) -> None:
    own = solids(kind, plane, rule, STEEL)
    dim = own.mesh.dim
    slope = np.zeros((3, 3))
    slope[:dim, :dim] = np.random.default_rng(3).uniform(-1, 1, (dim, dim))
    if plane == "axisymmetric":
        slope[0, 1] = 0.0
        slope[2, 2] = slope[0, 0]  # u_r / r of u_r = a r
    u = own.mesh.points @ slope[:dim, :dim].T
    want = np.diag(slope).tolist() + [slope[a, b] + slope[b, a] for a, b in ((0, 1), (1, 2), (2, 0))]
    for group in own.groups():
        got = strains(group.arrays(own, cell_rule(kind, rule)), u)
        assert np.abs(got - want).max() < 1e-12


@pytest.mark.parametrize("kind", ["quad4", "quad9", "hex8", "tet10"])
def test_history_belongs_to_its_points(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """What a material has returned it gets back at the same point, whatever portions the cells are taken in, in a mesh of
    two bodies of which one has no history."""
    material = Counting()
    own = solids(kind, "strain" if CELLS[kind].dim == 2 else None, "full", material)
    own = replace(own, materials={"lower": STEEL, "upper": material})
    u, change = random(own)
    first = respond(own, u, change)
    assert list(first.history) == ["upper"]
    cells = len(own.mesh.bodies["upper"])
    points = cells * len(cell_rule(kind, "full")[1])
    assert first.history["upper"].shape == (points, 2)
    assert (first.history["upper"][:, 0] == 1.0).all()
    monkeypatch.setattr("abut.bodies.solids.PORTION", 2 * len(cell_rule(kind, "full")[1]))
    material.seen.clear()
    marked: History = {"upper": np.column_stack([np.arange(points), np.zeros(points)])}
    second = respond(own, u, change, marked)
    assert len(material.seen) == (cells + 1) // 2
    assert np.array_equal(second.history["upper"][:, 0], np.arange(points) + 1.0)
    assert np.array_equal(second.history["upper"][:, 1], first.history["upper"][:, 1])
    monkeypatch.undo()
    whole = respond(own, u, change, marked)
    assert np.abs(second.force - whole.force).max() < 1e-13 * np.abs(whole.force).max()
    assert abs(second.tangent - whole.tangent).max() < 1e-13 * abs(whole.tangent).max()


def test_plane_stress_of_any_material() -> None:
    """No stress out of the plane, Hooke's law as it is known, and a tangent that is the derivative."""
    strain = np.zeros((40, 6))
    strain[:, [0, 1, 3]] = np.random.default_rng(4).uniform(-0.5, 0.5, (40, 3))
    _, (stress, c, _) = in_plane_stress(STEEL.evaluate, strain, STEEL.initial(40))
    lambda_, mu = lame(STEEL, "stress")
    want = 2.0 * mu * strain[:, :2] + lambda_ * strain[:, :2].sum(axis=1, keepdims=True)
    assert stress[:, :2] == pytest.approx(want, abs=1e-14)
    assert c[0, 0, :2] == pytest.approx([lambda_ + 2.0 * mu, lambda_], abs=1e-14)
    material, h = Stiffening(), 1e-6
    _, (stress, c, _) = in_plane_stress(material.evaluate, strain, material.initial(40))
    assert np.array_equal(stress[:, [2, 4, 5]], np.zeros((40, 3)))
    for k in (0, 1, 3):
        step = h * np.eye(6)[k]
        ends = [in_plane_stress(material.evaluate, strain + s * step, material.initial(40))[1][0] for s in (1.0, -1.0)]
        assert np.abs(c[:, :, k] - (ends[0] - ends[1]) / (2 * h)).max() < 1e-8


@dataclass(frozen=True)
class Never(Stiffening):
    """Has stress out of the plane whatever the strain."""

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        stress, c, history = STEEL.evaluate(strain, history)
        return np.hypot(stress, 1.0), c, history


@dataclass(frozen=True)
class Short(Stiffening):
    """Returns stresses of the plane only."""

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        stress, c, history = STEEL.evaluate(strain, history)
        return stress[:, :3], c, history


@pytest.mark.parametrize("plane", ["strain", "stress"])
def test_refusals(plane: str) -> None:
    mesh = rectangle(cells=(2, 1), cell="quad4")
    u = 0.1 * mesh.points
    with pytest.raises(ConvergenceError, match="plane stress: no strain out of the plane"):
        internal_force(Solids(mesh, {"body": Never()}, "stress"), u)
    with pytest.raises(
        InputError, match=r"body 'body': evaluate returned a stress of shape \(8, 3\), expected \(8, 6\)"
    ):
        internal_force(Solids(mesh, {"body": Short()}, plane), u)


def test_threads_do_not_change_forces(monkeypatch: pytest.MonkeyPatch) -> None:
    mesh = box(cells=(18, 18, 17), cell="hex8")  # enough cells for threads to be used
    u = np.random.default_rng(5).uniform(-1, 1, mesh.points.shape)
    for material in (STEEL, Elastic()):
        results = []
        for threads in ("1", "3"):
            monkeypatch.setenv("OMP_NUM_THREADS", threads)
            results.append(respond(Solids(mesh, {"body": material}), u))
        assert np.array_equal(results[0].force, results[1].force)
        assert np.array_equal(results[0].tangent.data, results[1].tangent.data)
