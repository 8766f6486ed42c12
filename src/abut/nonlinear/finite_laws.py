"""The laws of all pairs near a state at large displacements, what they leave open, and the status that they ask for: a body
that has lost its contact springs back, and from there far into the other one, so that not every point lets go at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.laws import Law, LawState
from abut.nonlinear.friction_laws import next_status
from abut.nonlinear.iteration import Increment
from abut.nonlinear.laws import Asked, barely_covered, friction_laws, without
from abut.problem.laws import SOFT, LawRows, at_multipliers
from abut.problem.linearised import NOTHING, Linearised
from abut.problem.pair import Pair
from abut.solution.state import CLOSED, OPEN, SLIPPING, State

DIGITS = np.finfo(float).nmant  # binary ones of a number
Status = NDArray[np.int8]
Vector = NDArray[np.float64]


def laws_of(system: Linearised, state: State, asked: Asked) -> list[LawRows]:
    """The laws of all pairs with the status as it is; multipliers of friction without a past carry nothing."""
    laws = friction_laws(system, state)
    if not any(asked.of(pair, system) is not None for pair in system.pairs):
        return laws
    forgotten = np.zeros(len(system), bool) if system.forgotten is None else system.forgotten
    parts = zip(
        system.pairs, laws, system.split(forgotten | barely_covered(system)),
        *map(system.split, (system.gap(state), state.multipliers, state.closed)),
    )  # fmt: skip
    result = []
    for pair, usual, idle, gap, multipliers, closed in parts:
        own, law = asked.of(pair, system), usual
        if own is not None:
            meeting = asked.by_pressure and not isinstance(pair.contact.law, str)
            met = _met(pair, own, gap, multipliers, closed) if meeting else gap
            with np.errstate(over="ignore", invalid="ignore"):
                law = at_multipliers(pair, own, met, multipliers, closed)
            law = replace(law, residual=law.residual + law.by_gap @ (gap - met)) if meeting else law
            law = without(law, idle, pair.scale, multipliers)
        result.append(law)
    return result


def _met(pair: Pair, law: Law, gap: Vector, pressure: Vector, closed: NDArray[np.bool_]) -> Vector:
    """Weighted gaps (n,), smaller than those given, at which the law is met by the pressures that there are: theory (G18).
    Those given where there is none. A law that knows no pressure at a gap of zero would let go of what it holds there."""

    def sign(mean: Vector) -> NDArray[np.bool_]:
        with np.errstate(over="ignore", invalid="ignore"):
            found = law.evaluate(mean[:, None], pressure[:, None], LawState(closed)).residual[:, 0]
        return np.asarray(found > 0.0)

    high = gap / pair.weight
    low, first = high.copy(), sign(high)
    searched = pressure > 0.0
    for k in range(DIGITS):
        same = searched & (sign(low) == first)
        high, low = np.where(same, low, high), np.where(same, low - pair.size * 2.0 ** (k - DIGITS // 2), low)
    found = searched & (sign(low) != first)
    for _ in range(DIGITS):
        middle = 0.5 * (low + high)
        above = sign(middle) == first
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    return np.where(found, pair.weight * low, gap)


def wanted_status(
    system: Linearised, state: State, increment: Increment, asked: Asked, gap: Vector | None = None
) -> NDArray[np.int8]:
    """The status (n,) that complementarity and Coulomb's law ask for; that of other laws stays. gap: (n,) to judge by; left
    out: that of the state."""
    wanted = next_status(system, state, *increment.rounding, gap)
    kept = [np.full(len(pair), not pair.frictional and asked.of(pair, system) is not None) for pair in system.pairs]
    return np.where(system.join(kept).astype(bool), state.status, wanted).astype(np.int8)


def status_of(system: Linearised, state: State, laws: Sequence[LawRows], asked: Asked) -> NDArray[np.int8]:
    """The status (n,) with that of other laws than complementarity and Coulomb's as these say."""
    parts = [
        np.where(law.closed, CLOSED, OPEN) if not pair.frictional and asked.of(pair, system) is not None else own
        for pair, law, own in zip(system.pairs, laws, system.split(state.status))
    ]
    return system.join(parts).astype(np.int8)


def yielding(system: Linearised, laws: Sequence[LawRows]) -> list[LawRows]:
    """Laws for one iteration: gaps that say the same twice, since equations or rigid bodies move several points of a surface
    together, give way to a change of their pressures, so that it is unique. Residuals stay as they are, and with them the
    solution. Without it ``test_level_faces_slide`` fails: the linear system is singular."""
    return [
        replace(law, by_pressure=(law.by_pressure + SOFT * law.by_gap @ sp.diags(pair.scale)).tocsr())
        if pair.repeated
        else law
        for pair, law in zip(system.pairs, laws)
    ]


def left_open(system: Linearised, laws: Sequence[LawRows], asked: Asked) -> Vector:
    """By how much (pressure) each multiplier breaks its law, (n,): of a law that gives way, with what it gives way by."""
    result = []
    for pair, law in zip(system.pairs, laws):
        missed = law.residual / pair.weight * pair.stiffness
        if asked.of(pair, system) is not None:
            give = np.abs(law.by_gap.diagonal()) + np.abs(law.by_pressure.diagonal()) / pair.scale
            missed = missed / np.maximum(give, NOTHING)
        result.append(missed)
    return np.concatenate([np.zeros(0), *result])


def following_status(system: Linearised, state: State, increment: Increment, asked: Asked, guessed: bool) -> Status:
    """The status (n,) that the laws ask for, but for points that are closed and press: they stay closed.

    An iteration has closed them in the linear problem. The gap that they have nevertheless is what that has left out; the
    law divides it by h / E, which makes of a hundredth of a facet more than most pressures. guessed: no
    iteration leads to the state; points that press stay closed only where otherwise all of a contact would open."""
    gap = system.gap(state)
    presses = state.closed & (state.multipliers > 0.0)
    wanted = wanted_status(system, state, increment, asked)
    for pair, own, part, status in zip(system.pairs, system.split(presses), system.split(gap), system.split(wanted)):
        if pair.decided or (guessed and (status[pair.normal] != OPEN).any()):
            continue
        near = own[pair.normal] & (
            part[pair.normal] < increment.settings.newton.bent * pair.size * pair.weight[pair.normal]
        )
        part[pair.normal] = np.where(near, np.minimum(part[pair.normal], 0.0), part[pair.normal])
    return wanted_status(system, state, increment, asked, gap)


def without_pulling(system: Linearised, state: State, there: State, increment: Increment) -> State | None:
    """The state (its unknowns as they are) without the points that pull at ``there``, where contact alone holds a body: what
    they pull others press, far from the forces that loads ask for. Without it ``test_pin_on_one_node`` fails.

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
        if pair.decided or pair.smooth or not closed[pair.normal].any():
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
        if pair.decided or closed.any() or not was.any():
            continue
        clearance = (gaps[own] / (pair.weight * pair.size))[pair.normal]
        clearance = np.where(idle[own][pair.normal], np.inf, clearance)
        nearest = np.isfinite(clearance) & (clearance <= clearance.min() + near)
        wanted[own] = np.where(pair.of_functions(nearest), CLOSED, wanted[own])
    return state if np.array_equal(wanted, state.status) else state.with_status(wanted)
