"""Steps that a drag leads: an arch that snaps through under a dead force, a ball that contact holds by one node a side."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.analysis.linear_solvers import linear_solver
from abut.diagnosis.cures import cures
from abut.nonlinear.drag import Drag, dragged, scale
from abut.nonlinear.one_step import Setting, is_gone, stabilised
from abut.nonlinear.settings import DEFAULT
from abut.output.contact_rows import energy_columns, energy_row
from abut.problem.stabilising import is_dragged, with_drag
from abut.solution import Saved, Solution
from models.arches import FORCE, RISE, ROLLED, SPAN, THICKNESS, arch, ball
from models.sliding import finite

AGREES = 3e-3  # forces and energies of an arch whose punch may tilt by its facets, held along its whole top or free
TRAPEZOID = 0.07  # of the energy that a jump sets free: means of forces over some ten parts of it


@pytest.fixture(scope="module")
def pushed() -> tuple[Solution, list[Saved]]:
    saved: list[Saved] = []
    return abut.solve(arch(FORCE), on_step=lambda _, step: saved.append(step)), saved


def crown(solution: Solution) -> float:
    """Way of the arch's crown down."""
    at = np.abs(solution.model.mesh.points - [0.0, RISE + THICKNESS / 2]).sum(axis=1)
    return -float(solution.displacement[np.flatnonzero(at < 1e-9)].min())


@pytest.mark.long
def test_an_arch_snaps_through(pushed: tuple[Solution, list[Saved]]) -> None:
    """What is reached is an equilibrium without a drag: a punch moved by the same way takes the same force."""
    solution, saved = pushed
    assert solution.converged
    assert crown(solution) > 1.5 * RISE
    assert sum(is_dragged(step.state) for step in saved) == 1
    assert not any(is_dragged(step.state) and step.state.history.drag.any() for step in saved)
    top = solution.model.mesh.nodes_of("punch")
    moved = abut.solve(arch(way=-float(solution.displacement[top, 1].mean())))
    assert moved.contacts[0].force[1] == pytest.approx(FORCE, rel=AGREES)
    assert moved.steps[-1].energy.elastic == pytest.approx(solution.steps[-1].energy.elastic, rel=AGREES)  # type: ignore[union-attr]


@pytest.mark.long
def test_energy_that_a_jump_sets_free(pushed: tuple[Solution, list[Saved]]) -> None:
    """The work of a dead force is the force by its way. What of it is not stored the drag has taken, and it is said."""
    solution, _ = pushed
    jumps = [step for step in solution.steps if step.energy is not None and step.energy.stabilisation]
    (energy,) = [step.energy for step in jumps]
    assert energy is not None
    assert energy.stabilisation == pytest.approx(energy.loads - energy.stored, rel=TRAPEZOID)
    assert energy.error < energy.limit
    assert energy_row(jumps[0])["energy_stabilisation"] == energy.stabilisation
    assert "energy_stabilisation" in energy_columns(finite=True)
    (told,) = [note for note in solution.notes if "by a drag on all motion" in note]
    assert f"it took {energy.stabilisation:.3g} of energy" in told
    failed = {check.name: text for check, text in cures(solution)}
    assert "prescribe a displacement instead of the force" in failed["stabilisation"]


def test_going_on_after_a_jump(pushed: tuple[Solution, list[Saved]]) -> None:
    """From the records of the steps up to it, as a run that was not interrupted."""
    solution, saved = pushed
    jump = next(i for i, step in enumerate(saved) if is_dragged(step.state))
    again = abut.solve(arch(FORCE), resume=saved[: jump + 1])
    assert [step.factor for step in again.steps] == pytest.approx([step.factor for step in solution.steps], rel=1e-12)
    assert np.abs(again.displacement - solution.displacement).max() < 1e-8 * crown(solution)
    for one, other in zip(again.steps, solution.steps):
        assert one.energy is not None
        assert other.energy is not None
        assert one.energy.stabilisation == pytest.approx(other.energy.stabilisation, rel=1e-6)


def test_no_drag_where_none_is_needed() -> None:
    """A run that converges without has neither its energy nor its lines."""
    solution = abut.solve(arch(way=0.1))
    assert solution.converged
    assert all(step.energy is not None and step.energy.stabilisation == 0.0 for step in solution.steps)
    assert "stabilisation" not in {check.name for check in solution.certificate}


@pytest.mark.long
def test_a_ball_on_one_node_rolls_half_as_far_as_its_plate() -> None:
    """Nothing resists its spin, and at first nothing at all: every step under a drag, which is gone at its end. Where it
    sticks to both plates its middle goes half the way."""
    problem = finite(ball())
    setting = Setting(problem, linear_solver("direct", problem, None), 1, 25, lambda _: None)
    states, ends = [problem.start()], (0.15, 0.3, 0.5, 0.6, 0.8, 1.0)
    for time in ends:
        led = stabilised(setting, states[-1], time)
        assert led.converged, led.attempts[-1].reason
        assert [part.whole for part in led.attempts] == [False] * (len(led.attempts) - 1) + [True]
        states.append(led.attempts[-1].state)
        assert np.abs(states[-1].history.drag).max() <= DEFAULT.newton.balanced * states[-1].largest.force
    middle = problem.model.mesh.points.tolist().index([0.0, 0.0, 0.0])
    ways = {state.time: problem.displacement(state)[3 * middle : 3 * middle + 3] for state in states}
    assert ways[1.0][0] - ways[0.5][0] == pytest.approx(0.5 * ROLLED, rel=0.01)
    assert abs(ways[1.0][1] - ways[0.5][1]) < 0.01 * ROLLED
    assert states[-1].multipliers.max() > 1.0


def test_a_drag_in_the_equations() -> None:
    """It resists the way since its anchor, exactly: the residual's change by displacements is that of the stiffness."""
    problem = finite(arch(way=0.1))
    state = problem.start()
    system = problem.again(state, state)
    size = scale(system)
    drag = Drag(0.1 * size, state.unknowns - 1e-3)
    moved = replace(state, unknowns=state.unknowns + np.random.default_rng(2).standard_normal(len(size)))
    with_it, without = (each.unbalanced(moved) for each in (dragged(system, drag), system))
    assert np.allclose(with_it - without, drag.force(moved.unknowns), rtol=1e-9, atol=1e-12 * float(size.max()))
    assert dragged(system, None) is system
    assert (size > 0.0).all()


def test_a_drag_is_kept_in_the_state() -> None:
    state = finite(arch(way=0.1)).start()
    assert not is_dragged(state)
    force = np.arange(len(state.unknowns), dtype=float)
    held = with_drag(state, force)
    assert np.array_equal(held.history.drag, force)
    assert not is_dragged(with_drag(held, None))


def test_bodies_that_are_gone() -> None:
    """After twice the size of the model."""
    problem = finite(arch(way=0.1))
    state = problem.start()
    for ways, expected in ((1.9, False), (2.1, True)):
        assert (
            is_gone(problem, state, replace(state, unknowns=state.unknowns + ways * SPAN), DEFAULT.holding.gone)
            is expected
        )
