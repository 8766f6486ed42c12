"""The end of a load step where pairs have other laws than complementarity: Newton on them, with a line search."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from abut.contact.laws import TENSION_START, Complementarity, ConstraintFunction, Tied
from abut.contact.smooth_friction import SmoothCoulomb
from abut.errors import SingularModelError
from abut.linear.solver import Prepared
from abut.nonlinear.forcing import forcing
from abut.nonlinear.friction_laws import coulomb, friction_laws, next_status
from abut.nonlinear.iteration import (
    Found,
    Increment,
    active_laws,
    advance,
    largest_force,
    largest_pressure,
    next_active,
    part_of,
    report,
)
from abut.nonlinear.line_search import shortened
from abut.problem.laws import LawRows, at_multipliers, in_the_mean
from abut.problem.linearised import Linearised
from abut.problem.problem import Laws
from abut.solution import Iteration
from abut.solution.state import CLOSED, OPEN, State

SOFTEST, HARDEST = 1.0, 0.0  # share of the largest pressure over which the function is smoothed, beside its own epsilon


def finish_smooth(
    solver: Prepared,
    state: State,
    increment: Increment,
    limit: int,
    done: list[Iteration],
    observe: Callable[[Iteration], None],
) -> Found:
    """Pairs with the constraint function: Newton on it, from the solution of the complementarity law (with friction: of
    Coulomb's), until theory (V10). The status of other pairs goes on changing with it."""
    system = solver.system
    none = np.zeros(len(state.status), dtype=bool)
    friction = any(pair.frictional for pair in system.pairs)
    exact = Found(state, tuple(done), True, none, friction_laws if friction else active_laws)
    if not any(pair.smooth for pair in system.pairs):
        return exact
    reference = largest_pressure(state, increment)
    if reference <= increment.settings.newton.rounding * max(pair.stiffness * pair.size for pair in system.pairs):
        # The function is smoothed over a share of the largest pressure: without one it is the complementarity law.
        return exact
    smooth = Smooth(solver, increment, reference)
    outcome = _newton(smooth, state, limit, done, observe, HARDEST)
    return outcome if outcome.converged else _newton(smooth, state, limit, done, observe, SOFTEST)


@dataclass(frozen=True)
class Smooth:
    """A load step with the constraint function. reference: the largest pressure of the complementarity law."""

    solver: Prepared
    increment: Increment
    reference: float

    def laws(self, softness: float) -> Laws:
        """Of all pairs, where epsilon is replaced by the square of ``softness`` (1: left as it is) if that is larger."""
        return partial(_smooth_laws, reference=self.reference, softness=softness)

    def violation(self, laws: Sequence[LawRows]) -> NDArray[np.float64]:
        """Of each multiplier, (n,), over the largest pressure."""
        system = self.solver.system
        units = [
            np.ones(len(p)) if law.at_points else np.full(len(p), p.stiffness) for p, law in zip(system.pairs, laws)
        ]
        residual = system.join([law.residual * unit for law, unit in zip(laws, units)])
        return np.asarray(np.abs(residual) / system.weight / self.reference)


def _newton(
    smooth: Smooth,
    state: State,
    limit: int,
    done: list[Iteration],
    observe: Callable[[Iteration], None],
    softness: float,
) -> Found:
    """Newton with a line search, on laws that begin as soft as told and harden as they are met; gives up where the line
    search does. ``done`` grows."""
    solver, increment, settings = smooth.solver, smooth.increment, smooth.increment.settings
    tolerance = max(settings.newton.balanced, solver.accurate)
    system = solver.system
    tied, sharp, rubs = (
        system.join([np.full(len(pair), flag(pair)) for pair in system.pairs]).astype(bool)
        for flag in (lambda pair: pair.two_way, lambda pair: not pair.smooth, lambda pair: pair.frictional)
    )
    before, violation, tries, unsettled = np.inf, np.zeros(len(state.status)), 0, True
    for _ in range(limit):
        clock = time.perf_counter()
        laws = smooth.laws(softness)
        near = laws(system, state)
        violation = smooth.violation(near)
        law_error = float(violation.max(initial=0.0))
        error = max(law_error, _unbalanced(system, state, increment))
        try:
            following = advance(solver, state, near, forcing(error, before, settings))
        except SingularModelError:
            if softness == HARDEST and error < tolerance and not unsettled:
                # A body that nothing presses on, and rounding, which is all that is left, would move it.
                return Found(state, tuple(done), True, np.zeros(len(state.status), dtype=bool), laws)
            break
        following, found = _line_search(smooth, state, following, laws)
        before = error
        wanted = _wanted(system, following, increment, tied)
        closed = np.where(system.join([law.closed for law in near]).astype(bool), CLOSED, OPEN)
        status = np.where(sharp | rubs, wanted, closed)
        changed = int((status != state.status).sum())
        unsettled = bool((status != state.status)[sharp].any())
        state = following.with_status(status)
        row = report(system, state, increment, len(done) + 1, changed, np.zeros(1), time.perf_counter() - clock)
        row = replace(row, contact_residual=law_error)
        done.append(row)
        observe(row)
        if softness > HARDEST and law_error < settings.interior.met:
            softness, before = (
                (softness * settings.interior.fade if softness > settings.accuracy.fine else HARDEST),
                np.inf,
            )
        elif law_error < tolerance and row.residual < tolerance and not unsettled:
            return Found(state, tuple(done), True, np.zeros(len(status), dtype=bool), laws)
        elif not found and (tries := tries + 1) >= settings.newton.halvings:
            break
    return Found(state, tuple(done), False, violation > 0.1 * violation.max(initial=0.0), smooth.laws(HARDEST))


def _wanted(
    system: Linearised, state: State, increment: Increment, tied: NDArray[np.bool_]
) -> NDArray[np.int8] | NDArray[np.bool_]:
    """The status that the laws ask for of pairs without a smooth one."""
    if any(pair.frictional for pair in system.pairs):
        return next_status(system, state, increment)
    return np.where(next_active(system, state, increment, tied)[0], CLOSED, OPEN)


def _unbalanced(system: Linearised, state: State, increment: Increment) -> float:
    internal = system.internal(state)
    residual = system.unbalanced(state, internal)
    return float(np.abs(residual).max(initial=0.0) / largest_force(system, state, internal, increment))


def _smooth_laws(system: Linearised, state: State, reference: float, softness: float) -> list[LawRows]:
    laws = []
    parts = (system.gap(state), state.multipliers, state.closed, state.slipping)
    for pair, g, p, closed, slips in zip(system.pairs, *map(system.split, parts)):
        at, asked = pair.points, pair.contact.law
        epsilon, tension = max(pair.contact.epsilon, softness**2), max(TENSION_START, softness)
        if pair.frictional and pair.smooth:
            law = SmoothCoulomb(pair.stiffness, pair.friction(system.factors), float(np.sqrt(epsilon)), reference)
            laws.append(at_multipliers(pair, law, g, p, closed))
        elif pair.frictional:
            laws.append(at_multipliers(pair, coulomb(pair, system), g, p, closed, slips))
        elif at is not None:
            gap = at.gap + at.operator @ state.unknowns + at.prescribed @ system.factors
            laws.append(in_the_mean(at, ConstraintFunction(at.stiffness, epsilon, reference, tension), gap, p))
        elif pair.tied or isinstance(asked, str):
            laws.append(at_multipliers(pair, Tied() if pair.tied else Complementarity(pair.stiffness), g, p, closed))
        else:
            laws.append(at_multipliers(pair, asked, g, p, closed))
    return laws


def _line_search(smooth: Smooth, state: State, full: State, laws: Laws) -> tuple[State, bool]:
    """The step shortened until the law's residual shrinks, and whether it does in the end."""

    def size(at: State) -> float:
        return float(np.linalg.norm(smooth.violation(laws(smooth.solver.system, at))))

    return shortened(full, lambda share: part_of(state, full, share), size, size(state), smooth.increment.settings)
