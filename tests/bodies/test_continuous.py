"""Pressures that are continuous, of mixed tet10 cells: theory (E8) to (E11), (D25)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from abut import (
    ArrudaBoyce,
    Contact,
    Hencky,
    InputError,
    LinearElastic,
    Model,
    MooneyRivlin,
    NeoHooke,
    Orthotropic,
    Plastic,
    Pressure,
    Rigid,
    Solid,
    SolveOptions,
    Support,
    Traction,
    solve,
)
from abut.bodies.assemble import internal_force, is_symmetric, respond, stiffness
from abut.bodies.solids import Solids, TemperatureChange
from abut.bodies.stress import point_stress
from abut.materials.kernel import Since
from abut.mesh.make import box, join
from abut.mesh.mesh import Mesh
from abut.verify.cell_pressures import cell_inf_sup, continuous_inf_sup

LAWS = [
    NeoHooke(shear=1.0, bulk=40.0), NeoHooke(shear=1.0, bulk=40.0, volumetric="log-squared"),
    NeoHooke(shear=1.0, bulk=40.0, volumetric="isochoric"), MooneyRivlin(c10=0.3, c01=0.2, bulk=[25.0, 40.0]),
    ArrudaBoyce(shear=1.0, locking=2.0, bulk=50.0), Hencky(2.0, 0.48), Plastic(2.0, 0.48, yield_stress=0.05),
]  # fmt: skip


def distorted(n: int = 2) -> Mesh:
    """A cube whose inner nodes have moved, so that cells are curved."""
    mesh = box([0, 1], [0, 1], [0, 1], cells=[n] * 3, cell="tet10")
    x = mesh.points
    return replace(mesh, points=x + 0.06 * np.sin(np.pi * x).prod(axis=1)[:, None] * np.arange(1, 4))


def solids(mesh: Mesh, law: object, kinematics: str, how: str = "mixed") -> Solids:
    """All of it alike."""
    return Solids(mesh, dict.fromkeys(mesh.bodies, law), None, dict.fromkeys(mesh.bodies, how), kinematics)


@pytest.mark.parametrize(
    ("law", "kinematics"),
    [
        (LinearElastic(3.0, 0.49), "small"),
        (Plastic(2.0, 0.3, yield_stress=0.05), "small"),
        *((law, "finite") for law in LAWS),
    ],
)
def test_uniform_strain(law: object, kinematics: str) -> None:
    """Linear displacements give the law's stress at every point, and its forces and energy (patch test)."""
    mesh = distorted()
    u = np.ascontiguousarray(mesh.points @ (0.1 * np.random.default_rng(1).normal(size=(3, 3))).T)
    mixed, full = solids(mesh, law, kinematics), solids(mesh, law, kinematics, "full")
    for one, other in zip(point_stress(mixed, u), point_stress(full, u)):
        np.testing.assert_allclose(one, other, atol=1e-11)
    one, other = respond(mixed, u), respond(full, u)
    np.testing.assert_allclose(one.force, other.force, atol=1e-11)
    np.testing.assert_allclose(one.energy, other.energy, atol=1e-12)


@pytest.mark.parametrize("law", LAWS)
def test_tangent(law: object) -> None:
    """It is the derivative of the forces, and symmetric; forces are that of the energy, of what has not flowed."""
    body = solids(distorted(1), law, "finite")
    rng = np.random.default_rng(2)
    u, v = 0.03 * rng.normal(size=body.points.shape), rng.normal(size=body.points.shape)
    here, step = respond(body, u), 1e-6
    after, before = respond(body, u + step * v), respond(body, u - step * v)
    change = (after.force - before.force) / (2 * step)
    np.testing.assert_allclose(here.tangent @ v.ravel(), change, rtol=0, atol=1e-6 * abs(change).max())
    matrix = here.tangent.tocsr()
    assert abs(matrix - matrix.T).max() < 1e-11 * abs(matrix).max()
    assert is_symmetric(body)
    if not isinstance(law, Plastic):
        work = (after.energy.sum() - before.energy.sum()) / (2 * step)
        assert work == pytest.approx(here.force @ v.ravel(), rel=1e-6)


