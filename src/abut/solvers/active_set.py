"""Semi-smooth Newton for one load step: the active set is an output of the law, changed until it stands still."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from abut.errors import SingularModelError
from abut.solvers.constraint_function import finish_smooth
from abut.solvers.newton import (
    Laws,
    Outcome,
    Rows,
    Stage,
    System,
    Unknowns,
    active_laws,
    advance,
    internal_force,
    largest_force,
    largest_pressure,
    next_active,
    report,
    weight,
)
from abut.state import Iteration

__all__ = ["Laws", "Outcome", "Rows", "Stage", "System", "Unknowns", "following", "solve_step", "start"]

TOUCHING = 1e-3  # initial gap over facet size below which a multiplier starts active
ROUGH = 1e-2  # reduction of the residual asked of iterative linear solvers while the set changes
FINE = 1e-5  # the same once sets repeat
Aim = Literal["solution", "set", "this set"]
STRIDE = 1e-4  # the same at most in one solve, lest a set is solved to the end that then turns out not to be final
SEARCHED = 1e-5  # of equilibrium and of closed gaps, where only the set is wanted
FEW = 0.05  # share of the active set below which changes are too few to foresee where they lead ...
EARLY = 3  # ... but for those of the first iterations
PATIENCE = 3  # iterations without fewer changes than ever that count as a cycle
FIRST_SHARE, GROWTH = 0.3, 1.5  # of the largest violation: what changes its row after a cycle, theory (V9)


def start(system: System) -> Unknowns:
    """Zero displacement; multipliers that touch at the outset are active, theory (V6)."""
    n = sum(map(len, system.pairs))
    rest = Unknowns(np.zeros(system.stiffness.shape[0]), np.zeros(n), np.zeros(n, dtype=bool))
    gap = system.gap(rest, np.zeros(system.load.shape[1]))
    active = system.join(
        [
            np.full(len(pair), True) if pair.tied else g <= TOUCHING * pair.size * weight(pair)
            for pair, g in zip(system.pairs, system.split(gap))
        ]
    ).astype(bool)
    return replace(rest, active=active)


def solve_step(
    system: System,
    begin: Unknowns,
    stage: Stage,
    limit: int,
    observe: Callable[[Iteration], None],
    earlier: Sequence[Iteration] = (),
    aim: Aim = "solution",
    settled: bool = False,
) -> Outcome:
    """Find the state at the end of a load step, from the state ``begin``.

    earlier: iterations of the same step before; aim: "set" where only the active set is wanted, of laws that have one, "this
    set" to give up as soon as the set of ``begin`` changes (``cycling`` then says where); settled: the set of ``begin`` is
    likely to be the final one."""
    state = begin
    tied = system.join([np.full(len(pair), pair.tied) for pair in system.pairs]).astype(bool)
    seen: set[bytes] = set()
    history: list[NDArray[np.bool_]] = []
    done = list(earlier)
    changes: list[int] = []
    share = 0.0  # after a cycle only violations above this share of the largest change their row: theory (V9)
    changed = np.zeros(len(state.active), dtype=bool)
    finest = ROUGH
    accuracy = STRIDE if settled else ROUGH
    if state.active.all() and not settled:
        accuracy = 0.1 * system.accurate  # closed all over may well be the answer
    for count in range(len(done) + 1, len(done) + limit + 1):
        clock = time.perf_counter()
        active = system.complete(state.active, system.gap(state, stage.weights)) | tied
        state = replace(state, active=active)
        solved = advance(system, state, stage.weights, active_laws(system, state, stage.weights), accuracy)
        wanted, violation = next_active(system, solved, stage, tied)
        changed = wanted != active
        closure = _closure(system, solved, stage)
        row = report(system, solved, stage, count, int(changed.sum()), violation, time.perf_counter() - clock)
        row = replace(row, contact_residual=max(row.contact_residual, closure))
        done.append(row)
        observe(row)
        history.append(active)
        if not changed.any():
            error = max(row.residual, closure)
            if aim == "set" and (system.exact or error <= SEARCHED):
                return Outcome(solved, tuple(done), True, changed, partial(active_laws, weights=stage.weights))
            if system.exact or error <= system.accurate:
                return finish_smooth(system, solved, stage, limit, done, observe)
            state, accuracy = solved, max(0.3 * (SEARCHED if aim == "set" else system.accurate) / error, STRIDE)
            continue
        if aim == "this set":
            break
        if (
            system.predict is not None
            and not share
            and (count - len(earlier) <= EARLY or changed.sum() > FEW * active.sum())
        ):
            guess = system.predict(system.gap(solved, stage.weights), solved.pressure, wanted, tied)
            if guess.tobytes() not in {*seen, active.tobytes()}:
                wanted = guess
        accuracy = finest
        if np.array_equal(system.complete(wanted, system.gap(solved, stage.weights)) | tied, active):
            raise SingularModelError(
                f"{system.freed(wanted)}: the loads pull it off its contact; hold it by a support or turn the load round"
            )
        seen.add(active.tobytes())
        changes.append(int(changed.sum()))
        stalled = len(changes) > PATIENCE and min(changes[-PATIENCE:]) >= min(changes[:-PATIENCE])
        repeated = wanted.tobytes() in seen
        if repeated and not system.exact and finest > FINE:
            accuracy = finest = FINE  # sets may repeat because they were not solved well enough
            seen.clear()
        elif repeated or stalled or share:
            if repeated:
                share = min(1.0, GROWTH * share) if share else FIRST_SHARE
            else:
                share = min(max(share, FIRST_SHARE), 1.0 / GROWTH)
            strong = changed & (violation >= share * violation[changed].max())
            wanted = np.where(strong, wanted, active)
        state = replace(solved, active=wanted)
    recent = np.stack(history[-6:])
    cycling = (recent.any(axis=0) & ~recent.all(axis=0)) | changed
    return Outcome(
        replace(solved, active=active), tuple(done), False, cycling, partial(active_laws, weights=stage.weights)
    )


def _closure(system: System, state: Unknowns, stage: Stage) -> float:
    """Largest weighted gap left where contact is closed, as a pressure over the largest pressure."""
    if system.exact or not state.active.any():
        return 0.0
    gap = system.gap(state, stage.weights) / system.join([pair.scale for pair in system.pairs])
    return float(np.abs(gap[state.active]).max() / largest_pressure(state, stage))


def following(system: System, stage: Stage, outcome: Outcome, weights: NDArray[np.float64]) -> Stage:
    """The stage after one that ended with ``outcome``."""
    state = outcome.unknowns
    return Stage(
        stage.number + 1,
        weights,
        largest_force(system, internal_force(system, state), stage),
        largest_pressure(state, stage),
    )
