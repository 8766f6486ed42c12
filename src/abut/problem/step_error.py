"""What the load steps leave open of friction: points that touch and stick in the same step, theory (G21), and those that
stick at its beginning and slip at its end, theory (R21)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.problem.pair import Pair, by_pair
from abut.solution.state import OPEN, SLIPPING, State

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Landed:
    """At the end of a step, forces by area: unsure: of friction that points have which touched in it and stick; limit: what
    friction carries at most, of all points."""

    unsure: float
    limit: float

    @property
    def share(self) -> float:
        """Of what friction carries at most; 0 where nothing presses."""
        return self.unsure / self.limit if self.limit > 0.0 else 0.0


@dataclass(frozen=True)
class PairEnd:
    """Multipliers (n,) of a pair at the end of a step, with ``closed`` and ``slipping``; open: (n,) those not closed at its
    beginning; shift: (n_tangential,) weighted slips that do not count in it, as in ``Past``."""

    multipliers: Array
    closed: NDArray[np.bool_]
    slipping: NDArray[np.bool_]
    open: NDArray[np.bool_]
    shift: Array


def landed(pair: Pair, end: PairEnd, factors: Array) -> Landed:
    """Of one pair with friction; factors: of the model's histories. As in theory (G21)."""
    normal, along = pair.normal, pair.index[:, 1:]
    there = along >= 0
    weight = pair.weight[normal]
    moved = np.zeros(along.shape)
    moved[there] = end.shift[along[there] - len(pair.space)]
    slipping = _slipping(pair, end.slipping)
    limit = weight * _bound(pair, end.multipliers, end.closed[normal], factors)
    fresh = end.closed[normal] & end.open[normal] & ~slipping
    unsure = np.minimum(limit, pair.stiffness * np.linalg.norm(moved, axis=1))[fresh]
    return Landed(float(unsure.sum()), float(limit.sum()))


def landed_in(state: State) -> Landed:
    """Of all contacts, in the step that a state ended."""
    forces = [contact.landed for contact in state.history.contacts.values() if contact.landed is not None]
    unsure, limit = np.sum(forces, axis=0) if forces else (0.0, 0.0)
    return Landed(float(unsure), float(limit))


@dataclass(frozen=True)
class Onset:
    """Of a step, forces by area: fresh: of friction at points that stick at its beginning and slip at its end, or slip the
    other way; turned: by how much their tractions have changed, beside what follows from the pressure; sticks: of friction
    at points that stick at its end; limit: what friction carries at most."""

    fresh: float = 0.0
    turned: float = 0.0
    sticks: float = 0.0
    limit: float = 0.0

    @property
    def shares(self) -> tuple[float, float]:
        """``fresh`` and ``turned`` of what friction carries at most; none where nothing presses."""
        return (self.fresh / self.limit, self.turned / self.limit) if self.limit > 0.0 else (0.0, 0.0)


def onset(pairs: Sequence[Pair], before: State, now: State, factors: Array) -> Onset:
    """Between two converged states; factors: of the model's histories at the second one. As in theory (R21)."""
    total = np.zeros(4)
    values = [by_pair(pairs, part) for part in (before.multipliers, before.status, now.multipliers, now.status)]
    for pair, old, was, new, status in zip(pairs, *values):
        if not pair.frictional:
            continue
        limit = pair.weight[pair.normal] * _bound(pair, new, status[pair.normal] != OPEN, factors)
        first, last = (_shares(pair, each, factors) for each in (old, new))
        change = np.linalg.norm(last - first, axis=1)
        slips, slipped = _slipping(pair, status == SLIPPING), _slipping(pair, was == SLIPPING)
        fresh = slips & (was[pair.normal] != OPEN) & (old[pair.normal] > 0.0) & (~slipped | (change > 1.0))
        total += [limit[fresh].sum(), limit[fresh] @ change[fresh], limit[~slips].sum(), limit.sum()]
    return Onset(*total.tolist())


def _slipping(pair: Pair, flags: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(n_functions,) those of which a tangential multiplier has the flag, of (n,)."""
    along = pair.index[:, 1:]
    return np.asarray(((along >= 0) & flags[np.maximum(along, 0)]).any(axis=1))


def _bound(pair: Pair, multipliers: Array, closed: NDArray[np.bool_], factors: Array) -> Array:
    """(n_functions,) the traction that friction carries at most; the pressure where nothing slips, none unless closed."""
    pressure = np.maximum(multipliers[pair.normal], 0.0)
    bound = pair.friction(factors).at(pressure)[0]
    return np.where(closed, np.where(np.isfinite(bound), bound, pressure), 0.0)


def _shares(pair: Pair, multipliers: Array, factors: Array) -> Array:
    """(n_functions, dim - 1) tractions over what friction carries at most; none where nothing presses."""
    along = pair.index[:, 1:]
    traction = np.where(along >= 0, multipliers[np.maximum(along, 0)], 0.0)
    bound = _bound(pair, multipliers, multipliers[pair.normal] > 0.0, factors)[:, None]
    return np.divide(traction, bound, out=np.zeros_like(traction), where=bound > 0.0)
