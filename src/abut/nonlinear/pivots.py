"""The status that belongs to a linearised problem, by pivots: of all points at once as long as ever fewer break their laws,
then of one after the other.

Points that change all at once converge fast, but may go round in a circle for ever where a pressure changes gaps elsewhere
as much as its own: on a contactor that is finer and stiffer than its target, say. For matrices whose principal minors are
positive the same with single pivots, of the last point that breaks its law, always ends (Kostreva 1978; Judice and Pires
1994). Tangents far from a solution need not be such. So the point that breaks its law most is taken, and no status twice:
there are finitely many."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.nonlinear.settings import NewtonSettings
from abut.solution.state import State

Status = NDArray[np.int8]


@dataclass(frozen=True)
class Pivots:
    """What pivots need to know. asked: the status (n,) that laws ask for at a solution; broken: (n,) how far that one is
    from being met there; point: (n,) which point a multiplier belongs to: all of it changes together."""

    asked: Callable[[State], Status]
    broken: Callable[[State], NDArray[np.float64]]
    point: NDArray[np.int64]


def pivoted(
    pivots: Pivots, begin: State, there: State, solved: Callable[[State], State], settings: NewtonSettings
) -> State:
    """The linear solution whose status is the one that its laws ask for, or the last one tried.

    there: the solution with the status of ``begin``; solved: that with another status."""
    here, fewest, patience = begin, len(begin.status) + 1, settings.patience
    met = {begin.status.tobytes()}
    for _ in range(settings.solutions):
        wanted = pivots.asked(there)
        count = int((wanted != here.status).sum())
        if not count:
            break
        patience = settings.patience if count < fewest else patience - 1
        fewest = min(count, fewest)
        status: Status | None = wanted
        if patience < 0 or wanted.tobytes() in met:
            status = _single(pivots, here.status, there, wanted, met)
        if status is None:
            break
        met.add(status.tobytes())
        here = begin.with_status(status)
        there = solved(here)
    return there


def _single(pivots: Pivots, status: Status, there: State, wanted: Status, met: set[bytes]) -> Status | None:
    """A status with that wanted of one point: the one that breaks its law most of those with which it has not been met; None
    where there is none."""
    changes = wanted != status
    broken = np.where(changes, pivots.broken(there), -1.0)
    for worst in np.argsort(-broken, kind="stable")[: int(changes.sum())]:
        other = np.where(pivots.point == pivots.point[worst], wanted, status).astype(np.int8)
        if other.tobytes() not in met:
            return other
    return None
