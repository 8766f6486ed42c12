"""Where the target ends within facets of the contactor: functions that it hardly covers follow their neighbours."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.job.load import load_job
from abut.problem.frame import Frame
from abut.solution.state import State
from models.overhanging import crossed, pressed
from models.sliding import finite, tangent_errors

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.mark.parametrize(
    ("cell", "space", "covered"),
    [
        ("quad4", "P1", 0.02), ("quad4", "P1", 0.3), ("quad4", "P0", 0.02), ("quad8", "P2", 0.1), ("quad8", "P2", 0.3),
        ("quad8", "P1-discontinuous", 0.02), ("hex8", "P1", 0.1), ("tet10", "P2", 0.02),
    ],
)  # fmt: skip
def test_pressures_are_those_of_small_displacements(cell: str, space: str, covered: float) -> None:
    """Under a tiny load: the difference is of the order of the strain, that is of the largest pressure over E = 1. Nodes
    beyond the edge that kept pressures of their own would carry a tenth of the force."""
    small, large = (
        abut.solve(pressed(cell, covered, kind, space, 1e-7)).steps[-1].contacts[0] for kind in ("small", "finite")
    )
    highest = float(np.nanmax(small.pressure))
    assert np.nanmax(np.abs(large.pressure - small.pressure)) < 5.0 * highest**2
    assert not [check for check in large.checks if check.name == "force at the target's edge"]


def test_two_rings_at_large_displacements() -> None:
    """The example's certificate holds with finite kinematics, too, and each ring carries what it does with small
    displacements and the same functions, up to the strain (1e-4)."""
    model = load_job(EXAMPLES / "two-rings" / "job.toml").model
    model = replace(model, contacts=[replace(contact, pressure="P1") for contact in model.contacts])
    small, large = (
        abut.solve(replace(model, kinematics=kind, solve=abut.SolveOptions(steps=1))).steps[-1]
        for kind in ("small", "finite")
    )
    assert all(check.passed for contact in large.contacts for check in contact.checks)
    for one, other in zip(small.contacts, large.contacts):
        for ring, force in one.body_forces.items():
            assert other.body_forces[ring] == pytest.approx(force, abs=1e-4 * np.linalg.norm(one.force))


@pytest.mark.long
@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("cell", ["quad4", "hex8"])
def test_a_sharp_block_slides_across(cell: str, friction: float) -> None:
    """As the block's edges pass node after node, no node that is hardly covered carries a part of the force, which without
    friction stays what it is between nodes, to the few per cent that facets make of it. (Friction is missing in the steps in
    which nodes come under the block.)"""
    solution = abut.solve(crossed(cell, friction))
    assert solution.converged
    names = {check.name for step in solution.steps for check in step.contacts[0].checks if not check.passed}
    assert "force at the target's edge" not in names
    forces = np.array([step.contacts[0].resultant.force[-1] for step in solution.steps if step.factor > 0.2])
    assert np.ptp(forces) < (0.15 if friction else 0.05) * np.abs(forces).mean()


@pytest.mark.parametrize(
    ("cell", "friction", "space"), [("quad4", 0.3, "auto"), ("quad4", 0.3, "dual"), ("hex8", 0.3, "dual")]
)
def test_derivatives_of_functions_that_follow(cell: str, friction: float, space: str) -> None:
    """Against central differences, with others of their neighbours' pressures and tractions; what is left of them does
    nothing."""
    model = crossed(cell, friction)
    problem = finite(replace(model, contacts=[replace(model.contacts[0], pressure=space)]))
    before = problem.start()
    frame = problem.frame(before)
    begin, to = problem.handed(before, problem.ended(before), frame), frame.pairs[0].following
    assert to is not None
    assert max(tangent_errors(problem, 2e-3, begin, frame)) < (1e-8 if cell == "quad4" else 1e-7)
    pair = problem.pairs[0]
    mute = pair.of_functions(to != np.arange(len(to)))
    assert not np.abs(problem.linearise(begin, frame, begin).pushing[mute]).sum()


@pytest.mark.parametrize(("offset", "overlaps"), [(-1e-3, True), (1e-3, False)])
def test_functions_follow_where_a_guess_overlaps(offset: float, overlaps: bool) -> None:
    """Contact that is still open and will close, since surfaces overlap in the guess: the same functions follow as where it
    is closed, and none where surfaces are apart."""
    model = crossed("quad4", 0.0)
    problem = finite(replace(model, contacts=[replace(model.contacts[0], offset=offset)]))
    before = problem.start()
    none, all_of_them = (before.with_closed(np.full(len(before.status), closed)) for closed in (False, True))
    closed, found = (problem.frame(none, guess).pairs[0].following for guess in (all_of_them, none))
    assert closed is not None
    assert (found is not None) == overlaps
    assert found is None or np.array_equal(found, closed)


def test_pressures_are_handed_over() -> None:
    """A function that begins to follow has no multiplier any more, one that ends to has those of the one that it followed:
    the forces do not change."""
    problem = finite(crossed("hex8", 0.3))
    before = problem.start()
    outset, there = problem.ended(before), problem.frame(before)
    rng = np.random.default_rng(1)
    pressed = replace(before, multipliers=rng.uniform(1.0, 2.0, len(before.multipliers)))
    led = problem.handed(pressed, outset, there)
    (part,) = there.pairs
    assert part.following is not None
    own = Frame((replace(part, following=np.arange(len(part.following))),))
    back = problem.handed(led, there, own)

    def force(state: State, frame: Frame) -> np.ndarray:
        system = problem.linearise(state, frame, state)
        assert system.pushing is not None
        return system.pushing.T @ state.multipliers

    assert (led.multipliers == 0.0).any()
    assert (back.multipliers != 0.0).all()
    assert force(back, own) == pytest.approx(force(led, there), abs=1e-12 * np.abs(force(led, there)).max())


@pytest.mark.parametrize("cell", ["quad4", "quad8"])
def test_what_is_apart_at_the_outset_is_open(cell: str) -> None:
    """A gap of 0.005 of a facet is no contact, however little of a function's support the target covers; 0.0005 is one."""
    model = pressed(cell, 0.1, "finite", "auto", 1e-7)
    size, touching = finite(model).pairs[0].size, []
    for gap in (0.005, 0.0005):
        from_the_start = replace(
            model.contacts[0], offset=gap * size, amplitude=abut.Amplitude(((0.0, 1.0), (1.0, 1.0)))
        )
        touching.append(finite(replace(model, contacts=[from_the_start])).start().closed.any())
    assert touching == [False, True]
