"""Which points of a contact let go, in Newton's method at large displacements: a body that has lost its contact springs
back, and from there far into the other one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.nonlinear.finite_laws import Asked, barely_covered, wanted_status
from abut.nonlinear.iteration import Increment
from abut.problem.linearised import Linearised
from abut.solution.state import CLOSED, OPEN, SLIPPING, State

Status = NDArray[np.int8]


def following_status(system: Linearised, state: State, increment: Increment, asked: Asked, guessed: bool) -> Status:
    """The status (n,) that the laws ask for, but for points that are closed and press: they stay closed.

    An iteration has closed them in the linear problem. The gap that they have nevertheless is what that has left out; the
    law divides it by h / E, which makes of a hundredth of a facet more than most pressures. guessed: no iteration leads to
    the state; points that press stay closed only where otherwise all of a contact would open."""
    gap = system.gap(state)
    presses = state.closed & (state.multipliers > 0.0)
    wanted = wanted_status(system, state, increment, asked)
    for pair, own, part, status in zip(system.pairs, system.split(presses), system.split(gap), system.split(wanted)):
        if pair.two_way or (guessed and (status[pair.normal] != OPEN).any()):
            continue
        near = own[pair.normal] & (
            part[pair.normal] < increment.settings.newton.bent * pair.size * pair.weight[pair.normal]
        )
        part[pair.normal] = np.where(near, np.minimum(part[pair.normal], 0.0), part[pair.normal])
    return wanted_status(system, state, increment, asked, gap)


def without_pulling(system: Linearised, state: State, there: State, increment: Increment) -> State | None:
    """The state (its unknowns as they are) without the points that pull at ``there``, where contact alone holds a body: what
    they pull others press, far from the forces that loads ask for. Without it ``test_pin_on_one_node`` and
    ``test_pin_that_falls`` fail (96 iterations instead of fewer than 50).

    Where all of a contact pulls, what sticks slips: a point that meets the other side on the way sticks to where bodies that
    come straight together would meet, theory (G20), and if they come round an axle the traction that this takes may be any.
    Without it ``test_with_friction_at_any_torque`` fails. None where none pull, or all of a contact that does not stick."""
    if system.restraint.by_supports:
        return None
    least = increment.settings.newton.balanced * float(
        np.abs(there.multipliers).max(initial=increment.largest.pressure)
    )
    status = state.status.copy()
    parts = zip(system.pairs, system.split(status), system.split(state.closed), system.split(there.multipliers))
    for pair, own, closed, multipliers in parts:
        if pair.two_way or pair.smooth or not closed[pair.normal].any():
            continue
        pulls = closed[pair.normal] & (multipliers[pair.normal] < -least)
        if (closed[pair.normal] & ~pulls).any():
            own[:] = np.where(pair.of_functions(pulls), OPEN, own)
        elif pair.frictional and (own == CLOSED).any():
            own[:] = np.where(own == CLOSED, SLIPPING, own)
        else:
            return None
    return None if np.array_equal(status, state.status) else state.with_status(status)


def nearest_kept(system: Linearised, before: State, state: State, near: float) -> State:
    """A guess in which a contact has come off that was closed at the state ``before``: what is nearest stays closed for an
    iteration, which tells whether it pulls. Else the guess itself.
    near: facets by which points may be farther than the nearest, to stay closed with it. Without it
    ``test_a_guess_that_comes_off_does_not_let_go`` fails."""
    wanted, gaps, idle = state.status.copy(), system.gap(state), barely_covered(system)
    first = 0
    for pair in system.pairs:
        own = slice(first, first := first + len(pair))
        closed, was = state.closed[own][pair.normal], before.closed[own][pair.normal]
        if pair.two_way or closed.any() or not was.any():
            continue
        clearance = (gaps[own] / (pair.weight * pair.size))[pair.normal]
        clearance = np.where(idle[own][pair.normal], np.inf, clearance)
        nearest = np.isfinite(clearance) & (clearance <= clearance.min() + near)
        wanted[own] = np.where(pair.of_functions(nearest), CLOSED, wanted[own])
    return state if np.array_equal(wanted, state.status) else state.with_status(wanted)
