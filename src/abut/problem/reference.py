"""A pair at small displacements, looked at where its bodies were: its rows never change."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut.problem.approach import approach_slip
from abut.problem.frame import PairFrame
from abut.problem.kinematics import ContactNow, Kinematics, Placed
from abut.problem.pair import TOUCHING
from abut.solution.state import ContactHistory

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Reference(Kinematics):
    """Of a contact or a tie. pair: as from ``contact_pairs.pairs``."""

    def frame(self, known: ContactHistory, before: Placed, near: Placed | None) -> PairFrame:
        """What is fixed of the pair during a step, as in ``Kinematics``: tangential jumps in ``before``, and what is
        open moved on until it closes, theory (R3). Of a tie that begins on the way the jumps where it did not act last."""
        if self.pair.tied and not self.pair.contact.times.always:
            return PairFrame(began=self.pair.rows @ before.displacement if before.away else known.began)
        if not self.pair.frictional:
            return PairFrame()
        gap = self._gap(before)
        came = approach_slip(self.pair, gap, before.multipliers, before.closed)
        return PairFrame(slipped=gap[self.pair.tangential] + came, approached=came)

    def ended(self, was: ContactHistory, known: ContactHistory, before: Placed) -> PairFrame:
        """The frame of a step that has ended, as in ``Kinematics``."""
        return self.frame(was, before, None)

    def at(self, frame: PairFrame, now: Placed, before: Array) -> ContactNow:
        """Gaps, slips and forces at a state, as in ``Kinematics``, theory (F9)."""
        pair = replace(self.pair, away=True) if now.away else self.pair
        gap = now.offset * pair.weight if now.away and pair.tied else self._gap(now)
        if frame.slipped is not None:
            gap[pair.tangential] -= frame.slipped
        if frame.began is not None and not now.away:
            gap -= frame.began
        return ContactNow(pair, gap, pair.rows, None, np.zeros(len(pair.space), dtype=bool))

    def touching(self, rest: Placed, frame: PairFrame) -> NDArray[np.bool_]:
        """What is closed at the outset, as in ``Kinematics``."""
        pair = self.pair
        near = self._gap(rest) <= TOUCHING * pair.size * pair.weight
        if rest.away:
            return np.zeros(len(pair), dtype=bool)
        return pair.of_functions(near[pair.normal]) if pair.frictional else pair.two_way | near

    def _gap(self, at: Placed) -> Array:
        """Weighted gaps and jumps, (n,)."""
        gap = np.asarray(self.pair.gap + self.pair.rows @ at.displacement)
        if not self.pair.tied:
            gap[self.pair.normal] += at.offset * self.pair.space.weight
        return gap
