"""A body that folds until it touches itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.contact.coupling import CouplingOptions, couple
from abut.contact.geometry import facet_sizes
from abut.mesh import make
from abut.mesh.make.block import grid
from abut.mesh.mesh import Mesh
from abut.model import Model
from abut.solution import Solution
from models.folding import RADIUS, THICKNESS, TURNS, accordion, folded
from models.sliding import current, finite, tangent_errors_at

SIDES = ("top", "bottom")
PUSHED = 1.1


@pytest.fixture(scope="module")
def pressed() -> Solution:
    return abut.solve(accordion(PUSHED, sides=SIDES))


@pytest.mark.long
def test_folds_touch(pressed: Solution) -> None:
    """Both valleys close: forces add up to none, no multiplier is left open where its surface overlaps, and at points the
    surfaces overlap by what the corners of the bends press in between nodes, a twentieth of the thickness."""
    assert pressed.converged
    pair = pressed.contacts[0]
    assert pair.area > 3.5  # of 5.1, the sides of two valleys
    checks = {check.name: check.value for check in pressed.certificate}
    assert checks["force balance"] < 1e-12
    assert checks["moment balance"] < 1e-12
    assert checks["penetration"] < 1e-8
    problem = finite(pressed.model)
    kind = current(problem)
    seen = kind.shown(pressed.displacement.ravel()).gap_samples
    assert seen is not None
    assert seen.gap.min() > -0.05 * THICKNESS


def test_either_fold_may_be_the_contactor(pressed: Solution) -> None:
    """A half turn about the middle brings the mesh on itself and reverses all ranks: what was the contactor becomes the
    target. Nothing but the bends holds the middle leg upright; displacements agree to a quarter of a facet."""
    middle = np.array([RADIUS * TURNS, 0.0])
    x = pressed.model.mesh.points
    partner = np.array([int(np.argmin(np.linalg.norm(x - (2.0 * middle - own), axis=1))) for own in x])
    assert np.abs(x[partner] + x - 2.0 * middle).max() < 1e-9
    shift = np.array([-PUSHED, 0.0])
    apart = pressed.displacement + pressed.displacement[partner] - shift
    assert np.abs(apart).max() < 0.25 * np.median(facet_sizes(pressed.contacts[0].contactor))


@pytest.mark.long
def test_friction_between_folds() -> None:
    """What slips carries the coefficient times the pressure; forces of both sides are told apart at common nodes."""
    solution = abut.solve(accordion(PUSHED, sides=SIDES, friction=0.3))
    assert solution.converged
    pair = solution.contacts[0]
    assert pair.friction is not None
    checks = {check.name: check.value for check in solution.certificate}
    assert checks["friction cone"] < 1e-6
    assert checks["force balance"] < 1e-12
    assert pair.friction.slipping_area > 0.0
    assert np.allclose(pair.contactor_forces.sum(axis=0), -pair.target_forces.sum(axis=0), atol=1e-9)
    assert np.allclose(pair.force, pair.contactor_forces.sum(axis=0), atol=1e-9)
    assert -pair.force[0] > 30.0  # it is the normal force of two valleys nearly upright: 52 without friction


def test_tangent_is_the_derivative(pressed: Solution) -> None:
    """Of balance and gaps in the folded state, as between two bodies."""
    problem, rng = finite(pressed.model), np.random.default_rng(5)
    before, n = problem.start(), problem.operator.shape[0]
    free = problem.constraints.free
    unknowns = np.linalg.lstsq(free.toarray(), pressed.displacement.ravel(), rcond=None)[0]
    at = replace(before, time=1.0, unknowns=unknowns, multipliers=rng.uniform(0.0, 5.0, n))
    assert max(tangent_errors_at(problem, at, at, rng.standard_normal(problem.n_free), 1e-7)) < 1e-6


def whole(mesh: Mesh, *sides: str) -> Model:
    return Model(
        mesh, [abut.Solid("body", abut.NeoHooke(young=1.0, poisson=0.3))], [abut.Support("left", x=0.0, y=0.0)],
        contacts=[abut.Contact(contactor=sides, target=sides, name="self")], plane="strain", kinematics="finite",
    )  # fmt: skip


def test_a_body_is_not_in_contact_with_its_far_side() -> None:
    """A thin strip: its other side lies within reach, behind it. Each pair of facets counts once: of the sides of a slit
    the one further along is the target."""
    strip = make.rectangle([0, 4], [0, 0.1], (16, 1))
    contactor, target = whole(strip, "top", "bottom").sides(whole(strip, "top", "bottom").contacts[0])
    far = CouplingOptions(reach=1.0, keep_points=True)
    assert couple(contactor, target, 1, far).segments.sum() == 0
    bare = couple(replace(contactor, kin=None), replace(target, kin=None), 1, far)
    assert bare.segments.sum() > 0
    model = accordion(sides=SIDES)
    at = couple(*model.sides(model.contacts[0]), 1, far).points
    assert at is not None
    pairs = set(zip(at.facet.tolist(), at.target_facet.tolist()))
    assert pairs
    assert not any((other, own) in pairs for own, other in pairs)
    assert (at.gap > 0.0).all()


def test_folds_in_space() -> None:
    """A folded plate, 3D: of every two facets in a valley one sees the other, along the whole valley, and no gap is
    through the plate."""
    lines = [np.linspace(0.0, 1.0, 31), np.linspace(-0.5, 0.5, 2) * THICKNESS, np.linspace(0.0, 1.0, 3)]
    mesh = grid(lines, "hex8", lambda x: np.column_stack([folded(x[:, :2]), x[:, 2]]))
    model = Model(
        mesh, [abut.Solid("body", abut.NeoHooke(young=1.0, poisson=0.3))], [abut.Support("left", x=0, y=0, z=0)],
        contacts=[abut.Contact(contactor="body", target="body", name="self")], kinematics="finite",
    )  # fmt: skip
    at = couple(*model.sides(model.contacts[0]), 1, CouplingOptions(reach=0.7, keep_points=True)).points
    assert at is not None
    pairs = set(zip(at.facet.tolist(), at.target_facet.tolist()))
    assert not any((other, own) in pairs for own, other in pairs)
    assert (at.gap > 0.0).all()
    assert at.weight.sum() > 2.0 * 2.0  # two valleys, legs 2 long, 1 deep


def test_small_displacements_do_not_fold() -> None:
    with pytest.raises(abut.InputError, match=r'the same surface .* kinematics = "finite"'):
        replace(accordion(), kinematics="small", solids=[abut.Solid("strip", abut.LinearElastic(1.0, 0.3))])


def test_folded() -> None:
    """The model's strip has its thickness everywhere."""
    x = np.linspace(0.0, 1.0, 200)
    sides = [folded(np.stack([x, np.full_like(x, side * THICKNESS)], axis=1)) for side in (-0.5, 0.5)]
    assert np.allclose(np.linalg.norm(sides[1] - sides[0], axis=1), THICKNESS)
