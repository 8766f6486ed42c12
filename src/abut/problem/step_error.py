"""What the load steps leave open of friction: points that touch and stick in the same step, theory (G21)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.problem.pair import Pair
from abut.solution.state import State

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
    slips = slipping(pair, end.slipping)
    limit = weight * bound(pair, end.multipliers, end.closed[normal], factors)
    fresh = end.closed[normal] & end.open[normal] & ~slips
    unsure = np.minimum(limit, pair.stiffness * np.linalg.norm(moved, axis=1))[fresh]
    return Landed(float(unsure.sum()), float(limit.sum()))


def landed_in(state: State) -> Landed:
    """Of all contacts, in the step that a state ended."""
    forces = [contact.landed for contact in state.history.contacts.values() if contact.landed is not None]
    unsure, limit = np.sum(forces, axis=0) if forces else (0.0, 0.0)
    return Landed(float(unsure), float(limit))


def slipping(pair: Pair, flags: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(n_functions,) those of which a tangential multiplier has the flag, of (n,)."""
    along = pair.index[:, 1:]
    return np.asarray(((along >= 0) & flags[np.maximum(along, 0)]).any(axis=1))


def bound(pair: Pair, multipliers: Array, closed: NDArray[np.bool_], factors: Array) -> Array:
    """(n_functions,) the traction that friction carries at most; the pressure where nothing slips, none unless closed."""
    pressure = np.maximum(multipliers[pair.normal], 0.0)
    most = pair.friction(factors).at(pressure)[0]
    return np.where(closed, np.where(np.isfinite(most), most, pressure), 0.0)
