"""Which points of a contact let go: those that press stay closed, whatever gap an iteration has left them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from abut.nonlinear.finite_laws import following_status, without_pulling
from abut.nonlinear.iteration import Increment
from abut.nonlinear.laws import Asked
from abut.nonlinear.settings import DEFAULT
from abut.problem.linearised import Linearised
from abut.solution.state import CLOSED, OPEN, State
from models.corners import pin_in_cradle
from models.sliding import arched, finite

FIRST = Increment(1)
HOOK = Path(__file__).parents[2] / "examples" / "snap-joint" / "job.toml"


def touching(apart: float) -> tuple[Linearised, State]:
    """Points 1 and 2 of a contactor closed, gaps of all of them ``apart`` facets."""
    problem = finite(arched(0.0))
    start = problem.start()
    system = problem.again(start, start)
    (pair,) = system.pairs
    closed = np.isin(np.arange(len(start.status)), (1, 2))
    return replace(system, offset=apart * pair.size * pair.weight), start.with_closed(closed)


def status(apart: float, pressures: tuple[float, float], guessed: bool = False) -> list[int]:
    system, state = touching(apart)
    multipliers = np.zeros(len(state.status))
    multipliers[[1, 2]] = pressures
    wanted = following_status(system, replace(state, multipliers=multipliers), FIRST, Asked(), guessed)
    assert (np.delete(wanted, [1, 2]) == (CLOSED if apart < 0.0 else OPEN)).all()
    return [int(one) for one in wanted[[1, 2]]]


def test_what_presses_stays() -> None:
    assert status(0.5 * DEFAULT.newton.bent, (1.0, -1.0)) == [CLOSED, OPEN]


def test_what_is_far_goes() -> None:
    """A linear problem tells nothing of it."""
    assert status(2.0 * DEFAULT.newton.bent, (1.0, 1.0)) == [OPEN, OPEN]


def test_what_penetrates_stays() -> None:
    assert status(-1e-3, (1.0, -1e-3)) == [CLOSED, CLOSED]


def test_guess() -> None:
    """It opens what the law opens (p < E g / h), but for all of a contact."""
    young = touching(0.0)[0].pairs[0].stiffness * touching(0.0)[0].pairs[0].size
    gap = 0.5 * DEFAULT.newton.bent
    assert status(gap, (2.0 * young * gap, 0.1 * young * gap), guessed=True) == [CLOSED, OPEN]
    assert status(gap, (0.2 * young * gap, 0.1 * young * gap), guessed=True) == [CLOSED, CLOSED]


def test_without_what_pulls() -> None:
    """Only where contact alone holds a body, and never all of a contact: there what sticks slips."""
    problem = finite(pin_in_cradle(0.2))
    start = problem.start()
    system = problem.again(start, start)
    (pair,) = system.pairs
    at = np.flatnonzero(start.closed[pair.normal])
    assert len(at) == 3

    def left(pressures: list[float]) -> State | None:
        multipliers = np.zeros(len(start.status))
        multipliers[at] = pressures
        return without_pulling(system, begun, replace(begun, multipliers=multipliers), FIRST)

    begun = start
    some = left([-1.0, 3.0, -1.0])
    assert some is not None
    assert np.flatnonzero(some.closed[pair.normal]).tolist() == [at[1]]
    assert left([1.0, 3.0, 1.0]) is None
    slides = left([-1.0, -3.0, -1.0])
    assert slides is not None
    assert np.array_equal(slides.closed, start.closed)
    assert np.array_equal(slides.slipping, start.closed)
    begun = slides
    assert left([-1.0, -3.0, -1.0]) is None
    held, there = touching(0.0)
    assert without_pulling(held, there, replace(there, multipliers=np.where(there.closed, -1.0, 0.0)), FIRST) is None
