"""Semi-smooth Newton for one load step: the active set is an output of the law, changed until it stands still."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.discretization.pairs import Pair
from abut.errors import SingularModelError
from abut.interface.laws import Linearisation, linearise_active, linearise_constraint_function
from abut.state import Iteration

TOUCHING = 1e-3  # initial gap over facet size below which a multiplier starts active
FLAT = 1e-9  # pressure over the largest, or scaled penetration likewise, that does not change the active set
UNSETTLED = 0.1  # share of the largest violation from which on a multiplier is named where Newton fails
ACCURATE = 2e-9  # of equilibrium and of closed gaps, where linear systems are solved iteratively
ROUGH, FINE, FINEST = (
    1e-2,
    1e-5,
    1e-9,
)  # reductions of the residual asked of them: while the set changes, cycles, is final
FEW = 0.02  # share of the active set below which changes count as few
NO_PRESSURE = 1e-12  # over Young's modulus: a contact that presses less does not press at all
TOLERANCE = 1e-8  # of the relative residuals, for laws that are not piecewise linear


@dataclass(frozen=True)
class Unknowns:
    """displacement: (n_free,); pressure: (n,) coefficients of all pairs; active: (n,) bool."""

    displacement: NDArray[np.float64]
    pressure: NDArray[np.float64]
    active: NDArray[np.bool_]


@dataclass(frozen=True)
class Rows:
    """The laws of all pairs near the present state, in the unknowns: residual + by_displacement du + by_pressure dp = 0.

    ``decoupled`` rows hold nothing but their own pressure. ``symmetric``: all others are minus the rows of the operator.
    """

    residual: NDArray[np.float64]
    by_displacement: Any
    by_pressure: Any
    decoupled: NDArray[np.bool_]
    symmetric: bool


Step = Callable[
    [Rows, NDArray[np.float64], NDArray[np.float64], float], tuple[NDArray[np.float64], NDArray[np.float64]]
]


Predict = Callable[[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_]], NDArray[np.bool_]]


@dataclass(frozen=True)
class System:
    """What stays the same over all iterations and steps.

    ``complete`` adds to an active set that lets a body go the multipliers closest to contact; ``freed`` says in words
    which body it lets go. ``step``: (rows, residual of equilibrium, pressure, accuracy) -> (du, dp), the residual reduced by
    ``accuracy`` or, where ``exact``, to rounding. ``predict``: (gap, pressure, active, tied) -> a guess at the final active
    set, where one is cheap. Where displacements have been
    eliminated, ``compliance`` (n, n) and ``opening`` (n,) are the gaps that come of them, by pressures and by full load.
    """

    stiffness: Any
    load: NDArray[np.float64]  # at full load
    pairs: Sequence[Pair]
    operator: Any  # all pairs stacked, (n, n_free)
    complete: Callable[[NDArray[np.bool_], NDArray[np.float64]], NDArray[np.bool_]]
    freed: Callable[[NDArray[np.bool_]], str]
    step: Step
    exact: bool = True
    predict: Predict | None = None
    compliance: NDArray[np.float64] | None = None
    opening: NDArray[np.float64] | None = None

    def split(self, values: NDArray[Any]) -> list[NDArray[Any]]:
        """Values of all multipliers, pair by pair."""
        return np.split(values, np.cumsum([len(pair) for pair in self.pairs])[:-1]) if self.pairs else []

    def join(self, values: Sequence[NDArray[Any]]) -> NDArray[Any]:
        return np.concatenate(values) if len(values) else np.zeros(0)

    def gap(self, state: Unknowns, factor: float) -> NDArray[np.float64]:
        """Weighted gaps of all multipliers at a share ``factor`` of the load; theory (F9), condensed theory (V4)."""
        fixed = self.join([pair.gap + factor * pair.prescribed for pair in self.pairs])
        if not len(fixed):
            return fixed
        gap = fixed + self.operator @ state.displacement
        if self.compliance is not None and self.opening is not None:
            gap = gap + self.compliance @ state.pressure + factor * self.opening
        return np.asarray(gap)

    def rows(self, laws: Sequence[Linearisation]) -> Rows:
        """The laws of all pairs in terms of the unknowns."""
        if not self.pairs:
            none = np.zeros(0)
            return Rows(none, self.operator, sp.csr_matrix((0, 0)), none.astype(bool), True)
        by_displacement, by_compliance, first = [], [], 0
        for pair, law in zip(self.pairs, laws):
            here = slice(first, first + len(pair))
            first += len(pair)
            own = pair.points.operator if law.at_points and pair.points is not None else self.operator[here]
            by_displacement.append(sp.csr_matrix(law.by_gap @ own))
            if self.compliance is not None:
                empty = law.at_points  # all displacements of such pairs have been kept
                by_compliance.append(
                    np.zeros((len(pair), len(self.compliance))) if empty else law.by_gap @ self.compliance[here]
                )
        by_pressure = sp.block_diag([law.by_pressure for law in laws]).tocsr()
        return Rows(
            residual=np.concatenate([law.residual for law in laws]),
            by_displacement=sp.vstack(by_displacement).tocsr(),
            by_pressure=by_pressure if self.compliance is None else by_pressure.toarray() + np.vstack(by_compliance),
            decoupled=np.concatenate([law.decoupled for law in laws]),
            symmetric=not any(law.at_points for law in laws),
        )


Laws = Callable[[System, Unknowns], Sequence[Linearisation]]


@dataclass(frozen=True)
class Outcome:
    """``laws``: those of all pairs as the last iteration saw them, near any state."""

    unknowns: Unknowns
    iterations: tuple[Iteration, ...]
    converged: bool
    cycling: NDArray[np.bool_]  # multipliers that go in and out for ever, or whose law stays violated
    laws: Laws


def start(system: System) -> Unknowns:
    """Zero displacement; multipliers that touch at the outset are active, theory (V6)."""
    n = sum(map(len, system.pairs))
    rest = Unknowns(np.zeros(system.stiffness.shape[0]), np.zeros(n), np.zeros(n, dtype=bool))
    gap = system.gap(rest, 0.0)
    active = system.join(
        [
            np.full(len(pair), True) if pair.tied else g <= TOUCHING * pair.size * _weight(pair)
            for pair, g in zip(system.pairs, system.split(gap))
        ]
    ).astype(bool)
    return replace(rest, active=active)


def solve_step(
    system: System, begin: Unknowns, factor: float, number: int, limit: int, observe: Callable[[Iteration], None]
) -> Outcome:
    """Find the state at a share ``factor`` of the load, from the state ``begin``."""
    state = begin
    tied = system.join([np.full(len(pair), pair.tied) for pair in system.pairs]).astype(bool)
    seen: set[bytes] = set()
    history: list[NDArray[np.bool_]] = []
    done: list[Iteration] = []
    keep_largest = 0.0  # after a cycle only violations above this share of the largest change their row: theory (V9)
    changed = np.zeros(len(state.active), dtype=bool)
    finest = ROUGH
    accuracy = 0.1 * ACCURATE if state.active.all() else ROUGH  # closed all over may well be the answer
    for count in range(1, limit + 1):
        clock = time.perf_counter()
        active = system.complete(state.active, system.gap(state, factor)) | tied
        solved = _solve_active(system, replace(state, active=active), factor, accuracy)
        wanted, violation = _next_active(system, solved, factor, tied)
        changed = wanted != active
        closure = _closure(system, solved, factor)
        row = _report(system, solved, factor, number, count, int(changed.sum()), violation, time.perf_counter() - clock)
        row = replace(row, contact_residual=max(row.contact_residual, closure))
        done.append(row)
        observe(row)
        history.append(active)
        if not changed.any():
            error = max(row.residual, closure)
            if system.exact or error <= ACCURATE:
                return _finish_smooth(system, solved, factor, number, limit, done, observe)
            state, accuracy = solved, max(0.3 * ACCURATE / error, FINEST)
            continue
        if system.predict is not None and changed.sum() > FEW * active.sum():
            guess = system.predict(system.gap(solved, factor), solved.pressure, wanted, tied)
            if guess.tobytes() not in {*seen, active.tobytes()}:
                wanted = guess
        accuracy = min(finest, ROUGH if changed.sum() > FEW * active.sum() else 0.1 * ROUGH)
        if np.array_equal(system.complete(wanted, system.gap(solved, factor)) | tied, active):
            raise SingularModelError(
                f"{system.freed(wanted)}: the loads pull it off its contact; hold it by a support or turn the load round"
            )
        seen.add(active.tobytes())
        if wanted.tobytes() in seen and not system.exact and finest > FINE:
            accuracy = finest = FINE  # sets may repeat because they were not solved well enough
            seen.clear()
        elif wanted.tobytes() in seen or keep_largest:
            keep_largest = 0.3 if not keep_largest else min(1.0, 1.5 * keep_largest)
            if wanted.tobytes() not in seen:
                keep_largest = max(0.3, keep_largest / 1.5)
            strong = changed & (violation >= keep_largest * violation[changed].max())
            wanted = np.where(strong, wanted, active)
        state = replace(solved, active=wanted)
    recent = np.stack(history[-6:])
    cycling = (recent.any(axis=0) & ~recent.all(axis=0)) | changed
    return Outcome(replace(solved, active=active), tuple(done), False, cycling, partial(_active_laws, factor=factor))


def _solve_active(system: System, state: Unknowns, factor: float, accuracy: float) -> Unknowns:
    return _advance(system, state, factor, _active_laws(system, state, factor), accuracy)


def _closure(system: System, state: Unknowns, factor: float) -> float:
    """Largest weighted gap left where contact is closed, as a pressure over the largest pressure."""
    if system.exact or not state.active.any():
        return 0.0
    gap = system.gap(state, factor) / system.join([pair.scale for pair in system.pairs])
    return float(np.abs(gap[state.active]).max() / max(np.abs(state.pressure).max(), 1e-300))


def _active_laws(system: System, state: Unknowns, factor: float) -> list[Linearisation]:
    return [
        linearise_active(g, p, a, pair.scale)
        for pair, g, p, a in zip(
            system.pairs,
            system.split(system.gap(state, factor)),
            system.split(state.pressure),
            system.split(state.active),
        )
    ]


def _advance(
    system: System, state: Unknowns, factor: float, laws: Sequence[Linearisation], accuracy: float = FINEST
) -> Unknowns:
    residual = _equilibrium(system, state, factor)
    du, dp = system.step(system.rows(laws), residual, state.pressure, accuracy)
    return replace(state, displacement=state.displacement + du, pressure=state.pressure + dp)


def _equilibrium(system: System, state: Unknowns, factor: float) -> NDArray[np.float64]:
    """K u - B^T p - f, theory (F6)."""
    residual = system.stiffness @ state.displacement - factor * system.load
    if len(state.pressure):
        residual = residual - system.operator.T @ state.pressure
    return np.asarray(residual)


def _weight(pair: Pair) -> NDArray[np.float64]:
    return pair.scale * pair.stiffness


def _next_active(
    system: System, state: Unknowns, factor: float, tied: NDArray[np.bool_]
) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """The active set that the law asks for, theory (V7), and by how much (pressure) each multiplier breaks it now."""
    if not len(state.pressure):
        return state.active, np.zeros(0)
    gap = system.gap(state, factor)
    push = -gap / system.join([pair.scale for pair in system.pairs])  # penetration as a pressure
    reference = np.abs(state.pressure[~tied]).max(initial=0.0)
    small = FLAT * max(reference, 1e-300)
    tension = np.where(state.active & ~tied, -state.pressure, 0.0)
    penetration = np.where(~state.active, push, 0.0)
    wanted = np.where(state.active, tension <= small, penetration > small) | tied
    return wanted, np.maximum(np.maximum(tension, penetration), 0.0)


def _report(
    system: System,
    state: Unknowns,
    factor: float,
    number: int,
    count: int,
    changed: int,
    violation: NDArray[np.float64],
    seconds: float,
) -> Iteration:
    internal = system.stiffness @ state.displacement
    force = max(np.abs(internal).max(initial=0.0), np.abs(factor * system.load).max(initial=0.0), 1e-300)
    gap = system.split(system.gap(state, factor))
    depth = [
        float((-g / (_weight(pair) * pair.size)).max(initial=0.0))
        for pair, g in zip(system.pairs, gap)
        if not pair.tied
    ]
    return Iteration(
        step=number,
        iteration=count,
        active=int(state.active.sum()),
        changed=changed,
        residual=float(np.abs(_equilibrium(system, state, factor)).max(initial=0.0) / force),
        contact_residual=_relative(float(violation.max(initial=0.0)), float(np.abs(state.pressure).max(initial=0.0))),
        penetration=max(depth, default=0.0),
        seconds=seconds,
    )


def _relative(violation: float, pressure: float) -> float:
    """A violation of the law over the largest pressure; 1 where there is no pressure to compare with."""
    return violation / pressure if pressure > 1e-300 else float(violation > 0.0)


def _finish_smooth(
    system: System,
    state: Unknowns,
    factor: float,
    number: int,
    limit: int,
    done: list[Iteration],
    observe: Callable[[Iteration], None],
) -> Outcome:
    """Pairs with the constraint function: Newton on it, from the solution of the complementarity law,
    until theory (V10). The active sets of other pairs go on changing with it."""
    none = np.zeros(len(state.active), dtype=bool)
    if not any(pair.smooth for pair in system.pairs):
        return Outcome(state, tuple(done), True, none, partial(_active_laws, factor=factor))
    reference = float(np.abs(state.pressure).max(initial=0.0))
    if reference <= NO_PRESSURE * max(pair.stiffness * pair.size for pair in system.pairs):
        # The function is smoothed over a share of the largest pressure: without one it is the complementarity law.
        return Outcome(state, tuple(done), True, none, partial(_active_laws, factor=factor))
    smooth = partial(_smooth_laws, factor=factor, reference=reference)
    violation = np.zeros(len(state.active))
    tied = system.join([np.full(len(pair), pair.tied) for pair in system.pairs]).astype(bool)
    exact = system.join([np.full(len(pair), not pair.smooth) for pair in system.pairs]).astype(bool)
    for _ in range(limit):
        clock = time.perf_counter()
        laws = _smooth_laws(system, state, factor, reference)
        residual = system.join([law.residual for law in laws])
        scale = system.join([_weight(pair) for pair in system.pairs]) * reference
        violation = np.abs(residual / scale)
        law_error = float(violation.max(initial=0.0))
        following = _advance(system, state, factor, laws)
        following = _line_search(system, state, following, factor, reference)
        wanted, _ = _next_active(system, following, factor, tied)
        active = np.where(exact, wanted, system.join([law.active for law in laws]).astype(bool))
        changed = int((active != state.active).sum())
        unsettled = bool((active != state.active)[exact].any())
        state = replace(following, active=active)
        row = _report(system, state, factor, number, len(done) + 1, changed, np.zeros(1), time.perf_counter() - clock)
        row = replace(row, contact_residual=law_error)
        done.append(row)
        observe(row)
        if law_error < TOLERANCE and row.residual < 1e-8 and not unsettled:
            return Outcome(state, tuple(done), True, none, smooth)
    return Outcome(state, tuple(done), False, violation > UNSETTLED * violation.max(initial=0.0), smooth)


def _smooth_laws(system: System, state: Unknowns, factor: float, reference: float) -> list[Linearisation]:
    laws = []
    for pair, g, p, a in zip(
        system.pairs,
        system.split(system.gap(state, factor)),
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
                at.gap + at.operator @ state.displacement + factor * at.prescribed,
                p,
                at.stiffness,
                pair.contact.epsilon,
                reference,
            )
        )
    return laws


def _line_search(system: System, state: Unknowns, full: Unknowns, factor: float, reference: float) -> Unknowns:
    """Halve the step while the law's residual grows."""

    def size(at: Unknowns) -> float:
        laws = _smooth_laws(system, at, factor, reference)
        scale = system.join([_weight(pair) for pair in system.pairs]) * reference
        return float(np.linalg.norm(system.join([law.residual for law in laws]) / scale))

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
