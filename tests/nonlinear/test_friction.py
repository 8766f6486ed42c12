"""Coulomb friction: patch tests, Cattaneo and Mindlin, blocks on planes, the way of the load, and what holds a body."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import trapezoid

import abut
from abut.contact.laws import Coulomb, LawState
from abut.errors import InputError, SingularModelError
from abut.linear import static_condensation
from abut.mesh import make
from models.friction import FRICTION, cattaneo, errors, on_a_slope, profile, pushed, sheared
from models.patch import CELL_OF, two_blocks

PLANE = ("tri3", "tri6", "quad4", "quad8", "quad9")
FLAT_CELLS, SOLID_CELLS = ((5, 3), (7, 3)), ((2, 3, 2), (3, 2, 2))
EXACT = 1e-10
STICK, SLIDE = 0.2, 1e-3  # shear over pressure, below friction; displacement of the top beyond the shear that slips


@pytest.mark.parametrize(("contactor", "target"), list(itertools.product(PLANE, PLANE)))
@pytest.mark.parametrize("slides", [False, True], ids=["sticks", "slips"])
def test_patch_in_2d(contactor: str, target: str, slides: bool) -> None:
    check_patch(two_blocks(contactor, target, FLAT_CELLS), slides)


@pytest.mark.parametrize(("contactor", "target"), list(itertools.product(CELL_OF, CELL_OF)))
@pytest.mark.parametrize("slides", [False, True], ids=["sticks", "slips"])
def test_patch_in_3d(contactor: str, target: str, slides: bool) -> None:
    check_patch(two_blocks(CELL_OF[contactor], CELL_OF[target], SOLID_CELLS), slides)


@pytest.mark.parametrize("pressure", ["P1", "P2"])
@pytest.mark.parametrize("slides", [False, True], ids=["sticks", "slips"])
def test_patch_with_other_pressures(pressure: str, slides: bool) -> None:
    check_patch(two_blocks("hex20", "tet10", SOLID_CELLS), slides, pressure=pressure)


def check_patch(mesh: abut.Mesh, slides: bool, **contact: object) -> None:
    """A uniform shear below the cone sticks, and one that slips is the coefficient times the pressure: both are constant
    and in the space, so that nothing but rounding is left."""
    size, slide = (FRICTION, SLIDE) if slides else (STICK, None)
    *far, solution = errors(sheared(mesh, size, slide, **contact), size, slide)
    assert max(far) < EXACT
    friction = solution.contacts[0].friction
    covered = solution.contacts[0].contactor.nodes >= 0
    assert (friction.status[covered] == (2 if slides else 1)).all()
    moved = np.linalg.norm(friction.slip[covered], axis=1)
    # The contactor stays behind the target: its slip is the displacement of the top, opposite to the traction's work.
    assert np.abs(moved - (slide or 0.0)).max() < 1e-8 * SLIDE
    assert all(check.passed for check in solution.certificate)


def test_rough_surfaces_never_slip() -> None:
    *far, _ = errors(sheared(two_blocks("quad8", "quad4", FLAT_CELLS), 2.0, friction="rough"), 2.0)
    assert max(far) < EXACT


def test_both_direct_solvers_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    """Condensed and whole equations: the same but for rounding."""
    condensed = abut.solve(pushed())
    monkeypatch.setattr(static_condensation, "LARGEST", 0)
    whole = abut.solve(pushed())
    assert "condensed" in condensed.notes[-1]
    assert "condensed" not in whole.notes[-1]
    assert np.abs(whole.displacement - condensed.displacement).max() < 1e-10 * np.abs(whole.displacement).max()


def test_law_against_differences() -> None:
    """Derivatives of slip, 3D: central differences, whose error is the square of the step and rounding over the step."""
    law, rng = Coulomb(stiffness=3.0, friction=0.4), np.random.default_rng(1)
    jump, traction = 0.1 * rng.standard_normal((20, 3)), 3.0 * rng.standard_normal((20, 3))
    traction[:, 0] = 4.0 + traction[:, 0] / 3.0
    state = LawState(np.ones(20, bool), slipping=np.ones(20, bool))
    trial = traction[:, 1:] - 3.0 * jump[:, 1:]
    beyond = np.linalg.norm(trial, axis=1) > 0.4 * (traction[:, 0] - 3.0 * jump[:, 0])  # else they stick
    at, step = law.evaluate(jump, traction, state), 1e-5
    assert beyond.sum() > 5
    for component in range(3):
        shift = step * np.eye(3)[component]
        by_jump = (
            law.evaluate(jump + shift, traction, state).residual - law.evaluate(jump - shift, traction, state).residual
        )
        by_traction = (
            law.evaluate(jump, traction + shift, state).residual - law.evaluate(jump, traction - shift, state).residual
        )
        assert np.abs(by_jump / (2 * step) - at.by_jump[:, :, component])[beyond].max() < 1e-8
        assert np.abs(by_traction / (2 * step) - at.by_traction[:, :, component])[beyond].max() < 1e-8


def test_a_closed_point_that_is_still_open_ends_with_its_friction() -> None:
    """The linear problem of a point that is to close and to slip: its gap is open, far more than its pressure presses. Where
    the gap then vanishes the traction is mu times the pressure, whatever that is: the law is linear there but for the
    direction, which does not turn in 2D."""
    law, pressure = Coulomb(stiffness=3.0, friction=0.4), 0.7
    jump, traction = np.array([[0.5, 0.2]]), np.zeros((1, 2))
    at = law.evaluate(jump, traction, LawState(np.ones(1, bool), slipping=np.ones(1, bool)))
    closing = np.array([-jump[0, 0], 0.0])
    left = at.residual[0] + at.by_jump[0] @ closing
    found = np.linalg.solve(at.by_traction[0][1:, 1:], -(left[1:] + at.by_traction[0][1:, 0] * pressure))
    assert left[0] == pytest.approx(0.0, abs=1e-15)
    assert found[0] == pytest.approx(-0.4 * pressure, rel=1e-12)


def test_cattaneo_and_mindlin() -> None:
    """A cylinder pressed on a block of its own material, then pushed: sticks in the middle, slips beside it. The formulas
    are those of half spaces; the blocks are nine contact widths wide, which costs about one per cent."""
    solution = abut.solve(cattaneo("quad4", 14))  # 20 facets over the contact
    assert solution.converged
    x, drag, status, exact = profile(solution)
    facet = float(np.diff(np.unique(np.round(x[np.abs(x) < exact.half_width], 12))).min())
    assert 19.0 < 2.0 * exact.half_width / facet < 22.0
    assert np.interp(0.0, x, drag) == pytest.approx(exact.traction(np.zeros(1))[0], rel=0.02)
    assert drag.max() == pytest.approx(exact.traction(x).max(), rel=0.02)
    stuck = np.abs(x[status == 1])
    assert stuck.max() == pytest.approx(exact.stick, abs=facet)
    near = np.abs(x) < 1.1 * exact.half_width
    far = trapezoid((drag - exact.traction(x))[near] ** 2, x[near])
    assert far < 0.05**2 * trapezoid(exact.traction(x[near]) ** 2, x[near])
    assert all(check.passed for check in solution.certificate)


def test_largest_traction_of_cattaneo_and_mindlin() -> None:
    """It stands at the edge of stick, in a kink, where hardly ever a node is: a mesh four times as fine for 2 %."""
    solution = abut.solve(cattaneo("quad4", 56))
    _, drag, _, exact = profile(solution)
    assert drag.max() == pytest.approx(exact.traction(np.array([exact.stick]))[0], rel=0.02)


@pytest.mark.parametrize("share", [0.9, 0.99, 0.9999])
def test_block_on_a_slope_below_the_angle_of_friction(share: float) -> None:
    """Friction alone holds it: the contact carries the whole weight."""
    angle = share * np.arctan(FRICTION)
    solution = abut.solve(on_a_slope(angle))
    force = solution.contacts[0].force
    assert solution.converged
    assert force / np.linalg.norm(force) == pytest.approx([-np.sin(angle), np.cos(angle)], abs=1e-9)
    assert all(check.passed for check in solution.certificate)


def test_block_on_a_slope_above_the_angle_of_friction() -> None:
    with pytest.raises(
        SingularModelError, match=r"body 'upper' is free to translate along x: .* friction only up to its coefficient"
    ):
        abut.solve(on_a_slope(1.001 * np.arctan(FRICTION)))


def test_sliding_block_drags_with_its_coefficient() -> None:
    """Pushed on by its top: from where all slips the tangential force is the coefficient times the normal one."""
    solution = abut.solve(pushed(far=0.05))
    force = solution.steps[2].contacts[0].force  # at the far end of the push
    assert force[0] == pytest.approx(-FRICTION * force[1], rel=1e-9)
    assert solution.steps[2].contacts[0].friction.sticking_area == 0.0
    home = (
        solution.steps[3].contacts[0].force
    )  # its top is back where it began: it has slid back, and is dragged that way
    assert home[0] == pytest.approx(FRICTION * home[1], rel=1e-9)


def test_load_reversal() -> None:
    """Pushed to and fro by as much: friction the other way round, in the mirror (the meshes are mirrored themselves)."""
    solution = abut.solve(pushed())
    there, back = (solution.steps[i].contacts[0] for i in (2, 4))
    assert there.friction.slipping_area > 0.2
    assert there.friction.sticking_area > 0.2
    assert back.force == pytest.approx([-there.force[0], there.force[1]], rel=1e-6)
    halfway = solution.steps[3].contacts[0]
    assert halfway.friction.sticking_area > there.friction.sticking_area  # it sticks again as it turns round
    work = [step.contacts[0].friction.work for step in solution.steps]
    assert min(work) >= 0.0
    assert all(check.passed for check in solution.certificate)


def test_slip_adds_up_over_steps() -> None:
    solution = abut.solve(pushed())
    parts = sum(step.contacts[0].friction.slip for step in solution.steps)
    closed = np.all([step.contacts[0].friction.status == 1 for step in solution.steps[:1]], axis=0)
    total = solution.contacts[0].friction.total_slip
    inside = closed & np.isfinite(total[..., 0])
    assert inside.any()
    assert np.abs(parts - total)[inside].max() < 1e-12


def test_restart_gives_the_whole_run() -> None:
    saved: list = []
    whole = abut.solve(pushed(), on_step=lambda _, step: saved.append(step))
    again = abut.solve(pushed(), resume=saved[:3])
    assert np.array_equal(whole.displacement, again.displacement)
    one, other = (solution.contacts[0].friction for solution in (whole, again))
    assert np.array_equal(one.total_slip, other.total_slip, equal_nan=True)


def test_one_contact_among_others() -> None:
    """None in the first contact, a tie in the second, friction in the third. The push is so large that Newton's method
    starts once more from the solution without friction."""
    parts = {name: make.rectangle([0, 1], [i, i + 1], cells=[3 + i, 3]) for i, name in enumerate("abcd")}
    model = abut.Model(
        make.join(parts),
        [abut.Solid(name, abut.LinearElastic(1e3, 0.3)) for name in parts],
        [abut.Support("a.bottom", x=0, y=0), abut.Support("d.top", x=0.1), abut.Support("b.left", x=0)],
        [abut.Pressure("d.top", 1.0)],
        [
            abut.Contact(contactor="a.top", target="b.bottom"),
            abut.Contact(contactor="b.top", target="c.bottom", kind="tied"),
            abut.Contact(contactor="c.top", target="d.bottom", friction=0.1),
        ],
        plane="strain",
    )
    solution = abut.solve(model)
    assert solution.converged
    assert solution.contacts[0].force[0] == pytest.approx(0.0, abs=1e-12)
    assert abs(solution.contacts[2].force[0]) == pytest.approx(0.1, rel=1e-9)  # all of it slips
    assert [contact.friction is None for contact in solution.contacts] == [True, True, False]


def test_no_traction_across_a_plane_of_symmetry() -> None:
    """A quarter of a ball pressed into softer ground: at the planes the slip is along them, in the axis there is none."""
    ball = make.sphere_octant(8.0, (0.0, 0.0, 8.0), fine=1.1, cells=6, growth=2.0, cell="hex8")
    ground = make.box((0.0, 8.0), (0.0, 8.0), (-4.0, 0.0), (6, 6, 3), cell="hex8", fine={"x": [0, 1.2], "y": [0, 1.2]})
    supports = [abut.Support(on, **{axis: 0}) for on, axis in (
        ("ground.left", "x"), ("ground.front", "y"), ("ball.x0", "x"), ("ball.y0", "y"))]  # fmt: skip
    model = abut.Model(
        make.join({"ball": ball, "ground": ground}),
        [abut.Solid("ball", abut.LinearElastic(1e3, 0.3)), abut.Solid("ground", abut.LinearElastic(200.0, 0.1))],
        [abut.Support("ground.bottom", x=0, y=0, z=0), *supports],
        [abut.Force("ball.z0", (0.0, 0.0, -5.0))],
        [abut.Contact(contactor="ground.top", target="ball.round", friction=0.1)],
    )
    contact = abut.solve(model).contacts[0]
    nodes = np.maximum(contact.contactor.nodes, 0)
    x = contact.contactor.points[nodes]
    traction = np.where(contact.contactor.nodes[..., None] >= 0, contact.friction.traction, 0.0)
    assert np.abs(traction).max() > 0.01
    for axis in (0, 1):
        assert np.abs(traction[x[..., axis] < 1e-9][:, axis]).max() < 1e-12  # but for the frame's rounding


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"friction": -0.1}, "friction: expected a coefficient >= 0"),
        ({"friction": "smooth"}, 'a coefficient >= 0, .* "rough", or pairs'),
        ({"friction": 0.2, "kind": "tied"}, "a tie holds in all directions"),
        ({"friction": 0.2, "method": "node-to-segment"}, "method segment-to-segment"),
    ],
)
def test_refused(options: dict, words: str) -> None:
    with pytest.raises(InputError, match=words):
        abut.Contact(contactor="a", target="b", **options)


def test_no_friction_is_the_contact_without() -> None:
    model = pushed(friction=0.0)
    plain = replace(model, contacts=[replace(model.contacts[0], friction=0)])
    assert abut.solve(model).contacts[0].friction is None
    assert np.array_equal(abut.solve(model).displacement, abut.solve(plain).displacement)
