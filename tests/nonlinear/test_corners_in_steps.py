"""Load steps meet the corners of amplitudes where the way matters."""

from __future__ import annotations

import pytest

import abut
from abut.mesh.make import join, rectangle

THERE_AND_BACK = abut.Amplitude(((0.0, 0.0), (0.5, 1.0), (1.0, 0.0)))
AT_ONCE = abut.Amplitude(((0.0, 0.0), (0.25, 1.0), (1.0, 1.0)))


def pushed(friction: float = 0.3, **solve: object) -> abut.Model:
    """A block under a pressure of 10 (Poisson's ratio 0), pushed to and fro on one that is held."""
    mesh = join({"base": rectangle((0, 4), (0, 1), (8, 2)), "block": rectangle((1, 3), (1, 2), (4, 2))})
    return abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(1000.0, 0.0)) for body in mesh.bodies],
        [abut.Support("base.bottom", x=0, y=0), abut.Support("block.top", x=0.2, amplitude=THERE_AND_BACK)],
        [abut.Pressure("block.top", 10.0, AT_ONCE)],
        [abut.Contact("block.bottom", "base.top", friction=friction)],
        plane="strain",
        solve=abut.SolveOptions(**solve),
    )


@pytest.mark.parametrize("solve", [{}, {"steps": 1}, {"times": (1.0,)}, {"steps": 3}])
def test_friction_knows_the_way(solve: dict[str, object]) -> None:
    """Slid forth and back it pulls back with all it has, mu N = 0.3 * 20, though the ends alone are no motion at all."""
    solution = abut.solve(pushed(**solve))
    assert {0.25, 0.5, 1.0} <= {step.factor for step in solution.steps}
    assert solution.contacts[0].force[0] == pytest.approx(6.0, rel=1e-6)
    assert solution.contacts[0].force[1] == pytest.approx(20.0, rel=1e-9)
    assert all(check.passed for check in solution.certificate)


def test_where_only_the_end_counts_steps_are_those_given() -> None:
    """Without friction, and up to the last time that is asked for with it."""
    assert pushed(friction=0.0).ends == (1.0,)
    assert pushed(times=(0.4,)).ends == (0.25, 0.4)
    assert pushed(steps=4).ends == (0.25, 0.5, 0.75, 1.0)
    assert pushed(times=(0.25 + 1e-13, 1.0)).ends == (0.25 + 1e-13, 0.5, 1.0)
