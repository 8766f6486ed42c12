"""Parts shared by the searches for the contact status: a Newton step, the next active set, the record of an iteration."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from abut.linear.solver import Prepared
from abut.nonlinear.settings import DEFAULT, Settings
from abut.problem.laws import LawRows
from abut.problem.linearised import NOTHING, Linearised
from abut.problem.problem import Laws
from abut.solution import Iteration
from abut.solution.state import Largest, State

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Increment:
    """A load step: its number, the largest force and pressure of the steps before, against which rounding is judged
    where the loads are taken off again, and the thresholds that it is solved with."""

    number: int
    largest: Largest = field(default_factory=Largest)
    settings: Settings = DEFAULT

    @property
    def rounding(self) -> tuple[float, float]:
        """The share of the largest pressure by which no status changes, and the largest pressure of the steps before."""
        return self.settings.newton.balanced, self.largest.pressure


@dataclass(frozen=True)
class Found:
    """What a search ends with. reason: why it did not converge, where more can be said than that; cycling: (n,) bool,
    multipliers that go in and out for ever, or whose law stays violated; laws: those of all pairs as the last iteration
    saw them, near any state; between: (n,) with friction, the statuses of the last iterations, the sum of 2^status; system:
    the problem near the state, None where it has not been linearised there; reached: the last iterate, where the next one
    is no state of the material, and ``state`` that which the step began with."""

    state: State
    iterations: tuple[Iteration, ...]
    converged: bool
    cycling: NDArray[np.bool_]
    laws: Laws
    reason: str = ""
    between: NDArray[np.uint8] | None = None
    system: Linearised | None = None
    reached: State | None = None


def advance(solver: Prepared, state: State, laws: Sequence[LawRows], accuracy: float = 0.0) -> State:
    """One Newton step on equilibrium and laws."""
    system = solver.system
    du, dp = solver.solve(system.rows(laws), system.unbalanced(state), state.multipliers, accuracy)
    return replace(state, unknowns=state.unknowns + du, multipliers=state.multipliers + dp)


def part_of(state: State, full: State, share: float) -> State:
    """A share of the step from one state to another one."""
    return replace(
        state,
        unknowns=state.unknowns + share * (full.unknowns - state.unknowns),
        multipliers=state.multipliers + share * (full.multipliers - state.multipliers),
    )


def next_active(
    system: Linearised, state: State, increment: Increment, tied: NDArray[np.bool_]
) -> tuple[NDArray[np.bool_], Vector]:
    """The active set that the law asks for, theory (V7), and by how much (pressure) each multiplier breaks it now."""
    if not len(state.multipliers):
        return state.closed, np.zeros(0)
    closed = state.closed
    push = -system.gap(state) / system.scale  # penetration as a pressure
    reference = np.abs(state.multipliers[~tied]).max(initial=increment.largest.pressure)
    small = increment.settings.newton.balanced * max(reference, NOTHING)
    tension = np.where(closed & ~tied, -state.multipliers, 0.0)
    penetration = np.where(~closed, push, 0.0)
    wanted = (np.where(closed, tension <= small, penetration > small) | tied) & ~system.away
    return wanted, np.maximum(np.maximum(tension, penetration), 0.0)


def report(
    system: Linearised,
    state: State,
    increment: Increment,
    count: int,
    changed: int,
    left: tuple[float, float],
    seconds: float,
) -> Iteration:
    """The row of the table for a state. left: of forces over the largest, as ``imbalance``, and of laws over the largest
    pressure, as ``broken``."""
    depth = [
        float((-gap / (pair.weight * pair.size))[pair.normal].max(initial=0.0))
        for pair, gap in zip(system.pairs, system.split(system.gap(state)))
        if not pair.tied
    ]
    rubbing = any(pair.frictional for pair in system.pairs)
    return Iteration(
        step=increment.number,
        iteration=count,
        active=points(system, state.closed),
        changed=changed,
        residual=left[0],
        contact_residual=left[1],
        penetration=max(depth, default=0.0),
        seconds=seconds,
        sticking=points(system, state.closed & ~state.slipping, of_friction=True) if rubbing else None,
        slipping=points(system, state.slipping, of_friction=True) if rubbing else None,
    )


def imbalance(system: Linearised, state: State, increment: Increment) -> float:
    """What forces leave, over the largest one."""
    internal = system.internal(state)
    largest = largest_force(system, state, increment, internal)
    return float(np.abs(system.relative(system.unbalanced(state, internal), largest)).max(initial=0.0))


def broken(violation: Vector, state: State, increment: Increment) -> float:
    """Largest violation over the largest pressure; 1 while there is no pressure."""
    worst, largest = float(violation.max(initial=0.0)), largest_pressure(state, increment)
    return worst / largest if largest > NOTHING else float(worst > 0.0)


def points(system: Linearised, flags: NDArray[np.bool_], of_friction: bool = False) -> int:
    """How many multipliers (n,) have a flag, of a pair with friction how many points; all pairs, or those of friction."""
    by_pair = zip(system.pairs, system.split(flags))
    return sum(
        int((flag[pair.normal] if pair.frictional else flag).sum())
        for pair, flag in by_pair
        if pair.frictional or not of_friction
    )


def largest_force(system: Linearised, state: State, increment: Increment, internal: Vector | None = None) -> float:
    """Largest nodal force of stresses (``internal``, where it is known), of loads, of single multipliers and, where
    materials are not linear, of supports, now or in a step before. Where displacements have been condensed, those that are
    left see nothing of contact forces that balance each other on a body, as round a press fit."""
    push = system.weight * state.multipliers
    if system.about is not None:
        return max(system.about.reference, float(np.abs(push).max(initial=0.0)), increment.largest.force, NOTHING)
    internal = system.internal(state) if internal is None else internal
    largest = (float(np.abs(forces).max(initial=0.0)) for forces in (internal, system.load, push))
    return max(*largest, system.largest, increment.largest.force, NOTHING)


def largest_pressure(state: State, increment: Increment) -> float:
    """Largest pressure, now or in a step before."""
    return max(np.abs(state.multipliers).max(initial=0.0), increment.largest.pressure, NOTHING)


def largest_so_far(system: Linearised, state: State, increment: Increment) -> Largest:
    """Of the steps up to the one that ended with ``state``."""
    return Largest(largest_force(system, state, increment), largest_pressure(state, increment))
