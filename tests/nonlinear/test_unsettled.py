"""What is said of a load step that does not converge: where most is left, and which body the loads carry off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.mesh.make import rectangle
from abut.nonlinear.holding import lifted
from abut.nonlinear.hourglass import folds_at_once, hourglassing
from abut.nonlinear.settings import DEFAULT
from abut.nonlinear.unsettled import circling, gives_way, most_at
from models.clamps import NAMED, WHOLE, clamp
from models.corners import peg, pin_in_cradle
from models.sliding import finite

FOLDED = DEFAULT.steps.folded


def test_iterations_that_come_back() -> None:
    """After two or three, all around once; falling or with nothing of the kind they go on."""
    assert circling([1.0, 3e-3, 5e-2, 3e-3, 5e-2], DEFAULT)
    assert circling([0.7, 0.1, 1.0, 0.2, 0.1, 1.0, 0.2], DEFAULT)
    assert circling([2e-3, 2e-3, 2e-3, 2e-3], DEFAULT)
    assert not circling([5e-2, 3e-3, 5e-2], DEFAULT)
    assert not circling([1.0, 3e-3, 5e-2, 3e-3, 4e-2], DEFAULT)
    assert not circling([1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7], DEFAULT)


def test_where_most_is_left() -> None:
    problem = finite(peg("quad4"))
    pair, points = problem.pairs[0], problem.model.mesh.points
    forces, laws = np.zeros(problem.n_free), np.zeros(len(pair))
    column = int(np.argmax(problem.constraints.free[2 * 100 + 1].toarray()))
    forces[column], laws[0] = -0.5, 0.1
    x, y = points[100]
    assert most_at(problem, forces, laws) == f"most at ({x:.6g}, {y:.6g}) in the undeformed mesh"
    under = problem.model.mesh.nodes_of("peg.bottom")
    corner, flat = under[points[under, 1].argmin()], under[points[under, 1].argsort()[1]]
    for node, cure in ((corner, ", a sharp corner or edge: round it off by a few facets"), (flat, "")):
        function = int(np.flatnonzero(pair.space.node == node)[0])
        x, y = points[node]
        for component in range(2):  # pressure, traction
            laws = np.zeros(len(pair))
            laws[pair.index[function, component]] = -0.7
            assert most_at(problem, forces, laws) == (
                f"most in contact '{pair.contact.name}' at ({x:.6g}, {y:.6g}) in the undeformed mesh{cure}"
            )


def test_a_body_in_contact_with_itself() -> None:
    """Where the same facets are on both sides, naming two of them is said to help."""
    advice = ": name the two sides that touch, one as contactor, the other as target"
    for sides in (WHOLE, NAMED):
        problem = finite(clamp("quad4", sides=sides))
        pair = problem.pairs[0]
        smooth = int(np.flatnonzero([int((pair.space.node == node).sum()) == 1 for node in pair.space.node])[0])
        laws = np.where(np.arange(len(pair)) == smooth, 0.1, 0.0)
        assert most_at(problem, np.zeros(problem.n_free), laws).endswith(advice) == (sides == WHOLE)


def test_a_pin_that_is_lifted() -> None:
    """In its cradle under its weight, and under a force as large upwards."""
    problem = finite(pin_in_cradle(0.2))
    rest = problem.start()
    pressed = problem.ahead(rest, problem.ended(rest), 1.0)
    assert lifted(pressed, rest) == ""
    assert lifted(replace(pressed, forces=-pressed.forces), rest) == (
        "the loads carry it off what it touches: body 'pin' is free to translate along y; "
        "hold it by a support, or move it to where it rests"
    )


def test_a_law_that_gives_way() -> None:
    """A body whose cells turn inside out is offered a law that stiffens, where its own does not."""
    problem = finite(peg("quad4"))
    reason = "cell 7 of body 'plate' turns inside out (det F = -0.1 at an integration point)"
    assert gives_way(problem, reason).startswith("body 'plate' is linear elastic")
    assert "NeoHooke" in gives_way(problem, reason)
    assert gives_way(problem, "25 iterations were not enough") == ""
    rubber = [replace(solid, material=abut.NeoHooke(2000.0, 0.35)) for solid in problem.model.solids]
    assert gives_way(replace(problem, model=replace(problem.model, solids=rubber)), reason) == ""


@pytest.mark.parametrize(
    ("integration", "share", "told"), [("b-bar", 0.5, True), ("b-bar", 0.4, False), ("full", 0.5, False)]
)
def test_cells_that_fold(integration: str, share: float, told: bool) -> None:
    """A unit cell bent into an hourglass by u_x = h xi eta keeps its volume; at Gauss's points that is 1 -+ 2 h / sqrt(3) of
    what it was."""
    held = abut.Support("bottom", x=lambda p: -share * (2.0 * p[:, 0] - 1.0), y=0.0)
    rubber = [abut.Solid("body", abut.NeoHooke(1.0, 0.49), integration=integration)]
    problem = finite(
        abut.Model(rectangle([0, 1], [0, 1], (1, 1), "quad4"), rubber, [held], plane="strain", kinematics="finite")
    )
    points = problem.model.mesh.points
    bent = np.zeros(points.shape)
    bent[:, 0] = share * (2.0 * points[:, 0] - 1.0) * (2.0 * points[:, 1] - 1.0)
    state = replace(problem.start(), time=1.0, unknowns=problem.constraints.free.T @ bent.ravel())
    assert np.allclose(problem.displacement(state), bent.ravel())
    line = hourglassing(problem, state, FOLDED)
    assert (line != "") == told
    assert not told or f"volume is {1.0 - 2.0 * share / np.sqrt(3.0):.2g} of" in line
    assert (folds_at_once(problem, problem.start(), state, FOLDED) != "") == told
    assert folds_at_once(problem, state, state, FOLDED) == ""
