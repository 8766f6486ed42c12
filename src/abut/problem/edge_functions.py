"""Pressure functions of a contactor that hardly have a target opposite at large sliding: each follows a neighbour."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.coupling import Coupling
from abut.contact.pressure_space import NO_SUPPORT, WEAK_SUPPORT, PressureSpace, beside, covered_share, leaders, only
from abut.mesh.surface import Surface
from abut.problem.pair import Pair

MARGIN = 0.2  # of the least share, by which it may be missed at the end of a step that began with a guess of it


@dataclass(frozen=True)
class Following:
    """Which function each one has its pressure from, theory (P6). to: (n_functions,) its own number, or that of a
    neighbour, or -1 for none; share: (n_functions,) of its support that is covered."""

    to: NDArray[np.int64]
    share: NDArray[np.float64]

    @classmethod
    def of(
        cls,
        space: PressureSpace,
        contactor: Surface,
        coupling: Coupling,
        closed: NDArray[np.bool_],
        edge_on: NDArray[np.bool_],
    ) -> Following:
        """On a contactor that is where it is now: with less than ``WEAK_SUPPORT`` of its support covered, be it none, a
        function in or beside closed contact follows the neighbour that has most. Without a neighbour that has more, those of
        a facet alone have no pressure; others keep their own. Those ``edge_on`` (n_functions,) have none.

        space: with a multiplier for every function; coupling: of that contactor; closed: (n_functions,)."""
        share, own = covered_share(space, contactor, coupling), np.arange(len(space))
        now, weak = replace(space, weight=space.plain.T @ coupling.weight), share < WEAK_SUPPORT
        to = leaders(now, keep=~weak & ~edge_on, goes=weak)
        gone = (to < 0) & weak & (share > NO_SUPPORT) & (space.node < 0) & (not weak.all())
        stays = ~gone & ((to < 0) | ~(closed | beside(space, closed)[to]))
        return cls(np.where(edge_on, -1, np.where(stays, own, to)), share)

    def matters(self, before: NDArray[np.int64], closed: NDArray[np.bool_]) -> bool:
        """Whether functions with a target follow that did not, or the other way round, where something is closed, and not
        by a hair.

        before: (n_functions,) as ``to``; closed: (n_functions,)."""
        own = np.arange(len(self.to))
        clear = (self.share > NO_SUPPORT) & (np.abs(self.share / WEAK_SUPPORT - 1.0) > MARGIN)
        changed = clear & ((before != own) != (self.to != own))
        leading = closed[before] & (before >= 0) | closed[self.to] & (self.to >= 0)
        return bool((changed & (closed | leading)).any())


def led(pair: Pair, to: NDArray[np.int64]) -> Pair:
    """A pair whose functions have the pressures, and tractions, of those that they follow, as in ``Following``."""
    n = len(pair.space)
    if np.array_equal(to, np.arange(n)):
        return pair
    have = np.flatnonzero(to >= 0)
    follow = sp.csr_matrix((np.ones(len(have)), (have, to[have])), shape=(n, n))
    plain = (pair.space.plain @ follow).tocsr()
    transfer = plain if pair.space.ordinary else (pair.space.transfer @ follow).tocsr()
    space = replace(pair.space, transfer=transfer, plain=plain)
    others = (only(space, pair.index[:, c] >= 0) for c in range(1, len(pair.components)))
    return replace(pair, space=space, components=(space, *others))


def handed_over(pair: Pair, values: NDArray[Any], old: NDArray[Any] | None, to: NDArray[np.int64]) -> NDArray[Any]:
    """Values (n,) of multipliers, or their status, where other functions begin to follow: one that no longer does has those
    of the one that it followed, one that does has none. old, to: (n_functions,) as in ``Following``; old None: all their
    own."""
    own = np.arange(len(to))
    was = own if old is None else old.astype(np.int64)
    source = np.where((was >= 0)[:, None], pair.index[was], -1)
    there = (pair.index >= 0) & (source >= 0) & (to == own)[:, None]
    result = np.zeros_like(values)
    result[pair.index[there]] = values[source[there]]
    return result
