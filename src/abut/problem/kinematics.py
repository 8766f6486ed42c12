"""How a pair is looked at: where its bodies were (``Reference``), or where they are, contacts (``Current``) and ties across
a gap (``TurningTie``)."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.contact.slip_points import Past
from abut.problem.frame import PairFrame
from abut.problem.pair import Pair
from abut.solution.state import ContactHistory
from abut.types import Sparse

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Placed:
    """A pair in a state. displacement: (dim n_points,) of all points; multipliers, closed: (n,) of the pair; offset: what is
    added to all gaps then; away: whether it does not act."""

    displacement: Array
    multipliers: Array
    closed: NDArray[np.bool_]
    offset: float
    away: bool = False


@dataclass(frozen=True)
class ContactNow:
    """A pair at a state. pair: with surfaces, rows (of the forces) and weights as they are now; gap: (n,) weighted gaps and
    slips; by_position: (n, dim n_points) their derivative; bending: (dim n_points, dim n_points) derivative of the contact
    forces, None where they go on as they are; without_history: (n_functions,) whose slip does not count."""

    pair: Pair
    gap: Array
    by_position: Sparse
    bending: Sparse | None
    without_history: NDArray[np.bool_]


@dataclass(frozen=True)
class Kinematics(ABC):
    """Of one pair. pair: undeformed."""

    pair: Pair

    @abstractmethod
    def frame(self, known: ContactHistory, before: Placed, near: Placed | None) -> PairFrame:
        """What is fixed during the step from the converged state ``before``, which remembers ``known``. near: where the step
        is expected to end, None where there is no guess."""

    def settled(self, frame: PairFrame, before: Placed, end: Placed) -> PairFrame:
        """The frame that belongs to the end of a step in ``frame``; the same object where that one serves as well."""
        return frame

    def ended(self, was: ContactHistory, known: ContactHistory, before: Placed) -> PairFrame:
        """The frame of a step from the converged state ``before``, which remembers ``was``, to one that remembers
        ``known``."""
        return PairFrame(was.past, known.inner, known.following, known.fit)

    @abstractmethod
    def at(self, frame: PairFrame, now: Placed, before: Array) -> ContactNow:
        """The pair ``now``, during a step that began with displacements ``before`` (dim n_points,)."""

    @abstractmethod
    def touching(self, rest: Placed, frame: PairFrame) -> NDArray[np.bool_]:
        """(n,) multipliers that are closed at the outset."""

    def past(self, displacement: Array, closed: NDArray[np.bool_]) -> Past | None:
        """From where the next step's slip counts, of a converged state; None without friction, and where slips are jumps,
        which displacements tell."""
        return None
