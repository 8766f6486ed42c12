"""What small kinematics does not follow: motion along the surfaces by facets, and turns of bodies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.diagnosis.cures import cure
from abut.mesh.make import join, rectangle
from models.certificate import line


def of(solution: abut.Solution, name: str) -> abut.solution.Check:
    return next(check for check in solution.certificate if check.name == name)


@pytest.mark.parametrize(("facets", "verdict"), [(0.0, "pass"), (0.7, "warn"), (3.0, "FAIL")])
def test_sliding_by_facets(facets: float, verdict: str) -> None:
    """A cylinder pressed on a block and moved along it, without friction, by some of the facets (8 / 8): where it
    presses the
    block is decided at the outset."""
    built = line("quad4", (8, 8))
    sideways = abut.Support("cylinder.axis", x=1.0 * facets)
    solution = abut.solve(replace(built, supports=[built.supports[0], sideways]))
    check = of(solution, "sliding")
    assert check.value == pytest.approx(facets, rel=0.05, abs=0.1)
    assert check.verdict == verdict
    assert ('kinematics = "finite"' in cure(check, solution)) is (verdict != "pass")


def block(x: float, turn: float = 0.0, held: bool = True) -> abut.Model:
    """A block on a plate that is held all over or at its bottom, moved by x, then turned by an angle, small as it is
    taken."""
    mesh = join({"plate": rectangle((-4, 4), (-1, 0), (16, 2)), "block": rectangle((-1, 1), (0, 2), (4, 4))})
    sides = ["plate.bottom", "plate.top"] if held else ["plate.bottom"]
    return abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(1000.0, 0.0)) for body in mesh.bodies],
        [abut.Support(side, x=0, y=0) for side in sides]
        + [abut.Support("block.top", x=lambda p: x - turn * p[:, 1], y=lambda p: -0.01 + turn * p[:, 0])],
        contacts=[abut.Contact("block.bottom", "plate.top")],
        plane="strain",
    )


def test_on_a_plane_that_is_held_sliding_makes_no_difference() -> None:
    """One place of it is as good as another: nothing is wrong. On a plate that gives way it is the place that counts."""
    assert of(abut.solve(block(2.0)), "sliding").value == 0.0
    assert of(abut.solve(block(2.0, held=False)), "sliding").verdict == "FAIL"


@pytest.mark.parametrize(("turn", "verdict"), [(0.01, "pass"), (0.15, "warn"), (-0.3, "FAIL")])
def test_turns(turn: float, verdict: str) -> None:
    """All of the block follows its top, but for what presses."""
    solution = abut.solve(block(0.0, turn))
    check = of(solution, "rotation")
    assert check.verdict == verdict


def test_large_displacements_have_no_such_lines() -> None:
    solution = abut.solve(replace(block(0.5), kinematics="finite"))
    assert not {"sliding", "rotation"} & {check.name for check in solution.certificate}


def test_turns_in_space() -> None:
    """The nearest rigid motion of a body that is turned about any axis and stretched besides: its turn."""
    from abut.analysis.moved import largest_turn
    from abut.mesh.make import box

    mesh = join({"a": box((0, 1), (0, 2), (0, 3), (2, 2, 2), "hex8")})
    turn = np.array([0.02, -0.01, 0.03])
    moved = np.cross(turn, mesh.points) + np.array([5.0, 0.0, 1.0]) + 0.1 * mesh.points
    assert largest_turn(mesh, moved) == pytest.approx(np.linalg.norm(turn), rel=1e-9)
