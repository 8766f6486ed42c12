"""What every law's iteration shares: the unknowns, the system, one Newton step, and what is told about it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.laws import Linearisation, linearise_active
from abut.problem.contact_pairs import Pair
from abut.solution import Iteration

FLAT = 1e-9  # pressure over the largest, or scaled penetration likewise, that does not change the active set
NO_PRESSURE = 1e-300
ACCURATE = 2e-9  # of equilibrium and of closed gaps, where linear systems are solved iteratively


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

    @property
    def fixed(self) -> NDArray[np.float64]:
        """Change of the pressures that decoupled rows give at once; zero for all others."""
        own = np.where(self.decoupled, self.by_pressure.diagonal(), 1.0)
        return np.where(self.decoupled, -self.residual / own, 0.0)


@dataclass(frozen=True)
class Stage:
    """One load step: its number, the factor of each history at its end (n_histories,), and the largest force and pressure
    of the steps before, against which rounding is judged where the loads are taken off again."""

    number: int
    weights: NDArray[np.float64]
    force: float = 0.0
    pressure: float = 0.0


Step = Callable[
    [Rows, NDArray[np.float64], NDArray[np.float64], float], tuple[NDArray[np.float64], NDArray[np.float64]]
]
Solve = Callable[[NDArray[np.float64], NDArray[np.float64]], tuple[NDArray[np.float64], NDArray[np.float64]]]
Predict = Callable[[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_]], NDArray[np.bool_]]


@dataclass(frozen=True)
class System:
    """What stays the same over all iterations and steps.

    load: (n_free, n_histories) by each history of the model, theory (F9); operator: all pairs stacked, (n, n_free).
    complete: (active, gap, weights) -> the set, with the multipliers closest to contact where it lets a body go that the
    loads at such weights move; pulled_off: the motion, in
    words, that the loads at such weights cause though contact pushes wherever it can, empty where there is none. step:
    (rows, residual of equilibrium, pressure, accuracy) -> (du, dp), the residual reduced by ``accuracy`` or, where
    ``exact``, to rounding; factorise: the same in two, rows first, then (residual of equilibrium, of the rows) -> (du, dp)
    as often as wanted, where the solver can; accurate: of equilibrium and of closed gaps, where it is not exact. predict:
    (gap, pressure, active, tied) -> a guess at the final active set, where one is cheap. compliance, opening: where
    displacements have been eliminated, the gaps that come of them, by pressures (n, n) and by each history (n,
    n_histories). motions: (n_free, m) rigid motions that supports leave free. respond: (forces, springs) -> displacements,
    (n_free,) all, roughly, by iterative solvers.
    """

    stiffness: Any
    load: NDArray[np.float64]
    pairs: Sequence[Pair]
    operator: Any
    complete: Callable[[NDArray[np.bool_], NDArray[np.float64], NDArray[np.float64]], NDArray[np.bool_]]
    pulled_off: Callable[[NDArray[np.float64]], str]
    step: Step
    motions: NDArray[np.float64]
    factorise: Callable[[Rows], Solve] | None = None
    respond: Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]] | None = None
    exact: bool = True
    accurate: float = ACCURATE
    predict: Predict | None = None
    compliance: NDArray[np.float64] | None = None
    opening: NDArray[np.float64] | None = None

    def split(self, values: NDArray[Any]) -> list[NDArray[Any]]:
        """Values of all multipliers, pair by pair."""
        return np.split(values, np.cumsum([len(pair) for pair in self.pairs])[:-1]) if self.pairs else []

    def join(self, values: Sequence[NDArray[Any]]) -> NDArray[Any]:
        return np.concatenate(values) if len(values) else np.zeros(0)

    def gap(self, state: Unknowns, weights: NDArray[np.float64]) -> NDArray[np.float64]:
        """Weighted gaps of all multipliers with the histories at ``weights``; theory (F9), condensed theory (V4)."""
        fixed = self.join([pair.gap + pair.prescribed @ weights for pair in self.pairs])
        if not len(fixed):
            return fixed
        gap = fixed + self.operator @ state.displacement
        if self.compliance is not None and self.opening is not None:
            gap = gap + self.compliance @ state.pressure + self.opening @ weights
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


def active_laws(system: System, state: Unknowns, weights: NDArray[np.float64]) -> list[Linearisation]:
    """Complementarity with the active set as it is."""
    return [
        linearise_active(g, p, a, pair.scale)
        for pair, g, p, a in zip(
            system.pairs,
            system.split(system.gap(state, weights)),
            system.split(state.pressure),
            system.split(state.active),
        )
    ]


def advance(
    system: System,
    state: Unknowns,
    weights: NDArray[np.float64],
    laws: Sequence[Linearisation],
    accuracy: float = 0.0,
) -> Unknowns:
    """One Newton step on equilibrium and laws."""
    residual = equilibrium(system, state, weights, internal_force(system, state))
    du, dp = system.step(system.rows(laws), residual, state.pressure, accuracy)
    return replace(state, displacement=state.displacement + du, pressure=state.pressure + dp)


def internal_force(system: System, state: Unknowns) -> NDArray[np.float64]:
    """K u: what stresses do to the free displacements; the longest product of all."""
    return np.asarray(system.stiffness @ state.displacement)


def equilibrium(
    system: System, state: Unknowns, weights: NDArray[np.float64], internal: NDArray[np.float64]
) -> NDArray[np.float64]:
    """K u - B^T p - f, theory (F6), from K u (``internal``)."""
    residual = internal - system.load @ weights
    if len(state.pressure):
        residual = residual - system.operator.T @ state.pressure
    return np.asarray(residual)


def weight(pair: Pair) -> NDArray[np.float64]:
    """int H_k of every multiplier, (n,)."""
    return pair.scale * pair.stiffness


def next_active(
    system: System, state: Unknowns, stage: Stage, tied: NDArray[np.bool_]
) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """The active set that the law asks for, theory (V7), and by how much (pressure) each multiplier breaks it now."""
    if not len(state.pressure):
        return state.active, np.zeros(0)
    gap = system.gap(state, stage.weights)
    push = -gap / system.join([pair.scale for pair in system.pairs])  # penetration as a pressure
    reference = np.abs(state.pressure[~tied]).max(initial=stage.pressure)
    small = FLAT * max(reference, 1e-300)
    tension = np.where(state.active & ~tied, -state.pressure, 0.0)
    penetration = np.where(~state.active, push, 0.0)
    wanted = np.where(state.active, tension <= small, penetration > small) | tied
    return wanted, np.maximum(np.maximum(tension, penetration), 0.0)


def report(
    system: System,
    state: Unknowns,
    stage: Stage,
    count: int,
    changed: int,
    violation: NDArray[np.float64],
    seconds: float,
) -> Iteration:
    """The row of the table for a state."""
    internal = internal_force(system, state)
    residual = equilibrium(system, state, stage.weights, internal)
    gap = system.split(system.gap(state, stage.weights))
    depth = [
        float((-g / (weight(pair) * pair.size)).max(initial=0.0)) for pair, g in zip(system.pairs, gap) if not pair.tied
    ]
    return Iteration(
        step=stage.number,
        iteration=count,
        active=int(state.active.sum()),
        changed=changed,
        residual=float(np.abs(residual).max(initial=0.0) / largest_force(system, state, internal, stage)),
        contact_residual=_relative(violation, largest_pressure(state, stage)),
        penetration=max(depth, default=0.0),
        seconds=seconds,
    )


def largest_force(system: System, state: Unknowns, internal: NDArray[np.float64], stage: Stage) -> float:
    """Largest nodal force of stresses (``internal``), of loads and of single multipliers, now or in a step before. Where
    displacements have been eliminated, those that are left see nothing of contact forces that balance each other on a body,
    as round a press fit."""
    load = system.load @ stage.weights
    push = system.join([weight(pair) for pair in system.pairs]) * state.pressure
    return max(*(float(np.abs(forces).max(initial=0.0)) for forces in (internal, load, push)), stage.force, 1e-300)


def _relative(violation: NDArray[np.float64], largest: float) -> float:
    """Largest violation over the largest pressure; 1 while there is no pressure."""
    worst = float(violation.max(initial=0.0))
    return worst / largest if largest > NO_PRESSURE else float(worst > 0.0)


def largest_pressure(state: Unknowns, stage: Stage) -> float:
    """Largest pressure, now or in a step before."""
    return max(np.abs(state.pressure).max(initial=0.0), stage.pressure, NO_PRESSURE)
