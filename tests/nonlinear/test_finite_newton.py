"""Newton's method under finite deformation: order, failed steps, energy, and what is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.analysis.run import Run
from abut.benchmarks.finite_rubber import cook
from abut.bodies.assemble import respond
from abut.bodies.inverted import Inverted
from abut.bodies.recovery import nodal_stress
from abut.bodies.solids import Solids
from abut.cells import CELLS
from abut.errors import InputError
from abut.linear.direct import solve
from abut.linear.repeated import Repeated
from abut.materials.material import OwnMaterial
from abut.mesh.make import box, join, rectangle
from abut.problem.body_terms import SolidBodies
from abut.problem.terms import Motion

RUBBER = abut.NeoHooke(2.0, 0.3)
BLOCK = join({"body": rectangle((0.0, 2.0), (0.0, 1.0), (4, 2), "quad8")})
HELD = [abut.Support("body.left", x=0, y=0)]


def model(loads: list, material: object = RUBBER, steps: int = 1, **given: object) -> abut.Model:
    return abut.Model(
        BLOCK, [abut.Solid("body", material)], given.pop("supports", HELD), loads,
        **{"plane": "strain", "kinematics": "finite", "solve": abut.SolveOptions(steps=steps)} | given,
    )  # fmt: skip


@pytest.mark.parametrize(
    "load", [abut.Force("body.right", (0.05, 0.1)), abut.Pressure("body.top", 0.06), abut.Gravity((0.0, -0.05))]
)
@pytest.mark.parametrize("material", [replace(RUBBER, density=1.0), abut.LinearElastic(2.0, 0.3, density=1.0)])
def test_quadratic(load: object, material: object) -> None:
    """Once near, each residual is about the square of the one before it."""
    solution = abut.solve(model([load], material))
    assert solution.converged
    assert np.abs(solution.displacement).max() > 0.2
    last = [row.residual for row in solution.steps[-1].iterations][-3:]
    assert last[2] < max(100.0 * last[1] ** 2, 1e-12)
    assert last[1] < 1e3 * last[0] ** 2


def test_unsymmetric_tangent_is_quadratic_too() -> None:
    rows = abut.solve(replace(cook(4), solve=abut.SolveOptions(steps=1, max_iterations=30))).steps[-1].iterations
    assert rows[-1].residual < 1e-9
    assert rows[-1].residual < max(1e-3 * rows[-2].residual, 1e-10)  # rounding


def test_dead_and_following_pressure() -> None:
    """One bends with the body, the other keeps its resultant."""
    dead = abut.solve(model([abut.Pressure("body.top", 0.06, follows=False)])).steps[-1]
    following = abut.solve(model([abut.Pressure("body.top", 0.06)])).steps[-1]
    assert dead.load == pytest.approx((0.0, -0.12))
    assert following.load[0] < -0.02
    for step in (dead, following):
        assert np.abs(step.load + step.reaction).max() < 1e-9
    small = model([abut.Pressure("body.top", 0.06)], abut.LinearElastic(2.0, 0.3), kinematics="small")
    other = replace(small, loads=[replace(small.loads[0], follows=False)])
    assert np.array_equal(abut.solve(small).displacement, abut.solve(other).displacement)


def test_small_loads_deform_as_under_small_strains() -> None:
    """The difference goes with the load, as its square over it."""
    load = abut.Force("body.right", (0.0, 1e-6))
    one = abut.solve(model([load], abut.LinearElastic(2.0, 0.3), kinematics="small"))
    for material in (abut.LinearElastic(2.0, 0.3), RUBBER):
        other = abut.solve(model([load], material))
        error = np.abs(other.displacement - one.displacement).max() / np.abs(one.displacement).max()
        assert error < 1e-4
        assert np.abs(other.steps[-1].stress - one.steps[-1].stress).max() < 1e-4 * one.steps[-1].stress.max()


def test_energy_is_the_work_of_the_load() -> None:
    """int F du of a dead load that grows with time, by Simpson's rule over many steps."""
    own = model([abut.Force("body.right", (0.05, 0.1))], steps=16)
    run = Run.of(own, lambda _: None, lambda *_: None, None, ())
    run.march(run.restore(()))
    bodies, forces = run.assembled.bodies, run.assembled.loaded.forces[:, 0]
    assert isinstance(bodies, SolidBodies)
    moved = np.array([0.0, *(forces @ step.displacement.ravel() for step in run.steps)])
    times = np.array([0.0, *(step.factor for step in run.steps)])
    third = times[1] / 3.0
    work = moved[-1] - third * (
        moved[0] + 4 * moved[1::2].sum() + 2 * moved[2:-1:2].sum() + moved[-1]
    )  # int t d(moved)
    end = Motion(1.0, run.steps[-1].displacement.ravel())
    energy = bodies.evaluate(end, end).energy
    assert work == pytest.approx(energy, rel=1e-5)