@pytest.mark.parametrize("law", [*LAWS[:-1], LinearElastic(3.0, 0.49)])
def test_finite_begins_as_small(law: object) -> None:
    """At rest the finite tangent is the small one; forces of small strains are stiffness times displacement."""
    mesh = distorted()
    small = solids(mesh, law, "small")
    matrix = stiffness(small)
    if not isinstance(law, LinearElastic):
        rest = respond(solids(mesh, law, "finite"), np.zeros(mesh.points.shape)).tangent.tocsr()
        assert abs(rest - matrix).max() < 1e-12 * abs(matrix).max()
    u = np.random.default_rng(3).normal(size=mesh.points.shape)
    np.testing.assert_allclose(internal_force(small, u), matrix @ u.ravel(), atol=1e-12 * abs(matrix).max())


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_heat_without_stress(kinematics: str) -> None:
    """Free expansion has none: under a linear temperature of small strains, u = alpha (T x - x^2 grad T / 2), and under a
    uniform one of finite strains."""
    small = kinematics == "small"
    mesh = box([0, 1], [0, 1], [0, 1], cells=[2] * 3, cell="tet10") if small else distorted()
    law = (
        LinearElastic(3.0, 0.49, expansion=1e-3) if small else MooneyRivlin(c10=0.3, c01=0.2, bulk=50.0, expansion=1e-3)
    )
    x, slope = mesh.points, np.arange(1.0, 4.0) * small
    heat = TemperatureChange({}, 5.0 + x @ slope)
    u = 1e-3 * ((5.0 + x @ slope)[:, None] * x - 0.5 * (x**2).sum(axis=1)[:, None] * slope)
    body = solids(mesh, law, kinematics)
    np.testing.assert_allclose(respond(body, u, heat).force, 0.0, atol=1e-13)
    for values in point_stress(body, u, heat):
        np.testing.assert_allclose(values, 0.0, atol=1e-11)


def test_pressures_jump_between_bodies() -> None:
    """Two bodies that share nodes, pressed between walls: each has its own modulus K + 4/3 G, and both the same stress."""
    mesh = box([0, 1], [0, 1], [0, 2], cells=[2, 2, 4], cell="tet10")
    middle = mesh.points[mesh.blocks[0].nodes[:, :4]].mean(axis=1)[:, 2]
    halves = {"lower": np.flatnonzero(middle < 1.0), "upper": np.flatnonzero(middle > 1.0)}
    mesh = Mesh(mesh.points, mesh.blocks, halves, {})
    laws = {"upper": LinearElastic(3.0, 0.499), "lower": LinearElastic(1.0, 0.45)}
    moduli = {
        body: law.young * (1 - law.poisson) / (1 + law.poisson) / (1 - 2 * law.poisson) for body, law in laws.items()
    }
    z = mesh.points[:, 2]
    u = np.zeros(mesh.points.shape)
    u[:, 2] = np.minimum(z, 1.0) / moduli["lower"] + np.maximum(z - 1.0, 0.0) / moduli["upper"]
    for values in point_stress(Solids(mesh, laws, None, dict.fromkeys(laws, "mixed")), u):
        np.testing.assert_allclose(values[..., 2], 1.0, rtol=1e-11)


def test_inf_sup() -> None:
    """The constant stays on a cube with clamped base, .565 .562 .5615 (another program); that of a pressure in each cell
    falls."""
    found, alone = [], []
    for n in (2, 3, 4):
        mesh = box([0, 1], [0, 1], [0, 1], cells=[n] * 3, cell="tet10")
        free = mesh.points[:, 2] > 1e-12
        found.append(continuous_inf_sup(mesh, free))
        if n < 4:
            alone.append(cell_inf_sup(mesh, free, 1))
    np.testing.assert_allclose(found, [0.565, 0.562, 0.5615], atol=0.02)
    assert found[-1] > 0.98 * found[0]
    assert alone[-1] < 0.8 * alone[0]


