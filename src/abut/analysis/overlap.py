"""How far the surfaces of a contact overlap after deformation, point by point, and facets that several contacts load."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from abut.analysis.faceting import misfit, unseen
from abut.analysis.oscillation import CLOSED
from abut.cells import MAX_FACET_NODES
from abut.contact.geometry import facet_sizes, full_moments
from abut.contact.overclosure import PressureOverclosure
from abut.problem.pair import Pair
from abut.problem.sample_gaps import gaps_at

SOLVED = 1e-8  # of the largest change of a gap: overlaps below are left by the solver


def overlaps(pair: Pair, displacement: NDArray[np.float64], offset: float) -> NDArray[np.float64]:
    """Largest overlap at the corners and middles of each facet's segments over its size, (n_facets,), 0 for none.

    Where linear facets are chords of a curve, an overlap counts as far as the curves overlap as well: theory (L11).

    displacement: (n_points, dim); offset: added to the geometric gap, a length.
    """
    at = pair.coupling.gap_samples
    deepest = np.zeros(len(pair.contactor))
    if at is None or not len(at.gap):
        return deepest
    gap, change = gaps_at(pair, at, displacement)
    depth = -(gap + offset) - SOLVED * change
    chords = misfit(pair)
    if chords is not None:
        depth = np.minimum(depth, depth - unseen(pair, chords))
    np.maximum.at(deepest, at.facet, depth / facet_sizes(pair.contactor)[at.facet])
    return deepest


def meant(pair: Pair, pressure: float) -> float:
    """How far surfaces overlap under a pressure because their law says so, a length: not at all, but for soft contact."""
    law = pair.contact.law
    return law.overclosure(pressure) if isinstance(law, PressureOverclosure) and pressure > 0.0 else 0.0


def covered_elsewhere(pairs: Sequence[Pair], pressures: Sequence[NDArray[np.float64]]) -> list[NDArray[np.float64]]:
    """Of each pair, shares of its contactor's facets, (n_facets, 2): what other pairs cover, and what they load of it."""
    numbers = [8 * pair.contactor.cells + pair.contactor.local for pair in pairs]  # no cell has more than 8 facets
    result = [np.zeros((len(number), 2)) for number in numbers]
    every = np.concatenate([*numbers, np.zeros(0, dtype=np.int64)])
    if len(np.unique(every)) == len(every):
        return result
    loaded = []
    for pair, pressure in zip(pairs, pressures):
        values = pair.transfer @ pressure if pair.tied else pair.space.transfer @ pressure[pair.normal]
        size = np.abs(values).reshape(-1, MAX_FACET_NODES).max(axis=1)
        share = pair.coupling.covered / np.maximum(full_moments(pair.contactor, 0)[:, 0], 1e-300)
        loaded.append(np.column_stack([share, np.where(size > CLOSED * size.max(initial=0.0), share, 0.0)]))
    for i, facet_numbers in enumerate(numbers):
        for j, other in enumerate(numbers):
            if i != j:
                _, here, there = np.intersect1d(facet_numbers, other, assume_unique=True, return_indices=True)
                result[i][here] += loaded[j][there]
    return result