def test_a_cell_turned_inside_out_halves_the_step() -> None:
    """The first attempt presses a cell through itself; smaller ones get there."""
    pushed = model([], steps=1, supports=[*HELD, abut.Support("body.right", x=-1.5, y=0)])
    solution = abut.solve(pushed)
    halved = [note for note in solution.notes if "it goes to time" in note]
    assert halved
    assert "of body 'body' turns inside out (det F = -" in halved[0]
    assert solution.converged
    assert solution.steps[-1].displacement.min() == pytest.approx(-1.5)


def test_what_cannot_be_reached_ends_with_the_last_state() -> None:
    """A row of cells between two walls, pressed to less than nothing: it has no way round. No load step gets there, and what
    is reported is sound."""
    row = join({"body": rectangle((0.0, 2.0), (0.0, 1.0), (4, 1), "quad4")})
    between = [abut.Support(f"body.{side}", y=0) for side in ("top", "bottom")]
    pressed = model([], supports=[abut.Support("body.left", x=0), *between, abut.Support("body.right", x=-2.5)])
    solution = abut.solve(replace(pressed, mesh=row))
    assert not solution.converged
    assert any("did not converge" in note for note in solution.notes)
    assert np.isfinite(solution.displacement).all()
    assert np.isfinite(solution.steps[-1].stress).all()
    assert len(solution.steps) > 1


def test_the_pattern_is_analysed_once() -> None:
    """One set-up for many values, symmetric or not, and another one for another pattern."""
    repeated, rng = Repeated(), np.random.default_rng(7)
    import scipy.sparse as sp

    pattern = sp.random(60, 60, 0.1, random_state=1, format="csr") + sp.identity(60)
    for symmetric in (False, False, True, True, False):
        matrix = pattern.copy().tocsr()
        matrix.data = matrix.data + rng.uniform(0.0, 0.1, matrix.nnz)
        if symmetric:
            matrix = (matrix + matrix.T + 9.0 * sp.identity(60)).tocsr()
        rhs = rng.standard_normal(60)
        given = sp.triu(matrix, format="csr") if symmetric else matrix
        given.sort_indices()
        x = repeated.solve(given, rhs, symmetric=symmetric)
        assert np.abs(matrix @ x - rhs).max() < 1e-10
        assert np.abs(x - solve(given, rhs, symmetric=symmetric)).max() < 1e-8 * np.abs(x).max()


class Own(OwnMaterial):
    modulus = 1.0

    def evaluate(self, strain: np.ndarray, history: np.ndarray) -> tuple:
        return strain, np.broadcast_to(np.eye(6), (len(strain), 6, 6)), history


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"material": Own()}, "Own of body 'body' is a law for small strains"),
        ({"kinematics": "small"}, "NeoHooke of body 'body' is for finite strains"),
        ({"kinematics": "large"}, "expected one of small, finite"),
        ({"supports": [abut.Support("body.left", normal=0.1)]}, "has no meaning once they turn"),
    ],
)
def test_refused(given: dict, words: str) -> None:
    with pytest.raises(InputError, match=words):
        model([], **given)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"young": 1.0}, "expected young and poisson, shear and bulk, or shear and lame; got young"),
        ({}, "got none of them"),
        ({"young": 1.0, "poisson": 0.5}, "poisson"),
        ({"shear": 1.0, "bulk": -1.0}, "bulk: expected a number > 0"),
        ({"shear": 1.0, "lame": -1.0}, "lame: expected more than -2/3 of shear"),
        ({"shear": 0.0, "bulk": 1.0}, "shear: expected a number > 0"),
        ({"shear": 1.0, "bulk": 1.0, "volumetric": "log"}, "volumetric: expected one of"),
        ({"shear": 1.0, "bulk": 1.0, "density": -1.0}, "density"),
    ],
)
def test_constants_refused(given: dict, words: str) -> None:
    with pytest.raises(InputError, match=words):
        abut.NeoHooke(**given)


