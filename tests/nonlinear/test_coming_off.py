"""How a load step begins where a contact comes off, or seems to, and bodies that are apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import abut
from abut.linear.choice import Direct
from abut.mesh import make
from abut.nonlinear.iteration import Increment
from abut.nonlinear.semismooth import Step, solve_finite
from abut.solution.state import CLOSED, OPEN, State
from models.sliding import arched, finite


def test_a_guess_that_comes_off_does_not_let_go() -> None:
    """Bodies pressed together, and a guess in which they are apart though they touch: the first iteration holds them by the
    nearest points, so that none of them springs back, and ends where it would have from the last state."""
    problem = finite(arched(0.0))
    start, most = problem.start(), 25

    def solved(before: State, guess: State | None, time: float) -> tuple[State, list[float]]:
        step = Step(
            problem, before, problem.ended(before), Direct(), Increment(1, before.largest), most, lambda _: None
        )
        found = solve_finite(step, guess, time)
        assert found.converged
        assert found.system is not None
        end = problem.accepted(before, step.frame, replace(found.state, time=time), found.system)
        return end, [row.penetration for row in found.iterations]

    pressed, _ = solved(start, None, 0.2)
    assert (pressed.status == CLOSED).any()
    held, _ = solved(pressed, None, 0.21)
    away = np.zeros((len(problem.model.mesh.points), 2))
    away[problem.model.mesh.nodes_of("upper.bottom"), 1] = 0.02
    apart = replace(pressed, time=0.21, unknowns=pressed.unknowns + problem.constraints.free.T @ away.ravel())
    apart = replace(apart, multipliers=0.0 * apart.multipliers, status=np.full_like(apart.status, OPEN))
    again, depths = solved(pressed, apart, 0.21)
    assert np.abs(again.unknowns - held.unknowns).max() < 1e-9
    assert max(depths) < 0.05


def test_a_stiff_body_comes_from_afar_to_a_soft_one() -> None:
    """Nothing touches. What double precision leaves of the stiff body's forces is 1e-7 of the scale of the soft one's."""
    soft = make.rectangle([0, 1], [0, 1], cells=[12, 12], cell="quad8")
    stiff = make.rectangle([0, 1], [40, 41], cells=[5, 5], cell="quad4")
    model = abut.Model(
        make.join({"soft": soft, "stiff": stiff}), plane="strain", kinematics="finite",
        solids=[abut.Solid("soft", abut.NeoHooke(5.0, 0.45)), abut.Solid("stiff", abut.LinearElastic(2e5, 0.3))],
        supports=[abut.Support("soft.bottom", x=0, y=0), abut.Support("stiff.top", x=0, y=-38.9)],
        contacts=[abut.Contact(contactor="soft.top", target="stiff.bottom")],
    )  # fmt: skip
    solution = abut.solve(model)
    assert solution.converged
    assert max(len(step.iterations) for step in solution.steps) <= 5