@pytest.mark.parametrize("guessed", [False, True])
def test_foreseen_pressures(guessed: bool) -> None:
    """The tangent takes the pressures that the last iteration foresaw, theory (D24): it differs from the derivative of the
    forces by V_a k (growth - foreseen growth) times the second derivative of each growth, which is a cubic of displacements:
    differences of its first derivatives on both sides give it exactly but for a third order, which is small."""
    bulk = 50.0
    body = solids(distorted(1), NeoHooke(shear=0.7, bulk=bulk, volumetric="isochoric"), "finite")
    of, rng = body.pressures, np.random.default_rng(4)
    assert of is not None
    before, after, a, b = (0.03 * rng.normal(size=body.points.shape) for _ in range(4))
    change = respond(body, after, since=Since(before, guessed)).tangent - respond(body, after).tangent
    start, now = of.at(before), of.at(after)
    unforeseen = now.growth - start.growth - (0.0 if guessed else start.rows @ (after - before).ravel())
    step = 1e-4
    curved = (of.at(after + step * b).rows - of.at(after - step * b).rows) @ a.ravel() / (2 * step)
    constant = bulk - 2.0 / 3.0 * 0.7  # of the law that acts on volumes; what is left has 2/3 of the shear modulus
    assert a.ravel() @ (change @ b.ravel()) == pytest.approx(-constant * (of.volume * unforeseen) @ curved, rel=1e-6)


def test_iterations_do_not_grow_with_the_bulk_modulus() -> None:
    """Rubber between rough plates, squeezed by a fifth at once."""
    assert squeezed(1e7) <= squeezed(1e3) + 1


def squeezed(bulk: float) -> int:
    """Iterations."""
    mesh = join({"rubber": box((0, 1), (0, 1), (0, 1), (2, 2, 2), "tet10")})
    law = NeoHooke(shear=1.0, bulk=bulk, volumetric="isochoric")
    held = [
        Support("rubber.bottom", x=0.0, y=0.0, z=0.0), Support("rubber.top", x=0.0, y=0.0, z=-0.2),
    ]  # fmt: skip
    options = SolveOptions(steps=1)
    solution = solve(Model(mesh, [Solid("rubber", law, integration="mixed")], held, kinematics="finite", solve=options))
    return sum(len(step.iterations) for step in solution.steps)


def cook(n: int, law: object, how: str = "mixed", linear: str = "auto") -> Model:
    """Cook's membrane, a slice of it held across."""
    cube = box((0, 1), (0, 1), (0, 1), (n, n, 1), "tet10")
    x, y, z = cube.points.T
    slab = replace(cube, points=np.column_stack([48 * x, 44 * x + y * (44 - 28 * x), 48 / n * z]))
    return Model(
        join({"slab": slab}),
        [Solid("slab", law, integration=how)],
        [Support("slab.left", x=0.0, y=0.0), Support("slab.bottom", z=0.0), Support("slab.top", z=0.0)],
        [Traction("slab.right", (0.0, 100.0 / 16.0, 0.0))],
        solve=SolveOptions(linear=linear),
    )


def tip(model: Model) -> float:
    """Its corner's displacement."""
    solution = solve(model)
    corner = np.isclose(solution.model.mesh.points[:, :2], (48.0, 60.0)).all(axis=1)
    return float(solution.displacement[corner, 1].mean())


def test_cook() -> None:
    """At a Poisson's ratio of .5 what tri6 with linear continuous pressures has in another program, 7.331 and 7.588 at 4 and
    8 cells a side; full integration locks. "auto" takes it."""
    law = LinearElastic(250.0, 0.5)
    assert tip(cook(4, law)) == pytest.approx(7.331, rel=0.005)
    assert tip(cook(8, law)) == pytest.approx(7.588, rel=0.005)
    assert tip(cook(8, LinearElastic(250.0, 0.4999999), "full")) < 0.6 * 7.767