def test_constants_agree() -> None:
    one = abut.NeoHooke(2.0, 0.3)
    lambda_, mu = one.moduli
    for other in (abut.NeoHooke(shear=mu, lame=lambda_), abut.NeoHooke(shear=mu, bulk=lambda_ + 2 * mu / 3)):
        assert other.moduli == pytest.approx(one.moduli)
        assert other.linear.young == pytest.approx(2.0)
        assert other.linear.poisson == pytest.approx(0.3)


def test_multigrid_without_contact() -> None:
    """The displacements of the direct solver, with a pressure that follows the surface."""
    own = model([abut.Pressure("body.top", 0.06)], steps=2)
    direct, ours = (abut.solve(replace(own, solve=replace(own.solve, linear=kind))) for kind in ("direct", "amg"))
    assert "multigrid" in ours.solver
    assert np.abs(ours.displacement - direct.displacement).max() < 1e-8 * np.abs(direct.displacement).max()


def test_a_run_goes_on_after_any_step() -> None:
    """From the records of steps 1 and 2 to the same end, but for the rounding of another factorisation."""
    own, kept = model([abut.Pressure("body.top", 0.06)], steps=4), []
    whole = abut.solve(own, on_step=lambda _, saved: kept.append(saved))
    again = abut.solve(own, resume=kept[:2])
    assert np.abs(again.displacement - whole.displacement).max() < 1e-12 * np.abs(whole.displacement).max()
    assert np.array_equal(again.steps[1].stress, whole.steps[1].stress)


@pytest.mark.parametrize("kind", ["tri6", "quad8", "quad9"])
def test_stresses_of_a_cell_that_is_sound_at_its_integration_points_only(kind: str) -> None:
    """Near the limit a cell may be inside out where stresses are taken first: they then come from its integration points."""
    mesh = rectangle((0.0, 1.0), (0.0, 1.0), (1, 1), kind)
    solids = Solids(mesh, {"body": RUBBER}, "strain", {}, "finite")
    rng = np.random.default_rng(8)
    found = 0
    for _ in range(2000):
        u = 0.35 * rng.standard_normal(mesh.points.shape)
        try:
            respond(solids, u, tangent=False)
        except Inverted:
            continue
        found += 1
        assert np.isfinite(nodal_stress(solids, u)).all()
    assert found > 5


@pytest.mark.parametrize("cell", ["quad4", "tri6", "hex8", "tet10", "wedge15"])
def test_pressure_all_round_needs_no_support(cell: str) -> None:
    """A free block under a pressure that follows all its sides shrinks alike everywhere, and stays where it is."""
    dim = CELLS[cell].dim
    mesh = join({"body": rectangle((0, 1), (0, 2), (2, 3), cell) if dim == 2 else box(cells=(2, 1, 1), cell=cell)})
    loads = [abut.Pressure(side, 0.5) for side in mesh.surfaces]
    plane = "strain" if dim == 2 else None
    solution = abut.solve(abut.Model(mesh, [abut.Solid("body", RUBBER)], [], loads, plane=plane, kinematics="finite"))
    assert solution.converged
    stress = solution.steps[-1].stress
    assert np.abs(stress[:, :dim] + 0.5).max() < 1e-9
    assert np.abs(stress[:, 3:]).max() < 1e-9
    assert all(check.passed for check in solution.certificate)
