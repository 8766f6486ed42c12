"""The end of a load step where pairs have the constraint function: Newton on it, with a line search."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from abut.interface.laws import Linearisation, linearise_active, linearise_constraint_function
from abut.solvers.newton import (
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
from abut.state import Iteration

UNSETTLED = 0.1  # share of the largest violation from which on a multiplier is named where Newton fails
NO_PRESSURE = 1e-12  # over Young's modulus: a contact that presses less does not press at all
TOLERANCE = 1e-8  # of the relative residuals
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
    if not any(pair.smooth for pair in system.pairs):
        return Outcome(state, tuple(done), True, none, partial(active_laws, weights=stage.weights))
    reference = largest_pressure(state, stage)
    if reference <= NO_PRESSURE * max(pair.stiffness * pair.size for pair in system.pairs):
        # The function is smoothed over a share of the largest pressure: without one it is the complementarity law.
        return Outcome(state, tuple(done), True, none, partial(active_laws, weights=stage.weights))
    smooth = partial(_smooth_laws, weights=stage.weights, reference=reference)
    violation = np.zeros(len(state.active))
    before = np.inf
    tied = system.join([np.full(len(pair), pair.tied) for pair in system.pairs]).astype(bool)
    exact = system.join([np.full(len(pair), not pair.smooth) for pair in system.pairs]).astype(bool)
    for _ in range(limit):
        clock = time.perf_counter()
        laws = smooth(system, state)
        residual = system.join([law.residual for law in laws])
        scale = system.join([weight(pair) for pair in system.pairs]) * reference
        violation = np.abs(residual / scale)
        law_error = float(violation.max(initial=0.0))
        residual_now = max(law_error, _unbalanced(system, state, stage))
        following = advance(system, state, stage.weights, laws, _accuracy(residual_now, before))
        before = residual_now
        following = _line_search(system, state, following, smooth, reference)
        wanted, _ = next_active(system, following, stage, tied)
        active = np.where(exact, wanted, system.join([law.active for law in laws]).astype(bool))
        changed = int((active != state.active).sum())
        unsettled = bool((active != state.active)[exact].any())
        state = replace(following, active=active)
        row = report(system, state, stage, len(done) + 1, changed, np.zeros(1), time.perf_counter() - clock)
        row = replace(row, contact_residual=law_error)
        done.append(row)
        observe(row)
        if law_error < TOLERANCE and row.residual < 1e-8 and not unsettled:
            return Outcome(state, tuple(done), True, none, smooth)
    return Outcome(state, tuple(done), False, violation > UNSETTLED * violation.max(initial=0.0), smooth)


def _accuracy(error: float, before: float) -> float:
    """The reduction of residuals asked of iterative solvers, so that Newton's method stays quadratic in the end (Eisenstat
    and Walker 1996) and the last solution reaches ``TOLERANCE``. error, before: of the laws and of equilibrium."""
    return float(np.clip((error / before) ** 2, 0.3 * TOLERANCE / max(error, TOLERANCE), ROUGH))


def _unbalanced(system: System, state: Unknowns, stage: Stage) -> float:
    internal = internal_force(system, state)
    residual = equilibrium(system, state, stage.weights, internal)
    return float(np.abs(residual).max(initial=0.0) / largest_force(system, state, internal, stage))


def _smooth_laws(
    system: System, state: Unknowns, weights: NDArray[np.float64], reference: float
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
                pair.contact.epsilon,
                reference,
            )
        )
    return laws


def _line_search(system: System, state: Unknowns, full: Unknowns, smooth: Laws, reference: float) -> Unknowns:
    """Halve the step while the law's residual grows."""

    def size(at: Unknowns) -> float:
        scale = system.join([weight(pair) for pair in system.pairs]) * reference
        return float(np.linalg.norm(system.join([law.residual for law in smooth(system, at)]) / scale))

    before = size(state)
    share = 1.0
    best = full
    for _ in range(8):
        if size(best) <= max((1.0 - 0.1 * share) * before, 1e-9):
            return best
        share *= 0.5
        best = replace(
            state,
            displacement=state.displacement + share * (full.displacement - state.displacement),
            pressure=state.pressure + share * (full.pressure - state.pressure),
        )
    return best
