"""Contact at current positions: what large displacements and sliding must keep."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import abut
from abut.contact.coupling import CouplingOptions, couple
from abut.contact.moving_normals import normal_pattern
from abut.contact.slip_points import SlipPoints, slip_now
from abut.errors import InputError
from abut.linear.choice import Direct
from abut.mesh import make
from abut.nonlinear.finite_laws import laws_of
from abut.nonlinear.iteration import advance
from abut.nonlinear.large_steps import extrapolated
from abut.nonlinear.laws import Asked
from abut.problem.frame import PairFrame
from abut.solution import Solution
from abut.solution.state import CLOSED, OPEN, State
from models.sliding import arched, finite, forgetful, sharp, tangent_errors, turned

ANGLE = np.deg2rad(70.0)


def last_state(model: abut.Model) -> tuple[State, State, Solution]:
    """The last two converged states of a run, and the run."""
    states: list[State] = []
    solution = abut.solve(model, on_step=lambda _, saved: states.append(saved.state))
    assert solution.converged
    return states[-2], states[-1], solution


@pytest.mark.parametrize("cell", ["quad4", "quad8"])
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_tangent_is_the_derivative(friction: float, cell: str) -> None:
    """Balance and gaps (slips) against differences, in all displacements at once: geometry, normals, segments, tractions.
    Central differences of quantities of order one leave 1e-9; a term left out shows at 1e-3."""
    assert max(tangent_errors(finite(arched(friction, cell)), 5e-3)) < 1e-8


@pytest.mark.parametrize("pressure", ["auto", "dual"])
def test_tangent_where_slip_counts_at_late_points(pressure: str) -> None:
    """The same where slips count at points that the last state did not cover: all that are covered carry friction."""
    model = arched(0.3)
    problem = finite(replace(model, contacts=[replace(model.contacts[0], pressure=pressure)]))
    before = forgetful(problem, 5e-3)
    system = problem.again(before, before)
    assert system.forgotten is not None
    assert not system.forgotten.any()
    assert max(tangent_errors(problem, 5e-3, before)) < 1e-8


def test_prescribed_displacements_ahead() -> None:
    """What is prescribed until a later time, carried by the tangent: against differences in time at the same unknowns."""
    problem = finite(patch(0.4))  # it prescribes the ends of the interface, too
    pressed = np.random.default_rng(1).uniform(0.0, 50.0, problem.operator.shape[0])
    before = replace(problem.start(), multipliers=pressed)
    frame = problem.ended(before)

    def error(step: float) -> float:
        later = replace(before, time=step)
        ahead, there = problem.ahead(before, frame, later.time), problem.linearise(before, frame, later)
        force, gap = ahead.unbalanced(before) - there.unbalanced(later), ahead.gap(before) - there.gap(later)
        return float(np.abs(force).max() + 100.0 * np.abs(gap).max())

    assert error(5e-4) < 0.3 * error(1e-3)  # of second order


def test_a_long_way_into_the_target_is_seen() -> None:
    """A trial state that overlaps by more than two facets, as a first step may: what moved so far is looked for so far."""
    problem = finite(arched(0.0))
    model, before = problem.model, problem.start()
    moved = np.zeros_like(model.mesh.points)
    moved[model.mesh.nodes_of("upper.bottom"), 1] = -0.95
    trial = replace(before, unknowns=problem.constraints.free.T @ moved.ravel(), time=0.1)
    (kind,) = problem.kinematics
    own = kind.at(PairFrame(), problem.placed(trial)[0], problem.displacement(before))
    middle = own.gap / problem.pairs[0].weight
    assert middle.min() < -0.8


def test_extrapolation() -> None:
    """Twice as far as the last step went: displacements and tractions on a line, pressures no less than none, what is open
    stays open."""
    problem = finite(arched(0.3))
    n = len(problem.pairs[0].space)
    first = replace(problem.start(), time=0.1)
    two = replace(first, time=0.2, unknowns=first.unknowns + 1.0)
    one, p, t = np.zeros(2 * n), np.zeros(2 * n), slice(n, 2 * n)
    one[:3], p[:3] = [3.0, 3.0, 1.0], [1.0, 4.0, 0.0]
    p[t] = 0.5
    status = np.where(np.arange(2 * n) % n < 2, CLOSED, OPEN).astype(np.int8)
    guess = extrapolated(problem, replace(first, multipliers=one), replace(two, multipliers=p, status=status), 0.4)
    assert guess.time == 0.4
    assert np.allclose(guess.unknowns, 3.0)
    assert np.allclose(guess.multipliers[:4], [0.0, 6.0, 0.0, 0.0])
    assert np.allclose(guess.multipliers[n : n + 3], [1.5, 1.5, 0.5])


@pytest.mark.long
def test_momentum() -> None:
    """Forces on both sides add up to none at any state, to rounding; their couple vanishes once the law holds: the
    tractions' is sum t_k G_k, the pressures' is zero at every point."""
    problem = finite(arched(0.3))
    _, state, _ = last_state(arched(0.3))
    system = problem.again(state, state)
    force = (system.pairs[0].rows.T @ state.multipliers).reshape(-1, 2)
    x = system.pairs[0].contactor.points
    size = np.abs(force).sum()
    assert size > 0.1
    assert state.slipping.any()
    assert np.abs(force.sum(axis=0)).max() < 1e-13 * size
    couple_ = float((x[:, 0] * force[:, 1] - x[:, 1] * force[:, 0]).sum())
    assert abs(couple_) < 1e-12 * size


def test_slip_of_a_rigid_motion() -> None:
    """Both bodies turned by 0.7 and moved together, with gaps between them: no slip."""
    model = arched(0.3)
    contactor, target = model.sides(model.contacts[0])
    options = CouplingOptions(reach=1.0, keep_points=True)
    points, normals = SlipPoints.of(contactor, target, 1, options), normal_pattern(contactor)
    assert np.abs(couple(contactor, target, 1, options).gap).max() > 1e-3
    moved = contactor.points @ turned(0.7).T + [3.0, -2.0]
    moving = replace(contactor, points=moved)
    slip = slip_now(points, moving, replace(target, points=moved), normals.at(moving))
    assert np.abs(slip.value).max() < 1e-12
    pushed = contactor.points.copy()
    pushed[contactor.node_ids] += [0.01, 0.0]
    moving = replace(contactor, points=pushed)
    slip = slip_now(points, moving, replace(target, points=pushed), normals.at(moving))
    area = points.moments(len(contactor))
    assert np.allclose(slip.value.sum(), -0.01 * area.sum(), rtol=0.02)  # tau is N turned: -x where N points up


def patch(friction: float) -> abut.Model:
    """Blocks of two meshes whose whole outside but the interface follows one affine motion: squeezed and turned."""
    lower, upper = make.rectangle([0, 2], [0, 1], cells=[5, 3]), make.rectangle([0, 2], [1, 2], cells=[4, 2])
    motion = turned(ANGLE) @ np.diag([1.0, 0.8])

    def u(a: int) -> Any:
        return lambda x: x @ motion[a] - x[:, a]

    outside = ["lower.bottom", "lower.left", "lower.right", "upper.top", "upper.left", "upper.right"]
    return abut.Model(
        make.join({"lower": lower, "upper": upper}), plane="strain", kinematics="finite",
        solids=[abut.Solid("lower", abut.NeoHooke(100.0, 0.3)), abut.Solid("upper", abut.NeoHooke(100.0, 0.3))],
        supports=[abut.Support(name, x=u(0), y=u(1)) for name in outside],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", friction=friction)],
    )  # fmt: skip


@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_patch_turned(friction: float) -> None:
    """One affine motion, finite strain and a turn by 70 degrees: Cauchy's pressure everywhere on the interface."""
    _, _, solution = last_state(patch(friction))
    shear, lame = 100.0 / 2.6, 100.0 * 0.3 / (1.3 * 0.4)
    expected = -(shear + 0.5 * lame) * (0.8**2 - 1.0) / 0.8  # mu (b - 1) / J + lambda (J^2 - 1) / 2 J along the normal
    pressure = solution.contacts[0].pressure
    assert np.nanmax(np.abs(pressure - expected)) < 1e-9 * expected
    motion = turned(ANGLE) @ np.diag([1.0, 0.8])
    x = solution.model.mesh.points
    assert np.abs(solution.steps[-1].displacement - (x @ motion.T - x)).max() < 1e-9


