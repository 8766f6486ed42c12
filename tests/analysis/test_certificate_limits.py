"""Lines whose limits follow what a run leaves: no false alarm at planes of symmetry or by iterative solvers."""

from __future__ import annotations

from dataclasses import replace

import pytest

import abut
from abut.mesh.make import join, rectangle
from abut.solution import Check
from models.certificate import squares


def checks(solution: abut.Solution) -> dict[str, Check]:
    return {check.name: check for check in solution.certificate}


@pytest.mark.parametrize("missing", [0.0, 5e-3, 9e-3])
def test_a_target_that_ends_a_trace_short_is_no_integration_error(missing: float) -> None:
    """Of the contactor's last facet a share below what counts as whole has no target opposite: chords at the ends of a
    quarter
    model leave as much. What is missing there is that, and no error of the integrals."""
    mesh = join(
        {"lower": rectangle((0, 1), (0, 1), (10, 4)), "upper": rectangle((0, 1 - 0.1 * missing), (1, 2), (7, 4))}
    )
    built = abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(1.0, 0.0)) for body in mesh.bodies],
        [abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=0, y=-0.05)],
        contacts=[abut.Contact("lower.top", "upper.bottom")],
        plane="strain",
    )
    assert checks(abut.solve(built))["facet moments"].value < 1e-9


def test_free_modes_are_judged_by_what_the_solver_leaves() -> None:
    """An iterative solver stops at a residual; summed over a thousand points it is more than rounding. Limit and value of a
    step whose residual is known."""
    step = abut.solve(squares(2, 2)).steps[-1]
    size = step.displacement.size
    for residual, limit in ((1e-15, 1e-9), (4e-9, 4e-9 * size**0.5), (1.0, 1e-6)):
        last = replace(step.iterations[-1], residual=residual)
        judged = replace(step, iterations=(last,), spring=2e-9 * step.reference_force)
        assert judged.regularisation_limit == pytest.approx(limit)
        assert judged.regularisation == pytest.approx(2e-9)
