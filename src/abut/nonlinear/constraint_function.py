"""The end of a load step where pairs have the constraint function: Newton on it, with a line search."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from abut.contact.laws import TENSION_START, Linearisation, linearise_active, linearise_constraint_function
from abut.errors import SingularModelError
from abut.problem.system import (
    Laws,
    Outcome,
    Stage,
    System,
    Unknowns,
    active_laws,
    advance,
    equilibrium,
    internal_force,
    largest_force,
    largest_pressure,
    next_active,
    report,
    weight,
)
from abut.solution import Iteration

UNSETTLED = 0.1  # share of the largest violation from which on a multiplier is named where Newton fails
NO_PRESSURE = 1e-12  # over Young's modulus: a contact that presses less does not press at all
TOLERANCE = 1e-8  # of the relative residuals
SOFTEST, HARDEST = 1.0, 0.0  # share of the largest pressure over which the function is smoothed, beside its own epsilon
HARDEN, MET = 0.3, 0.01  # by how much it hardens once it is violated by less than that
HALVINGS, TRIES = 8, 5  # of a step, and steps that do not shrink the residual even so
ROUGH = 1e-2  # reduction of residuals asked of iterative linear solvers far from the solution


def finish_smooth(
    system: System,
    state: Unknowns,
    stage: Stage,
    limit: int,
    done: list[Iteration],
    observe: Callable[[Iteration], None],
) -> Outcome:
    """Pairs with the constraint function: Newton on it, from the solution of the complementarity law,
    until theory (V10). The active sets of other pairs go on changing with it."""
    none = np.zeros(len(state.active), dtype=bool)
    exact = Outcome(state, tuple(done), True, none, partial(active_laws, weights=stage.weights))
    if not any(pair.smooth for pair in system.pairs):
        return exact
    reference = largest_pressure(state, stage)
    if reference <= NO_PRESSURE * max(pair.stiffness * pair.size for pair in system.pairs):
        # The function is smoothed over a share of the largest pressure: without one it is the complementarity law.
        return exact
    smooth = Smooth(system, stage, reference)
    outcome = _newton(smooth, state, limit, done, observe, HARDEST)
    return outcome if outcome.converged else _newton(smooth, state, limit, done, observe, SOFTEST)


@dataclass(frozen=True)
class Smooth:
    """A load step with the constraint function. reference: the largest pressure of the complementarity law."""

    system: System
    stage: Stage
    reference: float

    def laws(self, softness: float) -> Laws:
        """Of all pairs, where epsilon is replaced by the square of ``softness`` (1: left as it is) if that is larger."""
        return partial(_smooth_laws, weights=self.stage.weights, reference=self.reference, softness=softness)

    def violation(self, laws: Sequence[Linearisation]) -> NDArray[np.float64]:
        """Of each multiplier, (n,), over the largest pressure."""
        residual = self.system.join([law.residual for law in laws])
        return np.asarray(
            np.abs(residual) / self.system.join([weight(pair) for pair in self.system.pairs]) / self.reference
        )


def _newton(
    smooth: Smooth,
    state: Unknowns,
    limit: int,
    done: list[Iteration],
    observe: Callable[[Iteration], None],
    softness: float,
) -> Outcome:
    """Newton with a line search, on laws that begin as soft as told and harden as they are met; gives up where the line
    search does. ``done`` grows."""
    system, stage = smooth.system, smooth.stage
    tied, sharp = (
        system.join([np.full(len(pair), flag(pair)) for pair in system.pairs]).astype(bool)
        for flag in (lambda pair: pair.tied, lambda pair: not pair.smooth)
    )
    before, violation, tries, unsettled = np.inf, np.zeros(len(state.active)), 0, True
    for _ in range(limit):
        clock = time.perf_counter()
        laws = smooth.laws(softness)
        near = laws(system, state)
        violation = smooth.violation(near)
        law_error = float(violation.max(initial=0.0))
        error = max(law_error, _unbalanced(system, state, stage))
        try:
            following = advance(system, state, stage.weights, near, _accuracy(error, before))
        except SingularModelError:
            if softness == HARDEST and error < TOLERANCE and not unsettled:
                # A body that nothing presses on, and rounding, which is all that is left, would move it.
                return Outcome(state, tuple(done), True, np.zeros(len(state.active), dtype=bool), laws)
            break
        following, found = _line_search(smooth, state, following, laws)
        before = error
        wanted, _ = next_active(system, following, stage, tied)
        active = np.where(sharp, wanted, system.join([law.active for law in near]).astype(bool))
        changed = int((active != state.active).sum())
        unsettled = bool((active != state.active)[sharp].any())
        state = replace(following, active=active)
        row = report(system, state, stage, len(done) + 1, changed, np.zeros(1), time.perf_counter() - clock)
        row = replace(row, contact_residual=law_error)
        done.append(row)
        observe(row)
        if softness > HARDEST and law_error < MET:
            softness, before = (softness * HARDEN if softness > 1e-5 else HARDEST), np.inf
        elif law_error < TOLERANCE and row.residual < 1e-8 and not unsettled:
            return Outcome(state, tuple(done), True, np.zeros(len(active), dtype=bool), laws)
        elif not found and (tries := tries + 1) > TRIES:
            break
    return Outcome(state, tuple(done), False, violation > UNSETTLED * violation.max(initial=0.0), smooth.laws(HARDEST))


def _accuracy(error: float, before: float) -> float:
    """The reduction of residuals asked of iterative solvers, so that Newton's method stays quadratic in the end (Eisenstat
    and Walker 1996) and the last solution reaches ``TOLERANCE``. error, before: of the laws and of equilibrium."""
    return float(np.clip((error / before) ** 2, 0.3 * TOLERANCE / max(error, TOLERANCE), ROUGH))


def _unbalanced(system: System, state: Unknowns, stage: Stage) -> float:
    internal = internal_force(system, state)
    residual = equilibrium(system, state, stage.weights, internal)
    return float(np.abs(residual).max(initial=0.0) / largest_force(system, state, internal, stage))


def _smooth_laws(
    system: System, state: Unknowns, weights: NDArray[np.float64], reference: float, softness: float
) -> list[Linearisation]:
    laws = []
    for pair, g, p, a in zip(
        system.pairs,
        system.split(system.gap(state, weights)),
        system.split(state.pressure),
        system.split(state.active),
    ):
        at = pair.points
        if at is None:
            laws.append(linearise_active(g, p, a, pair.scale))
            continue
        laws.append(
            linearise_constraint_function(
                at.test,
                at.weight,
                at.gap + at.operator @ state.displacement + at.prescribed @ weights,
                p,
                at.stiffness,
                max(pair.contact.epsilon, softness**2),
                reference,
                max(TENSION_START, softness),
            )
        )
    return laws


def _line_search(smooth: Smooth, state: Unknowns, full: Unknowns, laws: Laws) -> tuple[Unknowns, bool]:
    """Halve the step while the law's residual does not shrink, and whether it did in the end."""

    def size(at: Unknowns) -> float:
        return float(np.linalg.norm(smooth.violation(laws(smooth.system, at))))

    before = size(state)
    share = 1.0
    best = full
    for _ in range(HALVINGS):
        if size(best) <= max((1.0 - 0.1 * share) * before, 1e-9):
            return best, True
        share *= 0.5
        best = replace(
            state,
            displacement=state.displacement + share * (full.displacement - state.displacement),
            pressure=state.pressure + share * (full.pressure - state.pressure),
        )
    return best, False