@pytest.mark.long
def test_turned_small_example() -> None:
    """Tiny loads: the pressures of small displacements, whatever rigid motion comes on top."""

    def model(kinematics: str, angle: float) -> abut.Model:
        lower, upper = make.rectangle([0, 2], [0, 1], cells=[6, 3]), make.rectangle([0.5, 1.5], [1, 2], cells=[4, 3])
        turn = turned(angle)

        def u(a: int, push: float) -> Any:
            return lambda x: x @ turn[a] - x[:, a] + push * turn[a, 1] + (1.0 if angle else 0.0)

        return abut.Model(
            make.join({"lower": lower, "upper": upper}), plane="strain", kinematics=kinematics,
            solids=[abut.Solid("lower", abut.LinearElastic(100.0, 0.3)), abut.Solid("upper", abut.LinearElastic(50.0, 0.3))],
            supports=[
                abut.Support("lower.bottom", x=u(0, 0.0), y=u(1, 0.0)),
                abut.Support("upper.top", x=u(0, -1e-7), y=u(1, -1e-7)),
            ],
            contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", pressure="P1")],
        )  # fmt: skip

    small = abut.solve(model("small", 0.0)).contacts[0].multiplier
    for angle in (0.0, np.deg2rad(25.0)):
        _, _, solution = last_state(model("finite", angle))
        assert np.nanmax(np.abs(solution.contacts[0].multiplier - small)) < 1e-6 * np.nanmax(small)


