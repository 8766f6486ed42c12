"""The status of a linear problem by pivots: where changes of all points at once go round in a circle."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.mesh.make import box, join, sphere_octant
from abut.nonlinear.pivots import Pivots, pivoted
from abut.nonlinear.settings import DEFAULT, NewtonSettings
from abut.solution.state import CLOSED, OPEN, State, at_rest

Vector = NDArray[np.float64]


class Complementary:
    """Gaps q + M p >= 0, pressures p >= 0, one of both zero. solved: how often it was."""

    def __init__(self, matrix: Vector, offset: Vector) -> None:
        self._matrix, self._offset, self.solved = matrix, offset, 0

    def with_set(self, state: State) -> State:
        self.solved += 1
        closed = state.closed
        pressure = np.zeros(len(closed))
        pressure[closed] = np.linalg.solve(self._matrix[np.ix_(closed, closed)], -self._offset[closed])
        return replace(state, multipliers=pressure)

    def asked(self, state: State) -> NDArray[np.int8]:
        gap = self._offset + self._matrix @ state.multipliers
        wanted = np.where(state.closed, state.multipliers >= 0.0, gap < 0.0)
        return np.where(wanted, CLOSED, OPEN).astype(np.int8)

    def broken(self, state: State) -> Vector:
        return np.abs(np.where(state.closed, state.multipliers, self._offset + self._matrix @ state.multipliers))

    def solution(self, state: State, settings: NewtonSettings = DEFAULT.newton) -> State:
        pivots = Pivots(self.asked, self.broken, np.arange(len(self._offset)))
        return pivoted(pivots, state, self.with_set(state), self.with_set, settings)

    def all_at_once(self, state: State, times: int) -> State:
        for _ in range(times):
            state = self.with_set(state)
            state = state.with_status(self.asked(state))
        return state


def at(status: tuple[int, ...]) -> State:
    return at_rest(0, len(status)).with_status(np.array(status, dtype=np.int8))


@pytest.mark.parametrize("begin", list(product((OPEN, CLOSED), repeat=3)))
def test_a_circle_of_three(begin: tuple[int, ...]) -> None:
    """All principal minors of the matrix are positive, so that there is one solution, p = (1, 1, 1) / 3; each pressure
    changes the next gap twice as much as its own, and one closed point follows the other for ever."""
    problem = Complementary(np.array([[1.0, 0.0, 2.0], [2.0, 1.0, 0.0], [0.0, 2.0, 1.0]]), -np.ones(3))
    one = problem.all_at_once(at((CLOSED, OPEN, OPEN)), 1)
    assert not np.array_equal(one.status, (CLOSED, OPEN, OPEN))
    assert np.array_equal(problem.all_at_once(one, 3).status, one.status)
    found = problem.solution(at(begin))
    assert found.multipliers == pytest.approx(np.full(3, 1.0 / 3.0))


def test_matrices_with_positive_minors() -> None:
    """Of fifteen points, symmetric or not, far from diagonal: gaps and pressures are complementary to rounding."""
    rng = np.random.default_rng(3)
    many = replace(DEFAULT.newton, solutions=500)
    for skew in (0.0, 1.0):
        for _ in range(20):
            a, b = rng.normal(size=(15, 15)), rng.normal(size=(15, 15))
            matrix, offset = a @ a.T + 0.01 * np.eye(15) + skew * (b - b.T), rng.normal(size=15)
            found = Complementary(matrix, offset).solution(at(tuple(rng.integers(0, 2, 15))), many)
            gap, size = offset + matrix @ found.multipliers, np.abs(found.multipliers).max()
            assert found.multipliers.min() > -1e-9 * size
            assert gap.min() > -1e-9 * size * np.abs(matrix).max()
            assert np.abs(gap * found.multipliers).max() < 1e-9 * size**2 * np.abs(matrix).max()


def test_no_status_twice() -> None:
    """Where a problem has no solution, its statuses are tried once each at most."""
    problem = Complementary(np.array([[-1.0]]), np.array([-1.0]))
    problem.solution(at((OPEN,)))
    assert problem.solved == 2


def pressed(contactor: str, target: str) -> abut.Model:
    """A hard ball in a block of rubber that is coarser."""
    soft, hard = (abut.NeoHooke(young=e, poisson=nu, volumetric="isochoric") for e, nu in ((3.0, 0.48), (3e3, 0.3)))
    ball = sphere_octant(8.0, (0.0, 0.0, 8.0), fine=2.2, cells=6, growth=1.3, cell="hex8")
    fine = {"x": [0.0, 2.2], "y": [0.0, 2.2], "z": [-2.2, 0.0]}
    block = box((0.0, 8.0), (0.0, 8.0), (-8.0, 0.0), (4, 4, 4), "hex8", fine, growth=1.3)
    return abut.Model(
        join({"block": block, "ball": ball}),
        [abut.Solid("block", soft, integration="full"), abut.Solid("ball", hard, integration="full")],
        [
            abut.Support("block.bottom", x=0, y=0, z=0), abut.Support("block.left", x=0), abut.Support("block.front", y=0),
            abut.Support("ball.x0", x=0), abut.Support("ball.y0", y=0), abut.Support("ball.z0", x=0, y=0, z=-0.6),
        ],
        contacts=[abut.Contact(contactor=contactor, target=target)], kinematics="finite", solve=abut.SolveOptions(steps=5),
    )  # fmt: skip


@pytest.mark.long
def test_a_finer_and_stiffer_contactor_does_not_go_round() -> None:
    """Its active set does, of four in turn, in the last step, unless they are found out; the force is that with the rubber
    as contactor to what such coarse facets leave."""
    solution, other = abut.solve(pressed("ball.round", "block.top")), abut.solve(pressed("block.top", "ball.round"))
    assert solution.converged
    assert len(solution.steps) == 5
    assert solution.contacts[0].force[2] == pytest.approx(-other.contacts[0].force[2], rel=0.02)
