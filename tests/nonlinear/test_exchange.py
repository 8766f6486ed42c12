"""Points that take turns: of two functions at a sharp corner one lets go where the other one closes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
import pytest
from numpy.typing import NDArray

from abut.nonlinear.exchange import exchanged
from abut.nonlinear.settings import DEFAULT
from abut.solution.state import State, at_rest

AGAIN = DEFAULT.newton.patience

TURNS = np.array([0, AGAIN])


@dataclass(frozen=True)
class Side:
    """A pair without friction."""

    n: int
    tied: bool = False
    decided: bool = False
    smooth: bool = False

    @property
    def normal(self) -> slice:
        return slice(0, self.n)

    @property
    def index(self) -> NDArray[np.int64]:
        return np.arange(self.n)[:, None]

    def __len__(self) -> int:
        return self.n


@dataclass(frozen=True)
class Linear:
    """Gaps q + M p under pressures p."""

    matrix: NDArray[np.float64]
    offset: NDArray[np.float64]

    @property
    def pairs(self) -> list[Side]:
        return [Side(len(self))]

    def __len__(self) -> int:
        return len(self.offset)

    def split(self, values: NDArray[Any]) -> list[NDArray[Any]]:
        return [values]

    def gap(self, state: State) -> NDArray[np.float64]:
        return np.asarray(self.offset + self.matrix @ state.multipliers)

    def solved(self, state: State) -> State:
        """With gaps of closed points closed."""
        at, pressures = np.flatnonzero(state.closed), np.zeros(len(self))
        pressures[at] = np.linalg.solve(self.matrix[np.ix_(at, at)], -self.offset[at])
        return replace(state, multipliers=pressures)


def after(linear: Linear, closed: list[bool], closings: NDArray[np.int64]) -> State:
    """What an iteration with points closed ends with."""
    here = at_rest(0, len(linear)).with_closed(np.array(closed))
    return exchanged(cast(Any, linear), here, linear.solved(here), closings, AGAIN, linear.solved)


def test_one_takes_the_place_of_the_other() -> None:
    """A pressure on either closes the other one's gap more than its own: with the first alone the second penetrates, with
    both it pulls. The solution has the second alone."""
    linear = Linear(np.array([[1.0, 2.0], [2.0, 1.0]]), np.array([-1.0, -2.2]))
    assert linear.gap(linear.solved(at_rest(0, 2).with_closed(np.array([True, False]))))[1] < 0.0
    result = after(linear, [True, True], TURNS)
    assert result.multipliers == pytest.approx([0.0, 2.2])
    assert result.closed.tolist() == [False, True]
    assert linear.gap(result).min() > -1e-12


def test_first_iterations_go_on_as_they_do() -> None:
    linear = Linear(np.array([[1.0, 2.0], [2.0, 1.0]]), np.array([-1.0, -2.2]))
    assert after(linear, [True, True], TURNS - 1).closed.tolist() == [True, True]


def test_bodies_that_resist() -> None:
    """With a positive definite matrix a point that pulls does not penetrate where it is open: it simply opens."""
    linear = Linear(np.array([[1.0, 0.5], [0.5, 1.0]]), np.array([-1.0, -0.2]))
    result = after(linear, [True, True], TURNS)
    assert result.multipliers[1] < 0.0
    assert result.closed.tolist() == [True, True]


def test_several_give_way() -> None:
    """Two points that the third makes superfluous, one after the other."""
    matrix = np.array([[1.0, 0.2, 2.0], [0.2, 1.0, 2.5], [2.0, 2.0, 1.0]])
    linear = Linear(matrix, np.array([-1.0, -1.0, -3.6]))
    result = after(linear, [True, True, True], np.array([0, 0, AGAIN]))
    assert result.multipliers[2] > 0.0
    assert linear.gap(result).min() > -1e-12
    assert result.multipliers.min() >= 0.0


def test_another_one_that_pulls_then() -> None:
    """The third presses where the second opens, and what it presses apart pulls at the first: that opens too."""
    linear = Linear(np.array([[1.0, 0.0, 1.0], [0.0, 2.0, 3.0], [0.0, 3.0, 2.0]]), np.array([-1.0, -1.0, -3.0]))
    assert linear.solved(at_rest(0, 3).with_closed(np.array([True, False, True]))).multipliers[0] < 0.0
    result = after(linear, [True, True, True], np.array([0, 0, AGAIN]))
    assert result.closed.tolist() == [False, False, True]
    assert result.multipliers == pytest.approx([0.0, 0.0, 1.5])
    assert linear.gap(result).min() > -1e-12