@pytest.mark.long
def test_quadratic_convergence() -> None:
    """Whole steps from a fresh guess end quadratically: what is left falls from below 1e-3 to below 1e-8 at most two
    iterations later."""
    _, _, solution = last_state(arched(0.3))
    for step in solution.steps:
        left = [max(row.residual, row.contact_residual) for row in step.iterations]
        first = next(i for i, value in enumerate(left) if value < 1e-3)
        assert min(left[first : first + 3]) < 1e-8


@pytest.mark.long
def test_sliding_with_friction() -> None:
    """All slips: the traction is the coefficient times the pressure, node by node, against the motion, and every check of
    the certificate but coarse meshes' own passes."""
    _, state, solution = last_state(arched(0.3))
    pair = finite(arched(0.3)).pairs[0]
    pressure, traction = state.multipliers[pair.normal], state.multipliers[pair.tangential]
    slips = state.slipping[pair.normal]
    assert slips.sum() >= 3
    assert np.allclose(np.abs(traction[slips]), 0.3 * pressure[slips], rtol=1e-8)
    assert (traction[slips] > 0.0).all()  # tau points to -x under a normal that points up
    assert solution.steps[-1].reactions["upper.top"][0] > 0.0
    coarse = ("oscillation", "resolution", "faceting", "overlap", "strain", "pressure error")
    coarse += ("sides",)  # the finer side is named as the contactor
    assert [check for check in solution.certificate if not check.passed and check.name not in coarse] == []


@pytest.mark.long
@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_contact_found_again(friction: float) -> None:
    """A block that leaves the edge of the other one keeps its multipliers, open where nothing is opposite; back again,
    without friction, it carries what it did."""
    there = abut.Amplitude(((0.0, 0.0), (0.2, 0.0), (0.6, 1.0), (1.0, 0.0)))
    lower, upper = make.rectangle([0, 2], [0, 1], cells=[5, 3]), make.rectangle([0.5, 1.5], [1, 2], cells=[4, 2])
    model = abut.Model(
        make.join({"lower": lower, "upper": upper}), plane="strain", kinematics="finite",
        solids=[abut.Solid("lower", abut.LinearElastic(100.0, 0.3)), abut.Solid("upper", abut.LinearElastic(100.0, 0.3))],
        supports=[
            abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=1.05, amplitude=there),
            abut.Support("upper.top", y=-0.02, amplitude=abut.Amplitude(((0.0, 0.0), (0.2, 1.0), (1.0, 1.0)))),
        ],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", friction=friction)],
    )  # fmt: skip
    solution = abut.solve(model)
    assert solution.converged
    force = {round(step.factor, 9): step.contacts[0] for step in solution.steps}
    assert force[0.6].multipliers < force[0.2].multipliers
    assert force[0.6].force[1] < 0.8 * force[0.2].force[1]
    if friction:
        assert force[0.6].force[0] < 0.0 < force[1.0].force[0]
    else:
        assert np.allclose(force[1.0].force, force[0.2].force, rtol=1e-7, atol=1e-9)


def test_no_past_no_traction() -> None:
    """A multiplier that nothing was opposite to in the last step carries no friction in this one; its pressure stays."""
    problem = finite(arched(0.3))
    before = replace(problem.start(), time=0.2)
    pair = problem.pairs[0]
    state = before.with_status(np.full(len(pair), CLOSED))
    state = replace(state, multipliers=np.where(np.arange(len(pair)) < len(pair.space), 2.0, 0.4))
    system = problem.linearise(before, problem.ended(before), state)
    assert system.forgotten is not None
    assert not system.forgotten.any()
    mask = np.arange(len(pair)) == pair.tangential.start + 2
    system = replace(system, forgotten=mask)
    after = advance(Direct().prepare(system, None), state, laws_of(system, state, Asked()))
    assert np.abs(after.multipliers[mask]).max() < 1e-14
    assert (after.multipliers[~mask] != 0.0).all()


@pytest.mark.long
def test_what_comes_under_an_edge_is_not_said_to_have_slipped() -> None:
    """Nodes that were hardly covered at the end of the last step have no slip in this one, and no line of the certificate
    finds that they moved while they stick."""
    solution = abut.solve(sharp(0.3, 7))
    assert solution.converged
    assert all(check.passed for check in solution.certificate if check.name == "sticking")


