"""One load step with friction: semi-smooth Newton on contact and slip together."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut.contact.laws import Complementarity, Coulomb, Tied
from abut.errors import SingularModelError
from abut.linear.solver import Prepared
from abut.nonlinear.exact import ROUGH, STRIDE
from abut.nonlinear.iteration import (
    FLAT,
    NO_PRESSURE,
    Found,
    Increment,
    advance,
    largest_force,
    largest_pressure,
    part_of,
    points,
    report,
)
from abut.problem.contact_pairs import Pair
from abut.problem.laws import LawRows, at_multipliers
from abut.problem.linearised import Linearised
from abut.solution import Iteration
from abut.solution.state import CLOSED, OPEN, SLIPPING, State

TOLERANCE = 1e-10  # of the laws over the largest pressure, and of equilibrium over the largest force
ROUNDING = 1e-7  # the same that may be left where it no longer falls
HALVINGS, LESS = 6, 0.1  # of a step in the line search, and by how much of its share it should shrink what is left
Vector = NDArray[np.float64]
Status = NDArray[np.int8]


def friction_laws(system: Linearised, state: State) -> list[LawRows]:
    """The laws of all pairs with the status as it is."""
    return _laws(system, state, slippery=False)


def _laws(system: Linearised, state: State, slippery: bool) -> list[LawRows]:
    """The same, or without friction where ``slippery``."""
    parts = (system.gap(state), state.multipliers, state.closed, state.slipping)
    return [
        at_multipliers(
            pair, _law(pair, system, slippery), gap, multipliers, closed, slipping if pair.frictional else None
        )
        for pair, gap, multipliers, closed, slipping in zip(system.pairs, *map(system.split, parts))
    ]


def _law(pair: Pair, system: Linearised, slippery: bool) -> Tied | Coulomb | Complementarity:
    if pair.tied:
        return Tied()
    if not pair.frictional:
        return Complementarity(pair.stiffness)
    return Coulomb(pair.stiffness, 0.0) if slippery else coulomb(pair, system)


def coulomb(pair: Pair, system: Linearised) -> Coulomb:
    """The law of a pair with friction."""
    return Coulomb(pair.stiffness, pair.friction(system.factors))


def solve_friction(
    solver: Prepared,
    begin: State,
    increment: Increment,
    limit: int,
    observe: Callable[[Iteration], None],
    earlier: Sequence[Iteration] = (),
) -> Found:
    """Find the state at the end of a load step, from the state ``begin``; earlier: iterations of the same step before.

    Where Newton's method from the status of ``begin`` fails, it starts once more from the solution without friction.
    Raises SingularModelError where contact and friction cannot hold a body."""
    search = _Search(solver, increment, list(earlier), observe)
    first = begin.with_status(_completed(solver.system, begin))
    found, error = None, None
    try:
        found = _newton(search, first, limit)
    except SingularModelError as reason:
        error = reason
    if found is not None and found.converged:
        return found
    start = _without_friction(search, first, limit)
    if start is not None:
        try:
            found = _newton(search, start, limit)
        except SingularModelError as reason:
            error = error or reason
    if found is not None:
        return replace(found, iterations=tuple(search.done))
    assert error is not None
    raise error


def _newton(search: _Search, first: State, limit: int) -> Found:
    """Semi-smooth Newton from a state and its status, with whole steps until a status comes back: from then on a line
    search shortens them."""
    system, state = search.solver.system, first
    seen: set[bytes] = set()
    before, careful, changed = np.inf, False, np.zeros(len(state.status), dtype=bool)
    tolerance = tolerated(search.solver)
    accuracy = ROUGH
    for _ in range(limit):
        clock = time.perf_counter()
        following = advance(search.solver, state, friction_laws(system, state), accuracy)
        if careful:
            following = search.shortened(state, following)
        wanted = next_status(system, following, search.increment)
        changed = wanted != state.status
        state = following.with_status(wanted)
        left = search.report(state, points(system, changed), clock)
        if not changed.any() and (left <= tolerance or (left <= ROUNDING and left > 0.5 * before)):
            return Found(state, tuple(search.done), True, changed, friction_laws)
        before = left if not changed.any() else np.inf
        accuracy = ROUGH if changed.any() else max(0.3 * tolerance / left, STRIDE)
        if changed.any():
            careful = careful or wanted.tobytes() in seen
            seen.add(wanted.tobytes())
    return Found(state, tuple(search.done), False, changed, friction_laws)


def tolerated(solver: Prepared) -> float:
    """What laws and equilibrium may have left, over the largest pressure and force."""
    return TOLERANCE if solver.exact else max(TOLERANCE, solver.accurate)


def _without_friction(search: _Search, first: State, limit: int) -> State | None:
    """The solution of the same step without friction, with the status that friction asks for there; None where there is
    none, as for bodies that friction alone holds, or where every contact is rough."""
    system = search.solver.system
    slippery = system.join([np.full(len(p), p.frictional) for p in system.pairs]).astype(bool)
    state = first.with_status(np.where(slippery & first.closed, SLIPPING, first.status))
    for _ in range(limit):
        clock = time.perf_counter()
        try:
            state = advance(search.solver, state, _laws(system, state, slippery=True), ROUGH)
        except SingularModelError:
            return None
        wanted = next_status(system, state, search.increment)
        changed = (wanted != OPEN) != state.closed
        search.report(state, points(system, changed), clock)
        if not changed.any():
            return state.with_status(wanted)
        state = state.with_status(np.where(slippery & (wanted != OPEN), SLIPPING, wanted))
    return None


@dataclass(frozen=True)
class _Search:
    """What a search tells, and how far states are from a solution. done: rows of the step, which grow."""

    solver: Prepared
    increment: Increment
    done: list[Iteration]
    observe: Callable[[Iteration], None]

    def report(self, state: State, changed: int, clock: float) -> float:
        """Add a row to the table; the larger one of what laws and equilibrium have left."""
        seconds, error = time.perf_counter() - clock, self.error(state)
        row = report(self.solver.system, state, self.increment, len(self.done) + 1, changed, np.zeros(1), seconds)
        row = replace(row, contact_residual=error)
        self.done.append(row)
        self.observe(row)
        return max(error, row.residual)

    def error(self, state: State) -> float:
        """Of the laws with the status as it is, over the largest pressure."""
        system = self.solver.system
        left = [
            float(np.abs(law.residual / pair.weight).max(initial=0.0)) * pair.stiffness
            for pair, law in zip(system.pairs, friction_laws(system, state))
        ]
        return max(left, default=0.0) / largest_pressure(state, self.increment)

    def size(self, state: State) -> float:
        """Of everything that is left, with the status that the laws ask for."""
        system = self.solver.system
        state = state.with_status(next_status(system, state, self.increment))
        laws = [
            np.linalg.norm(law.residual / pair.weight * pair.stiffness)
            for pair, law in zip(system.pairs, friction_laws(system, state))
        ]
        internal = system.internal(state)
        force = np.linalg.norm(system.unbalanced(state, internal)) / largest_force(
            system, state, internal, self.increment
        )
        return float(np.linalg.norm(laws) / largest_pressure(state, self.increment) + force)

    def shortened(self, state: State, full: State) -> State:
        """The whole step, or the part of it that halving finds to be better."""
        before, share, best = self.size(state), 1.0, full
        for _ in range(HALVINGS):
            if self.size(best) <= (1.0 - LESS * share) * before:
                return best
            share *= 0.5
            best = part_of(state, full, share)
        return full


def next_status(system: Linearised, state: State, increment: Increment) -> Status:
    """The status that the laws ask for, theory (R3), (R4), of each multiplier. What differs by rounding alone stays."""
    if not len(state.multipliers):
        return state.status
    pressed = np.concatenate([np.zeros(0), *(p[pair.normal] for pair, p in _contacts(system, state.multipliers))])
    reference = float(np.abs(pressed).max(initial=increment.largest.pressure))
    small = FLAT * max(reference, NO_PRESSURE)
    gaps, multipliers, before = (system.split(own) for own in (system.gap(state), state.multipliers, state.status))
    return system.join(
        [
            np.full(len(pair), CLOSED) if pair.tied else _wanted(pair, system.factors, gap, own, status, small)
            for pair, gap, own, status in zip(system.pairs, gaps, multipliers, before)
        ]
    )


def _contacts(system: Linearised, values: Vector) -> list[tuple[Pair, Vector]]:
    return [(pair, own) for pair, own in zip(system.pairs, system.split(values)) if not pair.tied]


def _wanted(pair: Pair, factors: Vector, gap: Vector, multipliers: Vector, status: Status, small: float) -> Status:
    normal, own = pair.normal, status[pair.normal]
    depth = -gap[normal] / pair.scale[normal]
    pushed = multipliers[normal] + depth
    closed = np.where(own != OPEN, pushed >= -small, pushed > small)
    result = np.where(closed, CLOSED, OPEN)
    if not pair.frictional:
        return result
    limit = pair.friction(factors)
    if not limit.rough:
        drag = pair.tangential_traction(multipliers)
        trial = pair.tangential_traction(multipliers - gap / pair.scale)
        size = np.linalg.norm(trial, axis=1)
        excess = size - limit.at(np.maximum(pushed, 0.0))[0]
        back = (
            np.einsum("kd,kd->k", drag, trial) < -small * size
        )  # slips the way it is pulled: it sticks before it slips back
        slips = np.where(own == SLIPPING, (excess >= -small) & ~back, excess > small)
        result = np.where(closed & ((slips & (size > small)) | limit.none), SLIPPING, result)
    return np.asarray(pair.of_functions(result))


def _completed(system: Linearised, state: State) -> Status:
    """The status to begin with: that of the state, and as much more in contact as it takes to hold every body."""
    closed = np.concatenate([np.zeros(0, bool), *map(_whole, system.pairs, system.split(state.closed))])
    wanted = system.restraint.complete(system.forces, closed, system.gap(state)) | system.tied
    return np.where(wanted & ~state.closed, CLOSED, state.status)


def _whole(pair: Pair, closed: NDArray[np.bool_]) -> NDArray[np.bool_]:
    return np.asarray(pair.of_functions(closed[pair.normal])) if pair.frictional else closed