def cylinder(law: object, pressure: float, steps: int) -> Model:
    """A quarter of a slice of a thick cylinder, radii 1 and 2, held across."""
    cube = box((0, 1), (0, 1), (0, 1), (2, 4, 1), "tet10")
    r, turn, z = cube.points.T * np.array([[1.0], [np.pi / 2], [0.5]])
    wall = replace(cube, points=np.column_stack([(1 + r) * np.cos(turn), (1 + r) * np.sin(turn), z]))
    return Model(
        join({"wall": wall}),
        [Solid("wall", law)],
        [
            Support("wall.front", y=0.0),
            Support("wall.back", x=0.0),
            *(Support(f"wall.{s}", z=0.0) for s in ("top", "bottom")),
        ],
        [Pressure("wall.left", pressure)],
        kinematics="finite",
        solve=SolveOptions(steps=steps),
    )


@pytest.mark.parametrize(
    "law", [NeoHooke(shear=1.0, bulk=1e5, volumetric="isochoric"), MooneyRivlin(c10=0.5, c01=0.0, bulk=1e5)]
)
def test_rubber_cylinder(law: object) -> None:
    """Blown up to a stretch of 1.1 at the bore by what incompressible rubber takes, mu [ln(la / lb) + (lb^-2 - la^-2) / 2]:
    two cells through the wall are within 1e-4 of that stretch; "auto" takes it."""
    solution = solve(cylinder(law, 0.13156228, 1))
    before = solution.model.mesh.points
    bore = np.isclose(np.hypot(*before.T[:2]), 1.0)
    after = (before + solution.displacement)[bore]
    assert np.hypot(*after.T[:2]).mean() == pytest.approx(1.1, rel=1e-4)


def test_contact_with_friction() -> None:
    """A block of rubber under a rigid plate with friction keeps its volume, and the shear force on it, which its symmetry
    planes see, is below the coefficient times the normal force."""
    rubber = box((0, 1), (0, 1), (0, 1), (3, 3, 3), "tet10")
    plate = box((-0.5, 2.5), (-0.5, 2.5), (1, 1.2), (1, 1, 1), "hex8")
    model = Model(
        join({"rubber": rubber, "plate": plate}),
        [Solid("rubber", LinearElastic(3.0, 0.5))],
        [Support("rubber.bottom", z=0.0), Support("rubber.left", x=0.0), Support("rubber.front", y=0.0)],
        contacts=[Contact("rubber.top", "plate.bottom", friction=0.3)],
        rigid=[Rigid("plate", x=0.0, y=0.0, z=-0.01, rx=0.0, ry=0.0, rz=0.0)],
    )
    solution = solve(model)
    assert solution.converged
    stress = point_stress(model.deformable, solution.displacement)[0]
    of = model.deformable.pressures
    assert of is not None
    growth = of.at_rest.rows @ solution.displacement.ravel()
    assert abs(growth).max() < 1e-5 * 0.01
    assert stress[..., 2].max() < 0.0
    shear = abs(np.asarray(solution.contacts[0].force)[:2])
    normal = abs(solution.contacts[0].force[2])
    assert 0.05 * normal < shear.max() < 0.3 * normal


def test_plastic() -> None:
    """Metal that flows in Cook's membrane, at a Poisson's ratio of .3 before: mixed cells and full integration converge to
    the same."""
    law = Plastic(250.0, 0.3, yield_stress=15.0, hardening=10.0)
    mixed, full = tip(cook(6, law)), tip(cook(6, law, "full"))
    assert mixed == pytest.approx(full, rel=0.1)


@pytest.mark.parametrize(
    ("law", "kinematics", "words"),
    [
        (LinearElastic(3.0, 0.4999), "finite", "finite strains"),
        (LinearElastic(3.0, -0.1), "small", "> 0"),
        (Orthotropic((1.0, 2.0, 3.0), (0.2, 0.2, 0.2), (1.0, 1.0, 1.0)), "small", "Orthotropic"),
    ],
)
def test_refused(law: object, kinematics: str, words: str) -> None:
    """Materials whose mean stress is no matter of the volume alone."""
    cube = box((0, 1), (0, 1), (0, 1), (1, 1, 1), "tet10")
    with pytest.raises(InputError, match=words):
        Model(
            join({"cube": cube}), [Solid("cube", law, integration="mixed")], [Support("cube.bottom", x=0.0, y=0.0, z=0.0)],
            kinematics=kinematics,
        )  # fmt: skip