@pytest.mark.long
def test_what_comes_under_an_edge_carries_friction_at_once() -> None:
    """Nodes of a plate under the front edge of a block, where the pressure peaks: the drag is the coefficient times the load
    in every step in which the block slides, to the inclination of the indented plate."""
    solution = abut.solve(sharp(0.3, 9))
    assert solution.converged
    forces = np.array([step.reactions["upper.top"] for step in solution.steps if step.factor > 0.5])
    assert len(forces) >= 4
    assert forces[:, 0] / -forces[:, 1] == pytest.approx(0.3, rel=0.01)


@pytest.mark.long
def test_restart_goes_on_the_same_way() -> None:
    saved: list[Any] = []
    whole = abut.solve(arched(0.3), on_step=lambda _, own: saved.append(own))
    again = abut.solve(arched(0.3), resume=saved[: len(saved) // 2])
    assert [(step.number, step.factor) for step in again.steps] == [(step.number, step.factor) for step in whole.steps]
    assert [len(step.iterations) for step in again.steps] == [len(step.iterations) for step in whole.steps]
    # But for rounding: the direct solver goes by an analysis of its own.
    assert np.abs(again.displacement - whole.displacement).max() < 1e-10 * np.abs(whole.displacement).max()


@pytest.mark.long
def test_analyses_last_over_load_steps() -> None:
    """Facets change as the block slides, but more load steps than analyses: what one leaves serves the next."""
    solution = abut.solve(arched(0.3, solve=abut.SolveOptions(steps=20)))
    (note,) = (note for note in solution.notes if "symbolic" in note)
    factorisations, analyses = (int(number) for number in re.findall(r"\d+", note))
    assert factorisations >= len(solution.steps)
    assert analyses < len(solution.steps)


@pytest.mark.long
def test_too_much_ends_with_words() -> None:
    """Pressed through the other block: no step is short enough, the run keeps the last state that it found and says why."""
    notes: list[str] = []
    model = arched(0.3)
    through = replace(model, supports=[model.supports[0], abut.Support("upper.top", y=-1.8, x=0)])
    solution = abut.solve(through, observer=lambda item: notes.append(item) if isinstance(item, str) else None)
    assert not solution.converged
    assert solution.steps[-2].converged
    assert any("inside out" in note or "iterations" in note for note in notes[-2:])


@pytest.mark.parametrize(
    ("what", "words"),
    [
        ({"method": "node-to-segment"}, "method"),
        ({"pressure": "P2"}, "quadratic"),
    ],
)
def test_refused(what: dict[str, Any], words: str) -> None:
    model = arched(0.0)
    with pytest.raises(InputError, match=words):
        abut.solve(replace(model, contacts=[replace(model.contacts[0], **what)]))


@pytest.mark.long
def test_restrained_friction_alone() -> None:
    """A block that rests on another one by a pressure, and is dragged by less than friction bears: it sticks, and
    the traction is the drag's; by more, and the run, which ends on the way there, says what it is that moves."""
    first, then = (
        abut.Amplitude(((0.0, 0.0), (0.3, 1.0), (1.0, 1.0))),
        abut.Amplitude(((0.0, 0.0), (0.3, 0.0), (1.0, 1.0))),
    )

    def model(drag: float) -> abut.Model:
        lower, upper = make.rectangle([0, 3], [0, 1], cells=[7, 2]), make.rectangle([0.5, 1.5], [1, 2], cells=[4, 3])
        return abut.Model(
            make.join({"lower": lower, "upper": upper}), plane="strain", kinematics="finite",
            solids=[abut.Solid(name, abut.LinearElastic(100.0, 0.3)) for name in ("lower", "upper")],
            supports=[abut.Support("lower.bottom", x=0, y=0)],
            loads=[
                abut.Pressure("upper.top", 3.0, amplitude=first, follows=False),
                abut.Traction("upper.top", [drag, 0.0], amplitude=then),
            ],
            contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", friction=0.3)],
        )  # fmt: skip

    solution = abut.solve(model(0.3))
    assert solution.converged
    assert solution.contacts[0].force[0] == pytest.approx(-0.3, rel=1e-8)
    dragged = abut.solve(model(1.2))
    assert not dragged.converged
    assert dragged.steps[-2].factor < 0.3 + 0.7 * 0.3 * 3.0 / 1.2  # friction is used up there at the latest
    said = [note for note in dragged.notes if "did not converge" in note][-1]
    assert "the loads at time 1 are more than contact bears" in said
    assert "body 'upper' is free to translate along x" in said
