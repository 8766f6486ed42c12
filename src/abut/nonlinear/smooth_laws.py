"""The end of a load step where pairs have other laws than complementarity: Newton on them, with a line search."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from abut.contact.laws import ConstraintFunction
from abut.errors import SingularModelError
from abut.linear.solver import Prepared
from abut.nonlinear.forcing import forcing
from abut.nonlinear.friction_laws import next_status
from abut.nonlinear.iteration import (
    Found,
    Increment,
    advance,
    imbalance,
    largest_pressure,
    next_active,
    part_of,
    report,
)
from abut.nonlinear.laws import Asked, active_laws, at_status, friction_laws
from abut.nonlinear.line_search import shortened
from abut.nonlinear.newton import End, Method, newton
from abut.problem.laws import LawRows, at_multipliers, in_the_mean
from abut.problem.linearised import Linearised
from abut.solution import Iteration
from abut.solution.state import CLOSED, OPEN, State


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
    there, end = newton(SmoothLaws(smooth, done, observe), Trial(state), limit)
    if end is End.SOLVED:
        return Found(there.state, tuple(done), True, none, smooth.laws)
    broken = there.violation > 0.1 * there.violation.max(initial=0.0)
    return Found(there.state, tuple(done), False, broken, smooth.laws)


@dataclass(frozen=True)
class Smooth:
    """A load step with the constraint function. reference: the largest pressure of the complementarity law."""

    solver: Prepared
    increment: Increment
    reference: float

    def laws(self, system: Linearised, state: State) -> list[LawRows]:
        """Of all pairs."""
        laws, asked = [], Asked(reference=self.reference)
        parts = (system.gap(state), state.multipliers, state.closed, state.slipping)
        for pair, g, p, closed, slips in zip(system.pairs, *map(system.split, parts)):
            at, law = pair.points, asked.of(pair, system)
            if at is not None:
                gap = at.gap + at.operator @ state.unknowns + at.prescribed @ system.factors
                function = ConstraintFunction(at.stiffness, pair.contact.epsilon, self.reference)
                laws.append(in_the_mean(at, function, gap, p))
            elif law is not None:
                laws.append(at_multipliers(pair, law, g, p, closed))
            else:
                laws.append(at_status(system, pair, g, p, closed, slips))
        return laws

    def violation(self, laws: Sequence[LawRows]) -> NDArray[np.float64]:
        """Of each multiplier, (n,), over the largest pressure."""
        system = self.solver.system
        units = [
            np.ones(len(p)) if law.at_points else np.full(len(p), p.stiffness) for p, law in zip(system.pairs, laws)
        ]
        residual = system.join([law.residual * unit for law, unit in zip(laws, units)])
        return np.asarray(np.abs(residual) / system.weight / self.reference)


@dataclass(frozen=True)
class Trial:
    """What an iteration leaves. violation: (n,) as in ``Smooth``, law_error and error: the largest of it and with what is
    unbalanced, all of them before the iteration; laws: (n,) those then; unsettled: whether the status of pairs without a
    smooth law has changed; shrinks: whether the line search has found less; singular: whether the linear system was."""

    state: State
    laws: Sequence[LawRows] = ()
    violation: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))
    law_error: float = np.inf
    error: float = np.inf
    unbalanced: float = np.inf
    unsettled: bool = True
    shrinks: bool = True
    singular: bool = False


class SmoothLaws(Method[Trial]):
    """Newton's method on the laws with a line search; gives up where that does. ``done`` grows."""

    def __init__(self, smooth: Smooth, done: list[Iteration], observe: Callable[[Iteration], None]) -> None:
        self.smooth = smooth
        self._done, self._observe = done, observe
        self._tries, self._before, self._clock = 0, np.inf, 0.0
        self._tolerance = max(smooth.increment.settings.newton.balanced, smooth.solver.accurate)
        system = smooth.solver.system
        self._tied, self._sharp, self._rubs = (
            system.join([np.full(len(pair), flag(pair)) for pair in system.pairs]).astype(bool)
            for flag in (lambda pair: pair.two_way, lambda pair: not pair.smooth, lambda pair: pair.frictional)
        )

    def advanced(self, here: Trial) -> Trial:
        """One iteration, as in ``Method``."""
        self._clock = time.perf_counter()
        solver, increment, state = self.smooth.solver, self.smooth.increment, here.state
        laws = self.smooth.laws(solver.system, state)
        violation = self.smooth.violation(laws)
        law_error = float(violation.max(initial=0.0))
        error = max(law_error, imbalance(solver.system, state, increment))
        tried = replace(here, laws=laws, violation=violation, law_error=law_error, error=error)
        try:
            full = advance(solver, state, laws, forcing(error, self._before, increment.settings))
        except SingularModelError:
            return replace(tried, singular=True)
        return replace(tried, state=full)

    def globalised(self, here: Trial, there: Trial) -> Trial:
        """The whole step, or what a line search leaves of it, with the status that is asked for there."""
        if there.singular:
            return there
        smooth, system, increment = self.smooth, self.smooth.solver.system, self.smooth.increment
        following, shrinks = _line_search(smooth, here.state, there.state)
        self._before = there.error
        closed = np.where(system.join([law.closed for law in there.laws]).astype(bool), CLOSED, OPEN)
        wanted = _wanted(system, following, increment, self._tied)
        changed = (status := np.where(self._sharp | self._rubs, wanted, closed)) != here.state.status
        state, seconds = following.with_status(status), time.perf_counter() - self._clock
        left = imbalance(system, state, increment), there.law_error
        row = report(system, state, increment, len(self._done) + 1, int(changed.sum()), left, seconds)
        self._done.append(row)
        self._observe(row)
        unsettled = bool(changed[self._sharp].any())
        return replace(there, state=state, unbalanced=row.residual, unsettled=unsettled, shrinks=shrinks)

    def ended(self, there: Trial) -> End | None:
        """Whether, and why, iterations end, as in ``Method``."""
        if there.singular:  # a body that nothing presses on, and rounding, which is all that is left, would move it
            met = there.error < self._tolerance and not there.unsettled
            return End.SOLVED if met else End.STALLED
        if there.law_error < self._tolerance and there.unbalanced < self._tolerance and not there.unsettled:
            return End.SOLVED
        if not there.shrinks:
            self._tries += 1
            if self._tries >= self.smooth.increment.settings.newton.halvings:
                return End.STALLED
        return None


def _wanted(
    system: Linearised, state: State, increment: Increment, tied: NDArray[np.bool_]
) -> NDArray[np.int8] | NDArray[np.bool_]:
    """The status that the laws ask for of pairs without a smooth one."""
    if any(pair.frictional for pair in system.pairs):
        return next_status(system, state, *increment.rounding)
    return np.where(next_active(system, state, increment, tied)[0], CLOSED, OPEN)


def _line_search(smooth: Smooth, state: State, full: State) -> tuple[State, bool]:
    """The step shortened until the law's residual shrinks, and whether it does in the end."""

    def size(at: State) -> float:
        return float(np.linalg.norm(smooth.violation(smooth.laws(smooth.solver.system, at))))

    return shortened(full, lambda share: part_of(state, full, share), size, size(state), smooth.increment.settings)
