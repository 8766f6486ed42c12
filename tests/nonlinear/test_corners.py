"""Contact that hangs on one node: a pin on a node of its cradle, sharp corners that meet a round body, slide, or land."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.nonlinear.hanging import hanging
from abut.solution import Iteration
from models.clamps import balanced
from models.corners import WEIGHT, landing, peg, pin_in_cradle, wedge
from models.sliding import arched, finite


def solved(model: abut.Model) -> tuple[abut.Solution, int]:
    """With how many iterations it took in all, those of steps that failed among them; in equilibrium without tension."""
    rows: list[Iteration] = []

    def observe(what: object) -> None:
        if isinstance(what, Iteration):
            rows.append(what)

    solution = abut.solve(model, observer=observe)
    last = solution.steps[-1]
    assert last.converged
    assert last.factor == 1.0
    left = {check.name: check.passed for check in solution.certificate}
    assert all(
        passed
        for name, passed in left.items()
        if name.endswith(("model balance", "force balance", "complementarity", "tension"))
    )
    return solution, len(rows)


@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_pin_on_one_node(friction: float) -> None:
    """It rests where it lies: every step is in balance after an iteration, the node carries the weight, and nothing moves
    but by the strain of it."""
    solution, iterations = solved(pin_in_cradle(friction))
    assert iterations == len(solution.steps)
    contact = solution.steps[-1].contacts[0]
    points = solution.model.mesh.points[solution.model.mesh.nodes_of("pin")]
    x, y = points[np.isclose(np.hypot(*points.T), 1.0)].T
    x, y = np.array([x, y])[:, np.argsort(np.arctan2(y, x))]
    area = 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    assert contact.force[1] == pytest.approx(WEIGHT * area, rel=1e-9)
    assert np.abs(solution.steps[-1].displacement).max() < 10.0 * WEIGHT * np.pi / 210e3


def test_pin_that_falls() -> None:
    """From a gap between ten and a hundred times what the pin is pressed together by. Nothing tells how far it rolls."""
    solution, iterations = solved(pin_in_cradle(0.2, above=1e-3))
    fallen = solution.steps[-1].displacement[solution.model.mesh.nodes_of("pin"), 1]
    assert fallen.mean() == pytest.approx(-1e-3, rel=1e-3)
    assert iterations < 50


@pytest.mark.long
@pytest.mark.parametrize(("aside", "most"), [(0.0, 55), (0.4, 55)])
def test_wedge_into_round_block(aside: float, most: int) -> None:
    """Points on both faces at the wedge's corner take turns as the rubber comes round it. On the crown its edge spans two
    facets of the block: the point in its middle presses only if both beside it open (261 iterations if one does). A few of
    the steps follow the onset of slip."""
    _, iterations = solved(wedge("quad4", aside))
    assert iterations <= most


@pytest.mark.long
@pytest.mark.parametrize(
    ("cell", "plate_is_contactor", "most"), [("quad4", False, 50), ("quad8", False, 60), ("quad4", True, 170)]
)
def test_corner_of_a_peg(cell: str, plate_is_contactor: bool, most: int) -> None:
    """It slides all along the plate, so that the traction is the coefficient times the pressure."""
    solution, iterations = solved(peg(cell, plate_is_contactor))
    assert iterations <= most
    friction = solution.steps[-1].contacts[0].friction
    assert friction is not None
    assert friction.sticking_area == 0.0
    assert friction.force_by_area == pytest.approx(friction.force_limit, rel=1e-9)


@pytest.mark.long
@pytest.mark.parametrize(
    ("cell", "cells", "on_corner"),
    [
        ("hex8", 4, False),
        pytest.param("hex8", 4, True, marks=pytest.mark.long),
        pytest.param("tet10", 2, True, marks=pytest.mark.long),
    ],
)
def test_cube_that_lands(cell: str, cells: int, on_corner: bool) -> None:
    """On an edge, and on a corner."""
    solution, _ = solved(landing(cell, cells, on_corner))
    assert solution.steps[-1].contacts[0].force[2] > 0.0


@pytest.mark.long
@pytest.mark.parametrize(
    "tilt", [20.0, pytest.param(10.0, marks=pytest.mark.long), pytest.param(30.0, marks=pytest.mark.long)]
)
def test_side_that_comes_to_see_the_plate(tilt: float) -> None:
    """Three facets to an edge: as the cube is drawn along, the side at its edge turns from more than a right angle to the
    plate to less, and would press there as a whole from one iteration to the next: each of these ended before 0.8 of the
    way. It does not while the bottom faces the plate three times as squarely."""
    solution, iterations = solved(landing("hex8", 3, False, tilt))
    assert iterations <= 150
    balanced(solution)


def test_what_it_hangs_on() -> None:
    """Said where a run ends: the contact, the place in the undeformed mesh, and whether it is a corner."""
    flat, sharp = finite(arched(0.0)), finite(peg("quad4"))
    rest, none = flat.start(), np.zeros(len(flat.start().status), dtype=bool)
    one = np.arange(len(none)) == 2
    x, y = flat.model.mesh.points[flat.pairs[0].space.node[2]]
    place = f"at ({x:.6g}, {y:.6g}) in the undeformed mesh: refine the contactor there"
    assert hanging(flat, rest.with_closed(none), none) == ""
    assert hanging(flat, rest.with_closed(one | np.roll(one, 1)), none) == ""
    assert hanging(flat, rest.with_closed(~none), ~none) == ""
    assert hanging(flat, rest.with_closed(one), none) == (
        f"contact 'upper.bottom-lower.top' hangs on one node of the contactor, {place}"
    )
    assert hanging(flat, rest.with_closed(~none), one) == (
        f"contact 'upper.bottom-lower.top' goes on opening and closing, {place}"
    )
    node, under = sharp.pairs[0].space.node, sharp.model.mesh.nodes_of("peg.bottom")
    faces = node == under[sharp.model.mesh.points[under, 1].argmin()]
    assert int(faces.sum()) == 2
    both = sharp.pairs[0].of_functions(faces)
    assert hanging(sharp, sharp.start().with_closed(both), np.zeros(len(both), dtype=bool)).endswith(
        "a sharp corner or edge: round it off by a few facets"
    )
