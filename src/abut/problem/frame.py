"""What is fixed during a load step."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut.contact.slip_points import Past
from abut.problem.wet import Wet

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PairFrame:
    """Of one contact pair. At small displacements, with friction: slipped: (n_tangential,) weighted tangential jumps from
    which slip counts, theory (R3); approached: (n_tangential,) what of them is no slip, theory (R4). Of a tie that begins on
    the way: began: (n,) weighted jumps from which it holds.

    At current positions: past: from where slip counts, None without friction; inner: (n_facets,) above zero where functions
    of a dual space are the ordinary ones, None for nowhere, theory (P9), as named in ``edge_trials``; following:
    (n_functions,) which one each has its pressure from, as in ``Following``, None for itself; fit: (9 n_facets,) what is
    added to the gaps, or None, theory (G15)."""

    past: Past | None = None
    inner: Array | None = None
    following: NDArray[np.int64] | None = None
    fit: Array | None = None
    slipped: Array | None = None
    approached: Array | None = None
    began: Array | None = None


@dataclass(frozen=True)
class Frame:
    """Of all contact pairs, in turn, and how far each fluid has got. The same object where a step ends in the frame that it
    began with."""

    pairs: tuple[PairFrame, ...]
    wet: tuple[Wet, ...] = ()

    def with_wet(self, wet: tuple[Wet, ...]) -> Frame:
        """With fluids elsewhere; the same object where they are there already."""
        return self if wet is self.wet else replace(self, wet=wet)
