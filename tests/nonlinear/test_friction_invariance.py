"""What must not matter to a solid model that sticks here and slips there: frame, units, which side is the contactor."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import abut
from abut.mesh import make
from abut.solution.state import CLOSED, SLIPPING
from models.surfaces import turned
from models.units import MILLIMETRES_TO, in_units

EXACT = 1e-8
COEFFICIENT = 0.25
TURN = turned(3, np.random.default_rng(7))
CELLS = ("hex8", "tet10")


def bent(points: np.ndarray) -> np.ndarray:
    """A block whose face at z = 2 is a paraboloid, so that it touches in its middle."""
    x, y, z = points.T
    return np.column_stack([x, y, z + (3.0 - z) * ((x - 2.0) ** 2 + (y - 2.0) ** 2) / 70.0])


def pushed(cell: str, turn: np.ndarray | None = None) -> abut.Model:
    """A block pressed on a wider one and pushed along both axes, first one way, then another: the edge of contact slips, its
    middle sticks. turn: of all of it."""
    n = 6 if cell == "hex8" else 4
    lower = make.box([0, 4], [0, 4], [0, 2], cells=[n + 1, n + 1, 2], cell=cell)
    upper = make.box([1, 3], [1, 3], [2, 3], cells=[n, n, 1], cell=cell)
    mesh = make.join({"lower": lower, "upper": replace(upper, points=bent(upper.points))})
    loads = [(0.0, 0.0, -8.0), (0.9, 0.3, 0.0), (-0.3, 0.6, 0.0)]
    if turn is not None:
        mesh = replace(mesh, points=mesh.points @ turn.T + [30.0, -20.0, 10.0])
        loads = [tuple(turn @ load) for load in loads]
    histories = ([(0, 0), (0.25, 1)], [(0.25, 0), (0.5, 1)], [(0.5, 0), (1, 1)])
    return abut.Model(
        mesh,
        [abut.Solid("lower", abut.LinearElastic(1e3, 0.3)), abut.Solid("upper", abut.LinearElastic(3e3, 0.2))],
        [abut.Support("lower.bottom", x=0, y=0, z=0)],
        [abut.Traction("upper.top", load, abut.Amplitude(tuple(history))) for load, history in zip(loads, histories)],
        [abut.Contact(contactor="upper.bottom", target="lower.top", friction=COEFFICIENT)],
        solve=abut.SolveOptions(times=[0.25, 0.5, 0.75, 1.0]),
    )


@cache
def solved(cell: str) -> abut.Solution:
    solution = abut.solve(pushed(cell))
    assert solution.converged
    coarse = ("resolution", "oscillation")  # six facets
    assert all(check.passed for check in solution.certificate if check.name not in coarse)
    return solution


def same(one: abut.Solution, two: abut.Solution, back: Callable[[np.ndarray], np.ndarray], force: float = 1.0) -> None:
    """At every step: displacements, forces of contact and status. back: vectors of the second one in the first one's frame
    and, but for ``force``, units."""
    assert two.converged
    for mine, theirs in zip(one.steps, two.steps, strict=True):
        largest = np.abs(mine.displacement).max()
        assert np.abs(back(theirs.displacement) - mine.displacement).max() < EXACT * largest
        mine, theirs = mine.contacts[0], theirs.contacts[0]
        assert (mine.friction.status == theirs.friction.status).all()
        forces = back(theirs.contactor_forces) * force
        assert np.abs(forces - mine.contactor_forces).max() < EXACT * np.abs(mine.contactor_forces).max()


@pytest.mark.parametrize("cell", CELLS)
def test_it_sticks_and_slips(cell: str) -> None:
    """Else the others say little."""
    for step in solved(cell).steps[1:]:
        status = step.contacts[0].friction.status
        count = [(status == own).sum() for own in (CLOSED, SLIPPING)]
        assert min(count) > 0.15 * sum(count)


@pytest.mark.long
@pytest.mark.parametrize("cell", CELLS)
def test_frame(cell: str) -> None:
    same(solved(cell), abut.solve(pushed(cell, TURN)), lambda v: v @ TURN)


@pytest.mark.long
@pytest.mark.parametrize("name", MILLIMETRES_TO)
@pytest.mark.parametrize("cell", CELLS)
def test_units(cell: str, name: str) -> None:
    units = MILLIMETRES_TO[name]
    same(
        solved(cell), abut.solve(in_units(pushed(cell), units)), lambda v: v / units.length, units.length / units.force
    )


@pytest.mark.parametrize("cell", CELLS)
def test_swapped_sides(cell: str) -> None:
    """To the discretisation: facets of a third and of half the contact's radius. Displacements in the mean square."""
    model = pushed(cell)
    contact = model.contacts[0]
    other = abut.solve(replace(model, contacts=[replace(contact, contactor=contact.target, target=contact.contactor)]))
    assert other.converged
    for mine, theirs in zip(solved(cell).steps, other.steps, strict=True):
        off = np.linalg.norm(theirs.displacement - mine.displacement)
        assert off < 0.1 * np.linalg.norm(mine.displacement)
