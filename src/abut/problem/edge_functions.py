"""Pressure functions of a contactor that hardly have a target opposite at large sliding: each follows a neighbour."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.coupling import Coupling
from abut.contact.pressure_space import NO_SUPPORT, WEAK_SUPPORT, PressureSpace, covered_share, leaders, only
from abut.mesh.surface import Surface
from abut.problem.contact_pairs import Pair


@dataclass(frozen=True)
class Following:
    """Which function each one has its pressure from, theory (P6). to: (n_functions,) its own number, or that of a neighbour;
    seen: (n_functions,) whether any target is opposite."""

    to: NDArray[np.int64]
    seen: NDArray[np.bool_]

    @classmethod
    def of(cls, space: PressureSpace, contactor: Surface, coupling: Coupling) -> Following:
        """On a contactor that is where it is now: with less than ``WEAK_SUPPORT`` of its support covered, and be it none, a
        function follows a neighbour with more, if there is one.

        space: with a multiplier for every function; coupling: of that contactor."""
        share = covered_share(space, contactor, coupling)
        now = replace(space, weight=space.plain.T @ coupling.weight)
        to = leaders(now, keep=share >= WEAK_SUPPORT, goes=share < WEAK_SUPPORT)
        return cls(np.where(to >= 0, to, np.arange(len(space))), share > NO_SUPPORT)

    def matters(self, before: NDArray[np.int64], closed: NDArray[np.bool_]) -> bool:
        """Whether functions with a target follow that did not, or the other way round, where something is closed.

        before: (n_functions,) as ``to``; closed: (n_functions,)."""
        own = np.arange(len(self.to))
        changed = self.seen & ((before != own) != (self.to != own))
        return bool((changed & (closed | closed[before] | closed[self.to])).any())


def led(pair: Pair, to: NDArray[np.int64]) -> Pair:
    """A pair whose functions have the pressures, and tractions, of those that they follow, as in ``Following``."""
    n = len(pair.space)
    if np.array_equal(to, np.arange(n)):
        return pair
    follow = sp.csr_matrix((np.ones(n), (np.arange(n), to)), shape=(n, n))
    plain = (pair.space.plain @ follow).tocsr()
    transfer = plain if pair.space.ordinary else (pair.space.transfer @ follow).tocsr()
    space = replace(pair.space, transfer=transfer, plain=plain)
    others = (only(space, pair.index[:, c] >= 0) for c in range(1, len(pair.components)))
    return replace(pair, space=space, components=(space, *others))
