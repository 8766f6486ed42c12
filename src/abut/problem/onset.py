"""The onset of slip: points that stick at the beginning of a load step and slip at its end, and how far the next ones are,
theory (R21), (R22)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.problem.pair import Pair, by_pair
from abut.problem.step_error import bound, slipping
from abut.solution.state import OPEN, SLIPPING, State

Array = NDArray[np.float64]
Status = NDArray[np.int8]


@dataclass(frozen=True)
class Most:
    """What a load step may see of the onset of slip, shares of what friction carries at most: fresh: at points that begin to
    slip in it; bent: missed by the straight line that the step draws of their tractions."""

    fresh: float
    bent: float


@dataclass(frozen=True)
class Onset:
    """Of a step, forces by area: fresh: of friction at points that stick at its beginning and slip at its end, and by how
    much that of others which slip turns; turns: the latter alone; bent: what the straight line from its beginning to its
    end misses of the tractions where contact slips, beside what follows from the pressure; sticks: of friction at points
    that stick at its end; limit: what friction carries at most. ahead: how many times as long the next step may be if
    tractions go on as in this one."""

    fresh: float = 0.0
    turns: float = 0.0
    bent: float = 0.0
    sticks: float = 0.0
    limit: float = 0.0
    ahead: float = math.inf

    @property
    def shares(self) -> tuple[float, float]:
        """``fresh`` and ``bent`` of what friction carries at most; none where nothing presses."""
        return (self.fresh / self.limit, self.bent / self.limit) if self.limit > 0.0 else (0.0, 0.0)

    @property
    def begun(self) -> float:
        """Of what friction carries at most, the share at points that begin to slip."""
        return (self.fresh - self.turns) / self.limit if self.limit > 0.0 else 0.0


@dataclass(frozen=True)
class _Points:
    """Of the points of a pair, in a step: limit: (n,) forces of friction; change: (n, dim - 1) of its share that they carry,
    to ``last``; missed: (n,) by the straight line, and fresh: (n,) share that begins to slip or turns, of those that slip;
    turns: (n,) of it what turns; sticks: (n,) whether they stick in the end; held: (n,) whether they do and were pressed
    all along."""

    limit: Array
    change: Array
    last: Array
    missed: Array
    fresh: Array
    turns: Array
    sticks: NDArray[np.bool_]
    held: NDArray[np.bool_]


def onset(pairs: Sequence[Pair], earlier: State | None, before: State, now: State, factors: Array, most: Most) -> Onset:
    """Of the step from ``before`` to ``now``, converged states. earlier: the one before these, None where the way that it
    shows does not go on; factors: of the model's histories at the end. As in theory (R21)."""
    ratio = 0.0 if earlier is None else (now.time - before.time) / (before.time - earlier.time)
    states = [before, now] if earlier is None else [before, now, earlier]
    statuses = [by_pair(pairs, state.status) for state in (before, now)]
    multipliers = [by_pair(pairs, state.multipliers) for state in states]
    found = [
        _points(pair, (was, status), values, ratio, factors)
        for pair, was, status, *values in zip(pairs, *statuses, *multipliers)
        if pair.frictional
    ]
    limit = float(sum(each.limit.sum() for each in found))
    going = [(each.limit[each.held], *until_slip(each.last[each.held], each.change[each.held])) for each in found]
    return Onset(
        fresh=float(sum(each.limit @ each.fresh for each in found)),
        turns=float(sum(each.limit @ each.turns for each in found)),
        bent=float(sum(each.limit @ each.missed for each in found)),
        sticks=float(sum(each.limit[each.sticks].sum() for each in found)),
        limit=limit,
        ahead=ahead(most, limit, *(np.concatenate(each) for each in zip(*going))) if limit > 0.0 else math.inf,
    )


def _points(
    pair: Pair, status: tuple[Status, Status], multipliers: Sequence[Array], ratio: float, factors: Array
) -> _Points:
    """status: (n,) at the beginning and the end of the step; multipliers: (n,) likewise, and where the step before began, if
    that goes on; ratio: of the step to that one."""
    limit = pair.weight[pair.normal] * bound(pair, multipliers[1], status[1][pair.normal] != OPEN, factors)
    first, last, *others = (_shares(pair, each, factors) for each in multipliers)
    change = last - first
    rise = missed = np.linalg.norm(change, axis=1)
    slipped, slips = (slipping(pair, each == SLIPPING) for each in status)
    pressed = (status[0][pair.normal] != OPEN) & (multipliers[0][pair.normal] > 0.0)
    for other in others:
        off = np.linalg.norm(change - ratio * (first - other), axis=1)
        missed = np.where(multipliers[2][pair.normal] > 0.0, missed_by_chord(rise, off), rise)
    fresh = np.where(slipped, np.minimum(rise, 1.0), 1.0)
    on = slips & pressed
    fresh = np.where(on, fresh, 0.0)
    turns = np.where(slipped, fresh, 0.0)
    return _Points(limit, change, last, np.where(on, missed, 0.0), fresh, turns, ~slips, ~slips & pressed)


def missed_by_chord(rise: Array, off: Array) -> Array:
    """(n,) what a straight line misses of tractions that change by ``rise`` (n,) in a step and end ``off`` (n,) from where
    they were going; exact for those with a corner in it."""
    return np.divide(rise * off, rise + off, out=np.zeros_like(rise), where=rise > 0.0)


def until_slip(now: Array, change: Array) -> tuple[Array, Array]:
    """(n,) sizes of the changes (n, dim - 1) of shares of friction in a step, and how many such steps they take from ``now``
    (n, dim - 1) to the limit."""
    square, along = (change * change).sum(axis=1), (now * change).sum(axis=1)
    left = np.maximum(1.0 - (now * now).sum(axis=1), 0.0)
    root = np.sqrt(along * along + square * left)
    steps = np.divide(left, along + root, out=np.full(len(now), np.inf), where=along + root > 0.0)
    return np.sqrt(square), steps


def ahead(most: Most, limit: float, limits: Array, changes: Array, steps: Array) -> float:
    """The longest step, in steps like the last one, in which a straight line misses ``most.bent`` or less of tractions that
    go on as in that one, or ``most.fresh`` or less begins to slip. limits: (n,) forces of friction, of ``limit`` in all;
    changes: (n,) in a step of the shares that are carried; steps: (n,) until points slip."""
    order = np.argsort(steps, kind="stable")
    order = order[np.isfinite(steps[order])]
    weight, change, reached = limits[order] / limit, changes[order], steps[order]
    line, moment = np.cumsum(weight * change * reached), np.cumsum(weight * change * reached**2)
    until = np.full(len(order), np.inf)
    np.divide(moment, line - most.bent, out=until, where=line > most.bent)
    by_bend = until[until <= np.append(reached[1:], np.inf)[: len(order)]]
    by_share = reached[np.cumsum(weight) > most.fresh]
    return max(float(each[0]) if len(each) else math.inf for each in (by_bend, by_share))


def _shares(pair: Pair, multipliers: Array, factors: Array) -> Array:
    """(n_functions, dim - 1) tractions over what friction carries at most; none where nothing presses."""
    along = pair.index[:, 1:]
    traction = np.where(along >= 0, multipliers[np.maximum(along, 0)], 0.0)
    most = bound(pair, multipliers, multipliers[pair.normal] > 0.0, factors)[:, None]
    return np.divide(traction, most, out=np.zeros_like(traction), where=most > 0.0)
