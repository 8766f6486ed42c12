"""Metal that is pulled by its supports alone: forces are judged against those there."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.mesh.make import box

YOUNG, YIELD, HARDENING, PULLED = 210e3, 300.0, 2000.0, 0.0015


@pytest.mark.parametrize("kinematics", ["small", "finite"])
@pytest.mark.parametrize("poisson", [0.0, 0.3])
def test_nothing_presses_on_what_is_free(kinematics: str, poisson: float) -> None:
    """In uniaxial tension, beyond yield in the last of five steps. With Poisson's ratio 0 no force on a free displacement is
    more than rounding, which has nothing to be compared with but the reaction. By hand: sigma = Y + H e_p, e = sigma / E
    + e_p; at finite strains logarithmic, and forces that of Kirchhoff's stress over the stretch."""
    sides = [abut.Support("left", x=0), abut.Support("front", y=0), abut.Support("bottom", z=0)]
    model = abut.Model(
        box(cells=(1, 1, 1)), [abut.Solid("body", abut.Plastic(YOUNG, poisson, YIELD, HARDENING))],
        [*sides, abut.Support("right", x=PULLED)], kinematics=kinematics, solve=abut.SolveOptions(steps=5),
    )  # fmt: skip
    solution = abut.solve(model)
    assert solution.converged
    assert [step.iterations[-1].residual < 1e-9 for step in solution.steps] == [True] * 5
    assert max(len(step.iterations) for step in solution.steps) <= 5
    strain = np.log1p(PULLED) if kinematics == "finite" else PULLED
    stress = (YIELD + HARDENING * strain) / (1.0 + HARDENING / YOUNG)
    force = stress / (1.0 + PULLED) if kinematics == "finite" else stress
    right = model.mesh.nodes_of("right")
    step = solution.steps[-1]
    assert np.abs(step.stress[:, 1:]).max() < 1e-9 * stress
    assert step.nodal_reaction[right, 0].sum() == pytest.approx(force, rel=1e-9)
